#include "rtc_act_array.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "conversions.h"

static const iface::Specification specification{
    .type_name = "RTCActArray",
    .description = "Joints of a simulated arm",
    .phase = iface::command_phase,
    .device = "arm::joints",
    .parameters = {{"joints", "", "string", "text"}},
    .inport_buffer = 1024,
};

namespace {

constexpr std::uint16_t all_joints = 65535;
constexpr double no_limit = 1e9;

RTC::ActArrayActuatorGeometry geometry_of(const shm::Joint& joint, const shm::Joint* next) {
  RTC::ActArrayActuatorGeometry geometry{};
  geometry.type = joint.kind == RTMSIM_JOINT_SLIDES ? RTC::ACTARRAY_ACTUATORTYPE_LINEAR : RTC::ACTARRAY_ACTUATORTYPE_ROTARY;
  if (next != nullptr) {
    geometry.length = std::hypot(next->pose.x, next->pose.y, next->pose.z);
    geometry.orientation = iface::to_orientation(next->pose);
  }
  geometry.axis.x = joint.axis[0], geometry.axis.y = joint.axis[1], geometry.axis.z = joint.axis[2];
  geometry.minRange = std::max(joint.lower, -no_limit), geometry.maxRange = std::min(joint.upper, no_limit);
  geometry.centre = std::isfinite(joint.lower + joint.upper) ? (joint.lower + joint.upper) / 2 : 0;
  geometry.homePosition = joint.rest;
  geometry.hasBrakes = true;
  return geometry;
}

}  // namespace

RTC::ActArrayGeometry* ActArrayService::GetGeometry() {
  RTC::ActArrayGeometry_var geometry = new RTC::ActArrayGeometry();
  const auto joints = owner_.described();
  geometry->actuatorGeometry.length(static_cast<CORBA::ULong>(joints.size()));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    geometry->actuatorGeometry[static_cast<CORBA::ULong>(i)] = geometry_of(joints[i], i + 1 < joints.size() ? &joints[i + 1] : nullptr);
  }
  if (!joints.empty()) geometry->arrayGeometry.pose = iface::to_pose(joints.front().pose);
  return geometry._retn();
}

void ActArrayService::GoHome(CORBA::UShort index) {
  owner_.post("GoHome", [this, index] { owner_.go_home(index); });
}
void ActArrayService::Power(CORBA::Boolean enable) {
  owner_.post("Power", [this, enable] { owner_.set_power(enable); });
}
void ActArrayService::Brakes(CORBA::Boolean enable) {
  owner_.post("Brakes", [this, enable] { owner_.set_brakes(enable); });
}
void ActArrayService::ConfigSpeed(CORBA::UShort index, CORBA::Double speed) {
  owner_.post("ConfigSpeed", [this, index, speed] { owner_.set_speed(index, speed); });
}
void ActArrayService::ConfigAccel(CORBA::UShort index, CORBA::Double accel) {
  owner_.post("ConfigAccel", [this, index, accel] { owner_.set_acceleration(index, accel); });
}

RTCActArray::RTCActArray(RTC::Manager* manager)
    : JointComponent(manager, specification),
      position_in_("position", position_),
      speed_in_("speed", speed_),
      current_in_("current", current_),
      state_out_("state", state_),
      service_port_("act_array"),
      service_(*this) {}

RTC::ReturnCode_t RTCActArray::onInitialize() {
  addInPort("position", position_in_);
  addInPort("speed", speed_in_);
  addInPort("current", current_in_);
  addOutPort("state", state_out_);
  service_port_.registerProvider("act_array", "RTC::ActArray", service_);
  addPort(service_port_);
  bindJoints();
  return RTC::RTC_OK;
}

void RTCActArray::for_joint(std::uint16_t index, const std::function<base::Result<void>(std::size_t)>& work) {
  if (index != all_joints && index >= part().size()) {
    const std::string known = part().size() > 0 ? "only 0 to " + std::to_string(part().size() - 1) : "nor any other";
    note(base::Error{"there is no joint " + std::to_string(index) + ", " + known + "; the command is ignored"});
    return;
  }
  for (std::size_t i = index == all_joints ? 0 : index; i < part().size() && (index == all_joints || i == index); ++i) note(work(i));
}

bool RTCActArray::may_move() {
  if (is_powered_ && !has_brakes_on_) return true;
  note(base::Error{std::string(is_powered_ ? "the brakes are on" : "the power is off") + "; the command is ignored"});
  return false;
}

void RTCActArray::go_home(std::uint16_t index) {
  if (!may_move()) return;
  for_joint(index, [this](std::size_t i) { return part().move(i, part().joint(i).rest); });
}

void RTCActArray::set_power(bool is_on) {
  is_powered_ = is_on;
  apply_brakes();
}

void RTCActArray::set_brakes(bool are_on) {
  has_brakes_on_ = are_on;
  apply_brakes();
}

// Without power the brakes hold the arm as well.
void RTCActArray::apply_brakes() {
  const bool is_held = !is_powered_ || has_brakes_on_;
  for (std::size_t i = 0; i < part().size(); ++i) {
    if (is_held) {
      part().brake(i);
    } else if (part().is_held(i)) {
      part().hold(i);
    }
  }
}

void RTCActArray::set_speed(std::uint16_t index, double speed) {
  for_joint(index, [&](std::size_t i) { return part().set_speed(i, speed); });
}
void RTCActArray::set_acceleration(std::uint16_t index, double acceleration) {
  for_joint(index, [&](std::size_t i) { return part().set_acceleration(i, acceleration); });
}

void RTCActArray::read_ports() {
  while (position_in_.isNew() && position_in_.read()) {
    if (may_move()) for_joint(position_.index, [&](std::size_t i) { return part().move(i, position_.position); });
  }
  while (speed_in_.isNew() && speed_in_.read()) {
    if (may_move()) for_joint(speed_.index, [&](std::size_t i) { return part().turn(i, speed_.speed); });
  }
  while (current_in_.isNew() && current_in_.read()) {
    if (may_move()) for_joint(current_.index, [&](std::size_t i) { return part().push(i, current_.current); });
  }
}

void RTCActArray::publish(const shm::Stamp& stamp) {
  const double dt = static_cast<double>(stamp.sim_time_ns - last_ns_) * 1e-9;
  last_speeds_.resize(part().size());
  state_.tm = iface::to_time(stamp.sim_time_ns);
  state_.actuators.length(static_cast<CORBA::ULong>(part().size()));
  for (std::size_t i = 0; i < part().size(); ++i) {
    const auto& now = part().state(i);
    auto& out = state_.actuators[static_cast<CORBA::ULong>(i)];
    out.position = now.position;
    out.speed = now.velocity;
    out.accel = dt > 0 ? (now.velocity - last_speeds_[i]) / dt : 0;
    out.current = now.effort;
    out.status = static_cast<RTC::ActArrayActuatorStatus>(now.status);
    if (part().is_moving(i) && now.status == RTMSIM_JOINT_IDLE) out.status = RTC::ACTUATOR_STATUS_MOVING;
    last_speeds_[i] = now.velocity;
  }
  last_ns_ = stamp.sim_time_ns;
  state_out_.write();
}

extern "C" {
void RTCActArrayInit(RTC::Manager* manager) { iface::register_type<RTCActArray>(manager, specification); }
}
