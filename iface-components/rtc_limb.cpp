#include "rtc_limb.h"

#include <map>

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
  if (!limb_.begin(part(), tool_, speed_)) RTC_WARN(("joints must name a chain from base to tip, each joint carried by the one before"));
}

void RTCLimb::set_power(bool is_on) {
  limb_.measure(part());
  limb_.set_power(is_on);
}

void RTCLimb::set_brakes(bool are_on) {
  limb_.measure(part());
  limb_.set_brakes(are_on);
}

void RTCLimb::set_speed(double speed) {
  const arms::Reply reply = limb_.set_speed(speed);
  if (!reply.is_ok()) RTC_WARN(("SetSpeed: %s", reply.comment.c_str()));
}

// The newest pose counts.
void RTCLimb::read_ports() {
  bool is_new = false;
  while (pose_in_.isNew()) is_new = pose_in_.read() || is_new;
  if (!is_new) return;
  limb_.measure(part());
  const arms::Reply reply = limb_.go(to_isometry(pose_.data));
  if (!reply.is_ok() && refusal_ != reply.comment) RTC_WARN(("pose: %s; it is ignored", reply.comment.c_str()));
  refusal_ = reply.comment;
}

void RTCLimb::step() { note(limb_.step(part())); }

void RTCLimb::publish(const shm::Stamp& stamp) {
  if (!limb_.is_there()) return;
  using Status = arms::Limb::Status;
  static const std::map<Status, RTC::LimbStatus> states = {{Status::idle, RTC::LIMB_STATUS_IDLE},
                                                           {Status::braked, RTC::LIMB_STATUS_BRAKED},
                                                           {Status::moving, RTC::LIMB_STATUS_MOVING},
                                                           {Status::out_of_reach, RTC::LIMB_STATUS_OOR},
                                                           {Status::collision, RTC::LIMB_STATUS_COLLISION}};
  const Eigen::Isometry3d tip = limb_.pose();
  state_.tm = iface::to_time(stamp.sim_time_ns);
  const auto set = [](auto& out, const Eigen::Vector3d& vector) { out.x = vector.x(), out.y = vector.y(), out.z = vector.z(); };
  set(state_.oapMatrix.orientation, tip.linear().col(1));
  set(state_.oapMatrix.approach, tip.linear().col(2));
  set(state_.oapMatrix.position, tip.translation());
  state_.status = states.at(limb_.status());
  state_out_.write();
}

extern "C" {
void RTCLimbInit(RTC::Manager* manager) { iface::register_type<RTCLimb>(manager, specification); }
}
