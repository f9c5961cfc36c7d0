#include "physics/wind.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sim {

Wind::Wind(const WindDef& def, double dt) : def_(def), dt_(dt) { reset(); }

void Wind::reset() {
  steps_ = 0;
  risen_ = risen_vertical_ = 0;
  air_ = {def_.velocity, def_.scale, !def_.rises};
  if (def_.rises) air_.wind.setZero(), step();
}

void Wind::step() {
  if (!def_.rises) return;
  constexpr double whole = 1e-6;  // of the wind, that may be missing
  risen_ += std::min(1.0, dt_ / def_.time) * (1 - risen_);
  risen_vertical_ += std::min(1.0, dt_ / def_.vertical_time) * (1 - risen_vertical_);
  const double now = static_cast<double>(++steps_) * dt_;
  const auto swing = [&](double amplitude, double period) {
    return amplitude == 0 ? 0 : amplitude * std::sin(2 * std::numbers::pi * now / period);
  };
  const Eigen::Vector2d level = risen_ * (1 + swing(def_.amplitude, def_.period)) * def_.velocity.head<2>();
  air_.wind << Eigen::Rotation2Dd(swing(def_.swing, def_.swing_period)) * level, risen_vertical_ * def_.velocity.z();
  air_.is_steady = def_.amplitude == 0 && def_.swing == 0 && std::max(1 - risen_, 1 - risen_vertical_) < whole;
}

}  // namespace sim
