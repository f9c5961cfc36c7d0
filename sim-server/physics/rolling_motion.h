// The motion of a robot on two driven wheels and on slides (casters that only carry it) over level ground, while its wheels roll and do not
// slip: two wheel speeds, from which everything else follows. Private to physics/. A value; one thread at a time.
//
// All in the frame of the robot: x forward, y left, z up, the origin on the ground in the middle between the places where the wheels touch.
// As ODE does, it finds the speeds at the end of a step from forces at its beginning: motors that follow their rate within their effort,
// Coulomb friction of the slides, inertia of body and wheels. It has no springs: loads follow the accelerations at once, where ODE's
// contacts give way by 10 um for a few steps.
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace sim {

struct RollingWheel {
  double side = 0;      // y of its contact [m]
  double reach = 0;     // way of the contact along x for each radian; negative where the axle looks to the right [m]
  double inertia = 0;   // about the axle [kg m^2]
  double friction = 0;  // the smaller one of both directions
  double damping = 0;   // of its joint [N m s]
};
struct RollingSlide {
  double x = 0, y = 0;  // of the contact [m]
  double friction = 0;
  double ball = 0;  // mass that a ball that rolls there has by its turning, for what speeds it up [kg]
};
struct RollingMass {
  double mass = 0, yaw_inertia = 0;  // [kg], [kg m^2] of the whole, about its centre of mass
  double x = 0, y = 0, height = 0;   // of that [m]
};
// What turns a wheel in the next step.
struct RollingMotor {
  double rate = 0;    // that it follows [rad/s]
  double effort = 0;  // at most [N m]
};

class RollingMotion {
 public:
  struct Speeds {
    std::array<double, 2> wheels{0, 0};  // [rad/s]
    double forward = 0, yaw = 0;         // of the origin [m/s]; [rad/s]
  };

  // Nothing when these contacts cannot carry it.
  static std::optional<RollingMotion> of(const RollingMass& mass, const std::array<RollingWheel, 2>& wheels,
                                         std::vector<RollingSlide> slides, double gravity);

  // False when in this step a wheel would slip or a contact would lift off: then nothing has changed.
  bool step(const std::array<RollingMotor, 2>& motors, double dt);
  void start(const std::array<double, 2>& wheel_rates);
  void stand();  // at once, as what falls asleep does

  const Speeds& speeds() const { return speeds_; }
  std::size_t contacts() const { return 2 + slides_.size(); }
  // On the contact after the last step [N]: x, y, z; of the wheels first.
  const std::array<double, 3>& force(std::size_t contact) const { return forces_[contact]; }

 private:
  struct Accelerations {
    double forward = 0, side = 0;        // of the centre of mass [m/s^2]
    std::array<double, 2> wheels{0, 0};  // [rad/s^2]
  };
  RollingMotion() = default;
  bool share_weight(double gravity);
  Speeds speeds_of(const std::array<double, 2>& wheels) const;
  void find_grips(const std::array<RollingMotor, 2>& motors, double dt);
  std::array<double, 3> slide_forces(double dt);
  bool solve(const std::array<RollingMotor, 2>& motors, const std::array<double, 2>& push, double dt, std::array<double, 2>& rates,
             std::array<double, 2>& efforts) const;
  bool load(const Accelerations& now, double yaw, std::vector<std::array<double, 3>>& forces) const;
  bool grips(const Accelerations& now, const std::array<double, 2>& efforts, double slide_y,
             std::vector<std::array<double, 3>>& forces) const;

  RollingMass mass_;
  std::array<RollingWheel, 2> wheels_;
  std::vector<RollingSlide> slides_;
  double gravity_ = 0;
  double inertia_[2][2] = {};                 // of the wheel rates [kg m^2]
  double to_speeds_[2][2] = {};               // forward and yaw, by wheel rates
  std::vector<std::array<double, 3>> share_;  // of each contact: of the weight, and of the moments about y and x [1], [1/m]
  Speeds speeds_;
  std::vector<double> grips_;  // of each contact, in this step [N]
  std::vector<std::array<double, 3>> forces_, next_forces_;
};

}  // namespace sim
