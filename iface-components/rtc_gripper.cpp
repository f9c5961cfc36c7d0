#include "rtc_gripper.h"

#include <base/text.h>

#include <algorithm>
#include <cmath>

#include "conversions.h"

static const iface::Specification specification{
    .type_name = "RTCGripper",
    .description = "Gripper of a simulated arm",
    .phase = iface::command_phase,
    .device = "arm::joints",
    .parameters = {{"joints", "left_finger,right_finger", "string", "text"},
                   {"open", "", "string", "text"},
                   {"closed", "", "string", "text"},
                   {"force", "0", "double", "text", "x>=0"},
                   {"speed", "0.5", "double", "text", "0<x<=1"}},
};

namespace {

constexpr double near = 0.02;  // of the way between open and closed

}  // namespace

RTC::GripperGeometry GripperService::GetGeometry() { return owner_.geometry(); }
void GripperService::Open() {
  owner_.post("Open", [this] { owner_.open(); });
}
void GripperService::Close() {
  owner_.post("Close", [this] { owner_.close(); });
}

RTCGripper::RTCGripper(RTC::Manager* manager)
    : JointComponent(manager, specification), state_out_("state", state_), service_port_("gripper"), service_(*this) {}

RTC::ReturnCode_t RTCGripper::onInitialize() {
  addOutPort("state", state_out_);
  service_port_.registerProvider("gripper", "RTC::Gripper", service_);
  addPort(service_port_);
  bindJoints();
  bind("open", open_);
  bind("closed", closed_);
  bind("force", force_);
  bind("speed", speed_);
  return RTC::RTC_OK;
}

double RTCGripper::open_position(std::size_t i) const { return base::parse_number(open_).value_or(part().joint(i).upper); }
double RTCGripper::closed_position(std::size_t i) const { return base::parse_number(closed_).value_or(part().joint(i).lower); }

void RTCGripper::open() {
  for (std::size_t i = 0; i < part().size(); ++i) {
    note(part().set_speed(i, speed_ * part().joint(i).max_velocity));
    note(part().move(i, open_position(i)));
  }
}

// Until something stops them: then they press with the force.
void RTCGripper::close() {
  for (std::size_t i = 0; i < part().size(); ++i) {
    const double way = closed_position(i) - open_position(i);
    note(part().turn(i, std::copysign(speed_ * part().joint(i).max_velocity, way), std::min(force_, part().joint(i).max_effort)));
  }
}

// The fingers' way is the room between them.
RTC::GripperGeometry RTCGripper::geometry() const {
  RTC::GripperGeometry geometry{};
  const auto joints = described();
  if (joints.empty()) return geometry;
  double width = 0;
  for (const auto& joint : joints) width += joint.kind == RTMSIM_JOINT_SLIDES ? joint.upper - joint.lower : 0;
  geometry.exterior.pose = geometry.interior.pose = iface::to_pose(joints.front().pose);
  geometry.exterior.size.w = geometry.interior.size.w = std::isfinite(width) ? width : 0;
  return geometry;
}

RTC::GripperStatus RTCGripper::status() const {
  std::size_t opened = 0, closed = 0, stalled = 0, moving = 0;
  for (std::size_t i = 0; i < part().size(); ++i) {
    const auto& now = part().state(i);
    const double from = open_position(i), way = closed_position(i) - from;
    const double done = way != 0 ? (now.position - from) / way : 0;
    opened += done < near ? 1 : 0;
    closed += done > 1 - near ? 1 : 0;
    stalled += now.status == RTMSIM_JOINT_STALLED ? 1 : 0;
    moving += part().is_moving(i) ? 1 : 0;
  }
  const std::size_t count = part().size();
  if (count == 0) return RTC::GRIPPER_STATE_UNKNOWN;
  if (closed + stalled >= count) return RTC::GRIPPER_STATE_CLOSED;
  if (moving > 0) return RTC::GRIPPER_STATE_MOVING;
  return opened == count ? RTC::GRIPPER_STATE_OPEN : RTC::GRIPPER_STATE_UNKNOWN;
}

void RTCGripper::publish(const shm::Stamp& stamp) {
  state_.tm = iface::to_time(stamp.sim_time_ns);
  state_.status = status();
  state_out_.write();
}

extern "C" {
void RTCGripperInit(RTC::Manager* manager) { iface::register_type<RTCGripper>(manager, specification); }
}
