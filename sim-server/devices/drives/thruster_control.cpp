#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "devices/drives/vehicle_control.h"

namespace sim {
namespace {

constexpr double response = 2;      // [1/s] of the velocity
constexpr double integral = 1;      // [1/s] of what drag takes
constexpr double usual_turn = 0.5;  // [rad/s]
constexpr double loss = 1e-6;       // of the allocation: what no thruster can give costs no thrust

// A velocity asks for an acceleration, which the thrusters give as far as they can: least squares over force and torque. The integral
// learns the drag; it stands still while a thruster is at its end.
class ThrusterControl final : public VehicleControl {
 public:
  ThrusterControl(ModelId model, const Weight& weight, std::size_t thrusters, double length)
      : model_(model), weight_(weight), length_(length), efforts_(Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(thrusters))) {}
  void place(std::size_t i, const Eigen::Vector3d& place, const Eigen::Vector3d& axis, double most) {
    const auto column = static_cast<Eigen::Index>(i);
    efforts_.col(column).head<3>() = axis;
    efforts_.col(column).tail<3>() = place.cross(axis) / length_;
    most_.push_back(most);
  }
  void finish() {
    const Matrix6 square = efforts_ * efforts_.transpose();
    const double damping = loss * std::max(square.trace(), 1e-12);
    thrusts_ = efforts_.transpose() * (square + damping * Matrix6::Identity()).inverse();
    // An axis that they cannot act along is left alone: its error would only disturb the others.
    const Matrix6 reached = efforts_ * thrusts_;
    for (int i = 0; i < 6; ++i) can_[i] = reached(i, i) > 0.5 ? 1 : 0;
  }

  void control(const Physics& physics, const Vector6& command, double dt, std::vector<Propellers::Wish>& wishes) override {
    const Eigen::Isometry3d pose = physics.model_pose(model_);
    const LinkId body = physics.canonical_link(model_);
    const Eigen::Matrix3d into = pose.linear().transpose();
    Vector6 error;
    error << command.head<3>() - into * physics.point_velocity(body, pose * weight_.center),
        command.tail<3>() - into * physics.link_twist(body).angular;
    error = error.cwiseProduct(can_);
    Vector6 efforts = efforts_of(response * error) + learned_;
    const Eigen::VectorXd thrusts = thrusts_ * efforts;
    double beyond = 1;
    for (Eigen::Index i = 0; i < thrusts.size(); ++i)
      beyond = std::max(beyond, std::abs(thrusts[i]) / std::max(most_[static_cast<std::size_t>(i)], 1e-9));
    if (beyond <= 1) learned_ += integral * dt * efforts_of(response * error);
    for (std::size_t i = 0; i < wishes.size(); ++i) wishes[i] = {true, thrusts[static_cast<Eigen::Index>(i)] / beyond};
  }
  void reset() override { learned_.setZero(); }
  void add_to(StateHash& hash) const override {
    for (int i = 0; i < 6; ++i) hash.add(learned_[i]);
  }
  bool moves_sideways() const override { return can_[1] > 0; }
  double max_speed() const override { return 0; }
  double max_yaw_rate() const override { return usual_turn; }

 private:
  // Of an acceleration; torques over the length.
  Vector6 efforts_of(const Vector6& acceleration) const {
    Vector6 efforts;
    efforts << weight_.mass * acceleration.head<3>(), weight_.inertia * acceleration.tail<3>() / length_;
    return efforts;
  }

  ModelId model_;
  Weight weight_;
  double length_;
  Eigen::MatrixXd efforts_, thrusts_;  // of thrusts, for efforts
  std::vector<double> most_;
  Vector6 can_ = Vector6::Ones(), learned_ = Vector6::Zero();
};

}  // namespace

std::unique_ptr<VehicleControl> make_thruster_control(const Physics& physics, ModelId model, const Propellers& propellers) {
  const ModelDef& def = physics.def(model);
  const Weight weight = weight_of(def, Eigen::Isometry3d::Identity());
  const double length = std::max(std::sqrt(weight.inertia.trace() / 3 / weight.mass), 1e-3);
  auto made = std::make_unique<ThrusterControl>(model, weight, propellers.all().size(), length);
  for (std::size_t i = 0; i < propellers.all().size(); ++i) {
    const Propeller& one = propellers.all()[i];
    const Eigen::Isometry3d& link = def.links[one.setup().link.link].pose;
    made->place(i, link.translation() - weight.center, link.linear() * one.axis(), one.max_thrust());
  }
  made->finish();
  return made;
}

}  // namespace sim
