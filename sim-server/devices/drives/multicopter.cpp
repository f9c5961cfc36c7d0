#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "devices/drives/vehicle_control.h"
#include "world/plugin_kind.h"
#include "world/xml_values.h"

namespace sim {
namespace {

// Of the velocity [1/s], the attitude [1/s^2] and the rate [1/s]: those of a small public quadcopter by its mass and inertia. Yaw is
// slower, since the drag of rotors is weak.
constexpr double velocity_gain = 1.8, attitude_gain = 50, attitude_gain_of_yaw = 1.5, rate_gain = 10, rate_gain_of_yaw = 1.8;
constexpr double usual_acceleration = 2;  // [m/s^2]
constexpr double usual_vehicle_speed = 5, usual_yaw_rate = 2;

struct Numbers {
  Eigen::Vector3d velocity, attitude, rate;  // gains: [N s/m], [N m], [N m s]
  Eigen::Vector3d acceleration;              // most [m/s^2]
  Eigen::Vector3d speed, turn;               // most of a command [m/s], [rad/s]; 0: not limited
};

// Lee, Leok, McClamroch: Geometric tracking control of a quadrotor UAV on SE(3) (2010), for velocities.
class Multicopter final : public VehicleControl {
 public:
  Multicopter(LinkId body, const Weight& weight, const Numbers& numbers, Eigen::MatrixXd squares, const Eigen::Vector3d& gravity)
      : body_(body), weight_(weight), numbers_(numbers), squares_(std::move(squares)), gravity_(gravity) {}

  void control(const Physics& physics, const Vector6& command, double, std::vector<Propellers::Wish>& wishes) override {
    const Eigen::Matrix3d r = physics.link_pose(body_).linear();
    const Twist twist = physics.link_twist(body_);
    const auto limited = [](const Eigen::Vector3d& v, const Eigen::Vector3d& most) -> Eigen::Vector3d {
      Eigen::Vector3d out = v;
      for (int i = 0; i < 3; ++i) {
        if (most[i] > 0) out[i] = std::clamp(v[i], -most[i], most[i]);
      }
      return out;
    };
    const Eigen::Vector3d velocity = limited(command.head<3>(), numbers_.speed);
    const double yaw_rate = limited(command.tail<3>(), numbers_.turn).z();
    const Eigen::Vector3d error = numbers_.velocity.cwiseProduct(twist.linear - r * velocity) / weight_.mass;
    const Eigen::Vector3d wanted = limited(error, numbers_.acceleration) + gravity_;  // against the thrust
    const Eigen::Vector3d up = wanted.norm() > 1e-9 ? (-wanted.normalized()).eval() : Eigen::Vector3d(r.col(2));
    Eigen::Matrix3d to;
    to.col(1) = up.cross(r.col(0)).normalized();
    to.col(0) = to.col(1).cross(up);
    to.col(2) = up;
    if (!to.allFinite() || to.col(1).isZero()) to = r;
    const Eigen::Matrix3d difference = to.transpose() * r - r.transpose() * to;
    const Eigen::Vector3d turn_error = 0.5 * Eigen::Vector3d(difference(2, 1), difference(0, 2), difference(1, 0));
    const Eigen::Vector3d rate_error = r.transpose() * (twist.angular - to * Eigen::Vector3d(0, 0, yaw_rate));
    Eigen::Vector4d efforts;
    const Eigen::Vector3d moments = weight_.inertia.diagonal();
    const Eigen::Vector3d angular =
        -(turn_error.cwiseProduct(numbers_.attitude) + rate_error.cwiseProduct(numbers_.rate)).cwiseQuotient(moments);
    efforts.head<3>() = weight_.inertia * angular;
    efforts[3] = -weight_.mass * wanted.dot(r.col(2));
    const Eigen::VectorXd squares = squares_ * efforts;
    Eigen::Index rotor = 0;
    for (auto& wish : wishes) {
      wish = {false, std::sqrt(std::max(0.0, squares[rotor]))};
      ++rotor;
    }
  }
  double max_speed() const override { return numbers_.speed.x() > 0 ? numbers_.speed.x() : usual_vehicle_speed; }
  double max_yaw_rate() const override { return numbers_.turn.z() > 0 ? numbers_.turn.z() : usual_yaw_rate; }

