#include "rtc_manipulator.h"

#include <base/text.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "conversions.h"

static const iface::Specification specification{
    .type_name = "RTCManipulator",
    .description = "Simulated arm with the common manipulator interface of JARA",
    .phase = iface::command_phase,
    .device = "arm::joints",
    .parameters = {{"joints", "waist,shoulder,elbow,roll,pitch,twist", "string", "text"},
                   {"gripper", "left_finger,right_finger", "string", "text"},
                   {"force", "0", "double", "text", "x>=0"},
                   {"speed", "50", "int", "spin", "0<=x<=100"},
                   {"units", "si", "string", "radio", "(si,deg_mm)"},
                   {"cycle", "1", "int", "spin", "1<=x<=1000"},
                   {"common", "common", "string", "text"},
                   {"middle", "middle", "string", "text"},
                   {"module", "JARA_ARM", "string", "radio", "(JARA_ARM,none)"}},
    .inport_buffer = 1024,
};

using arms::FingerCommand;
using arms::Manipulator;
using arms::Reply;

RTCManipulator::RTCManipulator(RTC::Manager* manager)
    : JointComponent(manager, specification),
      command_in_("command", command_),
      emergency_in_("emergency", emergency_),
      joints_out_("joints", joints_),
      common_port_("common"),
      middle_port_("middle"),
      common_service_(*this),
      middle_service_(*this) {}

RTC::ReturnCode_t RTCManipulator::onInitialize() {
  addInPort("command", command_in_);
  addInPort("emergency", emergency_in_);
  addOutPort("joints", joints_out_);
  bindJoints();
  bind("gripper", gripper_);
  bind("force", force_);
  bind("speed", speed_);
  bind("units", units_);
  bind("cycle", cycle_);
  addServices();
  return RTC::RTC_OK;
}

// Names of interfaces cannot change after the ports are made.
void RTCManipulator::addServices() {
  const auto value = [this](const std::string& name) {
    const std::string text = getProperties().getProperty("conf.default." + name);
    return text.empty() ? std::string(specification.value_of(name)) : text;
  };
  const std::string module = value("module") == "none" ? "" : "JARA_ARM::";
  common_port_.registerProvider(value("common").c_str(), (module + "ManipulatorCommonInterface_Common").c_str(), common_service_);
  middle_port_.registerProvider(value("middle").c_str(), (module + "ManipulatorCommonInterface_Middle").c_str(), middle_service_);
  addPort(common_port_);
  addPort(middle_port_);
}

std::string RTCManipulator::all_names(const std::string& joints) const { return gripper_.empty() ? joints : joints + "," + gripper_; }

void RTCManipulator::chosen() {
  const std::size_t fingers = base::split_list(gripper_).size();
  axes_ = part().size() > fingers ? part().size() - fingers : 0;
  std::vector<shm::Joint> arm;
  iface::ClientUnits units;
  units.is_deg_mm = units_ == "deg_mm";
  for (std::size_t i = 0; i < axes_; ++i) {
    arm.push_back(part().joint(i));
    units.slides.push_back(arm.back().kind == RTMSIM_JOINT_SLIDES);
  }
  const bool is_chain = arms::is_chain(arm);
  if (!is_chain && part().size() > 0)
    RTC_WARN(("joints must name a chain from base to tip, each joint carried by the one before; services answer NG"));
  was_servo_on_ = true;
  logged_alarms_ = 0;
  auto shared = shared_.lock();
  shared->units = units;
  shared->arm.begin(arm, part().size() > axes_, std::clamp(speed_, 0, 100) / 100.0, std::max(cycle_, 1));
  if (is_chain && part().has_states()) shared->arm.feed(feedback());
  shared->is_there = is_chain;
}

void RTCManipulator::detaching() {
  JointComponent::detaching();
  shared_.lock()->is_there = false;
}

Reply RTCManipulator::call(const Work& work) {
  auto shared = shared_.lock();
  if (!shared->is_there) return {arms::Answer::fault, "the component has no arm; its log names the reason"};
  return work(shared->arm, shared->units);
}

Reply RTCManipulator::move(const Planned& plan) {
  const auto mine = planning_turn_.take();
  Manipulator::Planning with;
  iface::ClientUnits units;
  const Reply state = call([&](Manipulator& arm, const iface::ClientUnits& now) {
    auto start = arm.planning();
    if (auto* reply = std::get_if<Reply>(&start)) return *reply;
    with = std::move(std::get<Manipulator::Planning>(start));
    units = now;
    return Reply{};
  });
  if (!state.is_ok()) return state;
  arms::Plan made = plan(with.planner, with.from, units);
  if (!made.motion) return made.reply;
  return call([&](Manipulator& arm, const auto&) { return arm.add(std::move(*made.motion), with.drops); });
}

