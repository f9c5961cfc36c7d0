// One motion of an arm: a path of joint positions with a trapezoidal speed profile. Units: rad or m, s. Values; any thread.
#pragma once

#include <span>
#include <vector>

namespace arms {

// Part of a way (0..1) by time, from rest to rest.
struct Trapezoid {
  double duration = 0;      // [s]
  double acceleration = 0;  // [s] until full speed, and from there to rest; at most half the duration
  // Of a distance at a highest speed, which is reached in `time`.
  static Trapezoid of(double distance, double speed, double time);
  // The same with a longer duration.
  Trapezoid stretched(double longer) const;
  double part(double time) const;
  double rate(double time) const;  // of part [1/s]
};

class Motion {
 public:
  // Points at equal parts of the way; at least two.
  Motion(std::vector<std::vector<double>> points, const Trapezoid& profile) : points_(std::move(points)), profile_(profile) {}
  double duration() const { return profile_.duration; }
  std::vector<double> positions(double time) const;
  std::vector<double> velocities(double time) const;
  const std::vector<double>& end() const { return points_.back(); }
  // Highest speed of each joint on the way.
  std::vector<double> speeds() const;
  void stretch(double longer) { profile_ = profile_.stretched(longer); }

 private:
  std::vector<std::vector<double>> points_;
  Trapezoid profile_;
};

}  // namespace arms