 private:
  LinkId body_;
  Weight weight_;
  Numbers numbers_;
  Eigen::MatrixXd squares_;  // of the rotors' speeds, from torque and thrust
  Eigen::Vector3d gravity_;
};

Numbers numbers_of(const ParameterNode& p, const Weight& weight) {
  const Eigen::Vector3d moments = weight.inertia.diagonal();
  Numbers n;
  n.velocity = vector_of(p, "velocityGain", velocity_gain * weight.mass * Eigen::Vector3d::Ones());
  n.attitude = vector_of(p, "attitudeGain", moments.cwiseProduct(Eigen::Vector3d(attitude_gain, attitude_gain, attitude_gain_of_yaw)));
  n.rate = vector_of(p, "angularRateGain", moments.cwiseProduct(Eigen::Vector3d(rate_gain, rate_gain, rate_gain_of_yaw)));
  n.acceleration = vector_of(p, "maximumLinearAcceleration", Eigen::Vector3d::Constant(usual_acceleration));
  n.speed = vector_of(p, "maximumLinearVelocity", Eigen::Vector3d::Zero());
  n.turn = vector_of(p, "maximumAngularVelocity", Eigen::Vector3d::Zero());
  return n;
}

// What a plugin of the velocity control says of the rotor of a joint.
struct Rotor {
  double force, moment, direction;
};
Rotor rotor_of(const ModelDef& model, const PluginDef& plugin, const Propeller& propeller, std::vector<std::string>& left_out) {
  const auto& setup = propeller.setup();
  Rotor rotor{setup.constant, setup.moment, setup.direction};
  const ParameterNode* all = plugin.parameters.child("rotorConfiguration");
  for (const ParameterNode& one : all != nullptr ? all->children : std::vector<ParameterNode>{}) {
    if (joint_named(model, plugin.scope, one.text_of({"jointName"}).value_or("")) != propeller.joint()) continue;
    rotor.force = one.number_of({"forceConstant"}).value_or(rotor.force);
    rotor.moment = one.number_of({"momentConstant"}).value_or(rotor.moment);
    rotor.direction = one.number_of({"direction"}).value_or(rotor.direction);
    if (rotor.direction * setup.direction > 0) continue;
    left_out.push_back(plugin.source + ": plugin " + base::in_quotes(plugin.name) + ": <direction> of joint " +
                       base::in_quotes(model.joints[propeller.joint()].name) + " is " + base::format_number(rotor.direction) +
                       ", but its motor (" + setup.source + ") turns " + (setup.direction > 0 ? "ccw, which is 1" : "cw, which is -1") +
                       "; the vehicle turns about its vertical axis the wrong way");
  }
  return rotor;
}

}  // namespace

Weight weight_of(const ModelDef& model, const Eigen::Isometry3d& frame) {
  const Eigen::Isometry3d into = frame.inverse();
  Weight weight;
  for (const LinkDef& one : model.links) {
    weight.mass += one.mass;
    weight.center += one.mass * (into * one.pose * one.center_of_mass);
  }
  weight.center /= weight.mass;
  for (const LinkDef& one : model.links) {
    const Eigen::Isometry3d pose = into * one.pose;
    const Eigen::Vector3d arm = pose * one.center_of_mass - weight.center;
    weight.inertia += pose.linear() * one.inertia * pose.linear().transpose();
    weight.inertia += one.mass * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  }
  return weight;
}

std::unique_ptr<VehicleControl> make_multicopter(const DeviceWorld& world, ModelId model, const PluginDef& plugin,
                                                 const Propellers& propellers, std::vector<std::string>& left_out) {
  const Physics& physics = world.physics;
  const ModelDef& def = physics.def(model);
  const auto link = link_named(def, plugin.scope, plugin.parameters.text_of({"comLinkName"}).value_or(""));
  const LinkId body{model, link.value_or(physics.canonical_link(model).link)};
  const Weight weight = weight_of(def, def.links[body.link].pose);
  const auto count = static_cast<Eigen::Index>(propellers.all().size());
  Eigen::MatrixXd efforts = Eigen::MatrixXd::Zero(4, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Propeller& propeller = propellers.all()[static_cast<std::size_t>(i)];
    if (!propeller.setup().is_rotor) continue;
    const Rotor rotor = rotor_of(def, plugin, propeller, left_out);
    const Eigen::Vector3d place =
        def.links[body.link].pose.inverse() * def.joints[propeller.joint()].pose_in_model.translation() - weight.center;
    efforts.col(i) << rotor.force * place.y(), -rotor.force * place.x(), -rotor.direction * rotor.force * rotor.moment, rotor.force;
  }
  const Eigen::Matrix4d square = efforts * efforts.transpose();
  const Eigen::FullPivLU<Eigen::Matrix4d> factors(square / std::max(square.cwiseAbs().maxCoeff(), 1e-300));
  Eigen::MatrixXd squares = efforts.transpose() * square.inverse();
  if (!squares.allFinite() || factors.rcond() < 1e-12) {
    left_out.push_back(plugin.source + ": plugin " + base::in_quotes(plugin.name) + ": the rotors of model " + base::in_quotes(def.name) +
                       " cannot turn it about all axes; it has no position3d");
    return nullptr;
  }
  return std::make_unique<Multicopter>(body, weight, numbers_of(plugin.parameters, weight), std::move(squares),
                                       world.world.physics.gravity);
}

}  // namespace sim
