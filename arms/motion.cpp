#include "arms/motion.h"

#include <algorithm>
#include <cmath>

namespace arms {

Trapezoid Trapezoid::of(double distance, double speed, double time) {
  const double d = std::abs(distance);
  if (!(d > 0) || !(speed > 0)) return {};
  if (!(time > 0)) return {d / speed, 0};
  if (d >= speed * time) return {d / speed + time, time};
  const double half = std::sqrt(d * time / speed);
  return {2 * half, half};
}

Trapezoid Trapezoid::stretched(double longer) const {
  if (!(duration > 0)) return {longer, longer / 2};
  return {longer, acceleration * longer / duration};
}

double Trapezoid::part(double time) const {
  if (time >= duration) return 1;
  if (time <= 0) return 0;
  const double speed = 1 / (duration - acceleration);
  if (time < acceleration) return 0.5 * speed * time * time / acceleration;
  if (const double left = duration - time; left < acceleration) return 1 - 0.5 * speed * left * left / acceleration;
  return speed * (time - acceleration / 2);
}

double Trapezoid::rate(double time) const {
  if (time >= duration || time <= 0) return 0;
  const double speed = 1 / (duration - acceleration);
  if (time < acceleration) return speed * time / acceleration;
  if (const double left = duration - time; left < acceleration) return speed * left / acceleration;
  return speed;
}

std::vector<double> Motion::positions(double time) const {
  if (time >= profile_.duration) return points_.back();
  const double at = profile_.part(time) * static_cast<double>(points_.size() - 1);
  const auto first = std::min(static_cast<std::size_t>(at), points_.size() - 2);
  const double between = at - static_cast<double>(first);
  std::vector<double> out;
  for (std::size_t j = 0; j < points_[first].size(); ++j)
    out.push_back(points_[first][j] + between * (points_[first + 1][j] - points_[first][j]));
  return out;
}

std::vector<double> Motion::velocities(double time) const {
  const double parts = static_cast<double>(points_.size() - 1);
  const auto first = std::min(static_cast<std::size_t>(profile_.part(time) * parts), points_.size() - 2);
  std::vector<double> out;
  for (std::size_t j = 0; j < points_[first].size(); ++j)
    out.push_back(profile_.rate(time) * parts * (points_[first + 1][j] - points_[first][j]));
  return out;
}

std::vector<double> Motion::speeds() const {
  const double parts = static_cast<double>(points_.size() - 1);
  std::vector<double> most(points_.front().size(), 0.0);
  for (std::size_t k = 0; k + 1 < points_.size(); ++k) {
    const double rate = profile_.rate(profile_.duration * (static_cast<double>(k) + 0.5) / parts);
    for (std::size_t j = 0; j < most.size(); ++j) most[j] = std::max(most[j], rate * parts * std::abs(points_[k + 1][j] - points_[k][j]));
  }
  return most;
}

}  // namespace arms