// Of the first finger.
double RTCManipulator::finger_ratio() const {
  const std::size_t first = axes_;
  if (first >= part().size()) return 0;
  const shm::Joint& joint = part().joint(first);
  const double way = joint.upper - joint.lower;
  return way > 0 && std::isfinite(way) ? std::clamp((part().state(first).position - joint.lower) / way, 0.0, 1.0) : 0;
}

Manipulator::Feedback RTCManipulator::feedback() const {
  Manipulator::Feedback now;
  now.finger_ratio = finger_ratio();
  for (std::size_t i = 0; i < axes_; ++i) {
    now.positions.push_back(part().state(i).position);
    if (part().state(i).status == RTMSIM_JOINT_STALLED) now.overloaded = i;
  }
  constexpr double at_stop = 1e-3;  // [m or rad]; [m/s or rad/s]
  for (std::size_t i = axes_; i < part().size(); ++i) {
    const auto& finger = part().state(i);
    const bool is_closed = finger.position < part().joint(i).lower + at_stop && std::abs(finger.velocity) < at_stop;
    now.are_fingers_still = now.are_fingers_still && (is_closed || finger.status == RTMSIM_JOINT_STALLED || !part().is_moving(i));
  }
  return now;
}

void RTCManipulator::command_fingers(const FingerCommand& command) {
  for (std::size_t i = axes_; i < part().size(); ++i) {
    const shm::Joint& joint = part().joint(i);
    const double speed = joint.max_velocity / 2;
    if (command.kind == FingerCommand::Kind::close) {
      note(part().turn(i, -speed, std::min(force_, joint.max_effort)));
    } else if (command.kind == FingerCommand::Kind::hold) {
      part().hold(i);
    } else {
      note(part().set_speed(i, speed));
      note(part().move(i, joint.lower + command.ratio * (joint.upper - joint.lower)));
    }
  }
}

// One sample in each cycle. Without one the arm holds the last.
void RTCManipulator::read_ports() {
  bool is_signal = false;
  while (emergency_in_.isNew()) is_signal = emergency_in_.read() || is_signal;
  if (is_signal) (void)call([&](Manipulator& arm, const auto&) { return arm.set_emergency(emergency_.data), Reply{}; });
  command_wait_ns_ -= static_cast<std::int64_t>(std::llround(part().dt() * 1e9));
  if (command_wait_ns_ > 0 || !command_in_.isNew() || !command_in_.read()) {
    command_wait_ns_ = std::max<std::int64_t>(command_wait_ns_, 0);
    return;
  }
  command_wait_ns_ = static_cast<std::int64_t>(std::max(cycle_, 1)) * 1'000'000;
  const Reply reply = call([&](Manipulator& arm, const iface::ClientUnits& units) { return arm.follow(units.to_ours(command_.pos)); });
  if (!reply.is_ok() && was_command_right_) RTC_WARN(("command: %s; it is ignored", reply.comment.c_str()));
  was_command_right_ = reply.is_ok();
}

void RTCManipulator::log_alarms(const std::vector<Manipulator::Alarm>& alarms) {
  for (std::size_t i = logged_alarms_; i < alarms.size(); ++i)
    RTC_WARN(("alarm %u: %s; the arm stops", alarms[i].code, alarms[i].description.c_str()));
  logged_alarms_ = alarms.size();
}

void RTCManipulator::step() {
  std::optional<Manipulator::Target> target;
  std::optional<FingerCommand> fingers;
  std::vector<Manipulator::Alarm> alarms;
  {
    auto shared = shared_.lock();
    if (!shared->is_there) return;
    shared->units.is_deg_mm = units_ == "deg_mm";
    shared->arm.feed(feedback());
    if (part().was_reset()) shared->arm.restart();
    target = shared->arm.advance(part().dt());
    fingers = shared->arm.take_finger_command();
    alarms = shared->arm.alarms();
  }
  log_alarms(alarms);
  for (std::size_t i = 0; target && i < axes_; ++i) note(part().follow(i, target->positions[i], target->velocities[i], 0));
  const bool must_brake = !target && (was_servo_on_ || part().was_reset());
  for (std::size_t i = 0; must_brake && i < axes_; ++i) part().brake(i);
  was_servo_on_ = target.has_value();
  if (fingers) command_fingers(*fingers);
}

void RTCManipulator::publish(const shm::Stamp& stamp) {
  const std::size_t count = axes_;
  const bool has_fingers = count < part().size();
  joints_.tm = iface::to_time(stamp.sim_time_ns);
  joints_.pos.length(static_cast<CORBA::ULong>(count + (has_fingers ? 1 : 0)));
  const iface::ClientUnits units = shared_.lock()->units;
  for (std::size_t i = 0; i < count; ++i) joints_.pos[static_cast<CORBA::ULong>(i)] = part().state(i).position / units.joint(i);
  if (has_fingers) joints_.pos[static_cast<CORBA::ULong>(count)] = 100 * finger_ratio();
  joints_out_.write();
}

extern "C" {
void RTCManipulatorInit(RTC::Manager* manager) { iface::register_type<RTCManipulator>(manager, specification); }
}
