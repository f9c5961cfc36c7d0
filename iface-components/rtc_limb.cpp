#include "rtc_limb.h"

#include <algorithm>

#include "conversions.h"

static const iface::Specification specification{
    .type_name = "RTCLimb",
    .description = "Tip of a simulated arm",
    .phase = iface::command_phase,
    .device = "arm::joints",
    .parameters = {{"joints", "waist,shoulder,elbow,roll,pitch,twist", "string", "text"},
                   {"tool", "0", "double", "text"},
                   {"speed", "0.25", "double", "text", "x>0"}},
};

namespace {

using iface::Manipulator;
using iface::Planner;
using Positions = std::vector<double>;

constexpr std::uint32_t overload_alarm = 2;

Eigen::Isometry3d to_isometry(const RTC::Pose3D& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translation() = Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z);
  out.rotate(Eigen::AngleAxisd(pose.orientation.y, Eigen::Vector3d::UnitZ()));
  out.rotate(Eigen::AngleAxisd(pose.orientation.p, Eigen::Vector3d::UnitY()));
  out.rotate(Eigen::AngleAxisd(pose.orientation.r, Eigen::Vector3d::UnitX()));
  return out;
}

}  // namespace

RTC::Geometry3D LimbService::GetGeometry() {
  RTC::Geometry3D geometry{};
  const auto joints = owner_.described();
  if (!joints.empty()) geometry.pose = iface::to_pose(joints.front().pose);
  return geometry;
}
void LimbService::Power(CORBA::Boolean enable) {
  owner_.post("Power", [this, enable] { owner_.set_power(enable); });
}
void LimbService::Brakes(CORBA::Boolean enable) {
  owner_.post("Brakes", [this, enable] { owner_.set_brakes(enable); });
}
void LimbService::SetSpeed(CORBA::Double speed) {
  owner_.post("SetSpeed", [this, speed] { owner_.set_speed(speed); });
}

RTCLimb::RTCLimb(RTC::Manager* manager)
    : JointComponent(manager, specification),
      pose_in_("pose", pose_),
      state_out_("state", state_),
      service_port_("limb"),
      service_(*this) {}

RTC::ReturnCode_t RTCLimb::onInitialize() {
  addInPort("pose", pose_in_);
  addOutPort("state", state_out_);
  service_port_.registerProvider("limb", "RTC::Limb", service_);
  addPort(service_port_);
  bindJoints();
  bind("tool", tool_);
  bind("speed", speed_);
  return RTC::RTC_OK;
}

void RTCLimb::chosen() {
  std::vector<shm::Joint> joints;
  for (std::size_t i = 0; i < part().size(); ++i) joints.push_back(part().joint(i));
  if (!iface::is_chain(joints)) RTC_WARN(("joints must name a chain from base to tip, each joint carried by the one before"));
  if (!iface::is_chain(joints)) joints.clear();
  arm_.begin(joints, false, 1);
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
  tool.translation().z() = tool_;
  arm_.set_tool(tool);
  if (arm_.axes() > 0 && part().has_states()) arm_.feed(feedback());
  is_out_of_reach_ = false;
  goal_.reset();
  set_speed(speed_);
}

void RTCLimb::set_power(bool is_on) {
  is_powered_ = is_on;
  apply_brakes();
}

void RTCLimb::set_brakes(bool are_on) {
  has_brakes_on_ = are_on;
  apply_brakes();
}

// Without power the brakes hold as well.
void RTCLimb::apply_brakes() {
  if (is_held()) arm_.set_servo(false), goal_.reset();
  for (std::size_t i = 0; i < part().size(); ++i) {
    if (is_held()) {
      part().brake(i);
    } else if (part().is_held(i)) {
      part().hold(i);
    }
  }
}

void RTCLimb::set_speed(double speed) {
  constexpr double turn = 3;  // [rad] that the tip may turn while it moves a metre
  const iface::Reply reply = arm_.set_max_cartesian_speed(speed, speed * turn);
  if (!reply.is_ok()) RTC_WARN(("SetSpeed: %s; it is ignored", reply.comment.c_str()));
}

// The newest pose counts.
void RTCLimb::read_ports() {
  bool is_new = false;
  while (pose_in_.isNew()) is_new = pose_in_.read() || is_new;
  if (is_new) go(pose_.data);
}

// On a straight line where the arm can, else through joint space.
void RTCLimb::go(const RTC::Pose3D& pose) {
  if (is_held()) {
    RTC_WARN(("%s; the pose is ignored", is_powered_ ? "the brakes are on" : "the power is off"));
    return;
  }
  const Eigen::Isometry3d goal = to_isometry(pose);
  if (goal_ && arm_.alarms().empty() && goal_->isApprox(goal, 1e-9)) return;
  // A pose that is not possible leaves the motion as it is.
  const iface::Reply possible = arm_.planner().to_pose(arm_.feedback().positions, goal, false).reply;
  is_out_of_reach_ = !possible.is_ok();
  if (is_out_of_reach_) {
    RTC_WARN(("pose: %s; it is ignored", possible.comment.c_str()));
    return;
  }
  arm_.clear_alarms();
  arm_.set_servo(true);
  arm_.stop();
  goal_ = goal;
  const auto line = arm_.move([&](const Planner& planner, const Positions& from) { return planner.along_line(from, goal, false); });
  if (!line.is_ok()) arm_.move([&](const Planner& planner, const Positions& from) { return planner.to_pose(from, goal, false); });
}

Manipulator::Feedback RTCLimb::feedback() const {
  Manipulator::Feedback now;
  for (std::size_t i = 0; i < part().size(); ++i) {
    now.positions.push_back(part().state(i).position);
    if (part().state(i).status == RTMSIM_JOINT_STALLED) now.overloaded = i;
  }
  return now;
}

void RTCLimb::step() {
  if (arm_.axes() == 0) return;
  arm_.feed(feedback());
  if (part().was_reset()) arm_.restart(), goal_.reset(), is_out_of_reach_ = false;
  const auto target = arm_.advance(part().dt());
  for (std::size_t i = 0; target && i < part().size(); ++i) note(part().follow(i, target->positions[i], target->velocities[i], 0));
}

RTC::LimbStatus RTCLimb::status() const {
  const auto& alarms = arm_.alarms();
  const auto is_overload = [](const Manipulator::Alarm& alarm) { return alarm.code == overload_alarm; };
  if (is_held()) return RTC::LIMB_STATUS_BRAKED;
  if (std::ranges::any_of(alarms, is_overload)) return RTC::LIMB_STATUS_COLLISION;
  if ((arm_.state() & Manipulator::is_moving) != 0) return RTC::LIMB_STATUS_MOVING;
  return is_out_of_reach_ ? RTC::LIMB_STATUS_OOR : RTC::LIMB_STATUS_IDLE;
}

void RTCLimb::publish(const shm::Stamp& stamp) {
  if (arm_.axes() == 0) return;
  const Eigen::Isometry3d tip = arm_.pose();
  state_.tm = iface::to_time(stamp.sim_time_ns);
  const auto set = [](auto& out, const Eigen::Vector3d& vector) { out.x = vector.x(), out.y = vector.y(), out.z = vector.z(); };
  set(state_.oapMatrix.orientation, tip.linear().col(1));
  set(state_.oapMatrix.approach, tip.linear().col(2));
  set(state_.oapMatrix.position, tip.translation());
  state_.status = status();
  state_out_.write();
}

extern "C" {
void RTCLimbInit(RTC::Manager* manager) { iface::register_type<RTCLimb>(manager, specification); }
}
