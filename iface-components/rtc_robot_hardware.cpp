#include "rtc_robot_hardware.h"

#include <base/text.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "conversions.h"

static const iface::Specification specification{
    .type_name = "RTCRobotHardware",
    .description = "Joints of a simulated robot, with the ports of hrpsys",
    .phase = iface::command_phase,
    .device = "arm::joints",
    .parameters = {{"joints", "", "string", "text"}, {"servo", "1", "int", "radio", "(0,1)"}, {"sensors", "", "string", "text"}},
};

namespace {

using Service = OpenHRP::RobotHardwareService;

constexpr std::int32_t torque_limit_alarm = 0x20;

std::string name_of(const shm::Joint& joint) { return {joint.name, strnlen(joint.name, sizeof joint.name)}; }

template <class Sequence, class Value>
void fill(Sequence& sequence, const std::vector<Value>& values) {
  sequence.length(static_cast<CORBA::ULong>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) sequence[static_cast<CORBA::ULong>(i)] = values[i];
}

template <class State>
void fill_state(State& state, const RTCRobotHardware::Status& status) {
  fill(state.angle, status.position);
  fill(state.command, status.command);
  fill(state.torque, status.effort);
  state.servoState.length(static_cast<CORBA::ULong>(status.servo.size()));
  for (std::size_t i = 0; i < status.servo.size(); ++i) {
    auto& each = state.servoState[static_cast<CORBA::ULong>(i)];
    each.length(1);
    each[0] = status.servo[i];
  }
  const auto fill_sensors = [](auto& sequence, const std::vector<std::vector<double>>& values) {
    sequence.length(static_cast<CORBA::ULong>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) fill(sequence[static_cast<CORBA::ULong>(i)], values[i]);
  };
  fill_sensors(state.force, status.force);
  fill_sensors(state.rateGyro, status.rate);
  fill_sensors(state.accel, status.acceleration);
  state.voltage = state.current = 0;
}

}  // namespace

struct RTCRobotHardware::Sensor {
  enum class Kind { rate, accel, force };
  Sensor(const std::string& port, Kind what, std::string iface_name, iface::Say say)
      : kind(what),
        iface(std::move(iface_name)),
        link(what == Kind::force ? shm::IfaceType::force_torque : shm::IfaceType::imu, std::move(say)),
        rate_out(port.c_str(), rate),
        accel_out(port.c_str(), accel),
        force_out(port.c_str(), force),
        values(what == Kind::force ? 6 : 3) {}
  RTC::OutPortBase& port() {
    return kind == Kind::rate    ? static_cast<RTC::OutPortBase&>(rate_out)
           : kind == Kind::accel ? accel_out
                                 : static_cast<RTC::OutPortBase&>(force_out);
  }
  // What the iface has, when it is new.
  bool read() {
    const shm::Iface* now = link.fresh(std::chrono::nanoseconds(0));
    if (now == nullptr || now->sample<shm::Stamp>().valid == 0) return false;
    time = iface::to_time(now->sample<shm::Stamp>().sim_time_ns);
    const auto take = [&](const double* from, std::size_t at) {
      std::copy(from, from + 3, values.begin() + static_cast<std::ptrdiff_t>(at));
    };
    if (kind == Kind::force) {
      const auto& sample = now->sample<shm::ForceTorqueSample>();
      take(sample.force, 0), take(sample.torque, 3);
    } else {
      const auto& sample = now->sample<shm::ImuSample>();
      take(kind == Kind::rate ? sample.angular_velocity : sample.acceleration, 0);
    }
    return true;
  }
  void write() {
    rate.tm = accel.tm = force.tm = time;
    if (kind == Kind::rate) rate.data = {values[0], values[1], values[2]}, rate_out.write();
    if (kind == Kind::accel) accel.data = {values[0], values[1], values[2]}, accel_out.write();
    if (kind == Kind::force) fill(force.data, values), force_out.write();
  }

  Kind kind;
  std::string iface;
  iface::IfaceLink link;
  RTC::TimedAngularVelocity3D rate;
  RTC::TimedAcceleration3D accel;
  RTC::TimedDoubleSeq force;
  RTC::OutPort<RTC::TimedAngularVelocity3D> rate_out;
  RTC::OutPort<RTC::TimedAcceleration3D> accel_out;
  RTC::OutPort<RTC::TimedDoubleSeq> force_out;
  std::vector<double> values;
  RTC::Time time{};
};

void RobotHardware::getStatus(Service::RobotState_out state) {
  state = new Service::RobotState();
  fill_state(*state, owner_.status());
}
void RobotHardware::getStatus2(Service::RobotState2_out state) {
  state = new Service::RobotState2();
  fill_state(*state, owner_.status());
}
CORBA::Boolean RobotHardware::power(const char* name, Service::SwitchStatus status) {
  const auto joints = owner_.joints_named(name);
  const bool is_on = status == Service::SWITCH_ON;
  return !joints.empty() && owner_.post("power", [this, joints, is_on] { owner_.set_power(joints, is_on); });
}
CORBA::Boolean RobotHardware::servo(const char* name, Service::SwitchStatus status) {
  const auto joints = owner_.joints_named(name);
  const bool is_on = status == Service::SWITCH_ON;
  return !joints.empty() && owner_.post("servo", [this, joints, is_on] { owner_.set_servo(joints, is_on); });
}
void RobotHardware::setServoGainPercentage(const char* name, CORBA::Double percentage) {
  const auto joints = owner_.joints_named(name);
  owner_.post("setServoGainPercentage", [this, joints, percentage] { owner_.set_gain(joints, percentage); });
}
void RobotHardware::setJointControlMode(const char* name, Service::JointControlMode mode) {
  const auto joints = owner_.joints_named(name);
  owner_.post("setJointControlMode", [this, joints, mode] { owner_.set_mode(joints, mode); });
}
void RobotHardware::setServoErrorLimit(const char* name, CORBA::Double limit) {
  const auto joints = owner_.joints_named(name);
  owner_.post("setServoErrorLimit", [this, joints, limit] { owner_.set_error_limit(joints, limit); });
}
CORBA::Boolean RobotHardware::addJointGroup(const char* group, const Service::StrSequence& joints) {
  std::vector<std::string> names;
  for (CORBA::ULong i = 0; i < joints.length(); ++i) names.emplace_back(joints[i].in());
  return owner_.add_group(group, names);
}
CORBA::Boolean RobotHardware::readDigitalInput(Service::OctSequence_out bits) {
  bits = new Service::OctSequence();
  return false;
}
CORBA::Boolean RobotHardware::readDigitalOutput(Service::OctSequence_out bits) {
  bits = new Service::OctSequence();
  return false;
}

RTCRobotHardware::RTCRobotHardware(RTC::Manager* manager)
    : JointComponent(manager, specification),
      q_ref_in_("qRef", q_ref_),
      dq_ref_in_("dqRef", dq_ref_),
      tau_ref_in_("tauRef", tau_ref_),
      q_out_("q", q_),
      dq_out_("dq", dq_),
      tau_out_("tau", tau_),
      ctau_out_("ctau", ctau_),
      servo_state_out_("servoState", servo_state_),
      service_port_("RobotHardwareService"),
      service_(*this) {}

RTCRobotHardware::~RTCRobotHardware() = default;

RTC::ReturnCode_t RTCRobotHardware::onInitialize() {
  addInPort("qRef", q_ref_in_);
  addInPort("dqRef", dq_ref_in_);
  addInPort("tauRef", tau_ref_in_);
  addOutPort("q", q_out_);
  addOutPort("dq", dq_out_);
  addOutPort("tau", tau_out_);
  addOutPort("ctau", ctau_out_);
  addOutPort("servoState", servo_state_out_);
  service_port_.registerProvider("service0", "RobotHardwareService", service_);
  addPort(service_port_);
  bindJoints();
  bind("servo", servo_);
  add_sensors();
  return RTC::RTC_OK;
}

// Names of ports cannot change after the ports are made.
void RTCRobotHardware::add_sensors() {
  using Kind = Sensor::Kind;
  static const std::map<std::string, Kind> kinds = {{"rate", Kind::rate}, {"accel", Kind::accel}, {"force", Kind::force}};
  for (const std::string& word : base::split_list(getProperties().getProperty("conf.default.sensors"))) {
    const auto equals = word.find('='), colon = word.find(':', equals == std::string::npos ? 0 : equals);
    const auto kind =
        equals == std::string::npos || colon == std::string::npos ? kinds.end() : kinds.find(word.substr(equals + 1, colon - equals - 1));
    if (kind == kinds.end() || equals == 0 || colon + 1 == word.size()) {
      RTC_WARN(("sensors: expected NAME=KIND:IFACE with kind rate, accel or force, got \"%s\"; it is ignored", word.c_str()));
      continue;
    }
    sensors_.push_back(std::make_unique<Sensor>(word.substr(0, equals), kind->second, word.substr(colon + 1), say()));
    addOutPort(word.substr(0, equals).c_str(), sensors_.back()->port());
  }
}

void RTCRobotHardware::attached(const iface::Device& device) {
  JointComponent::attached(device);
  for (const auto& sensor : sensors_) note(sensor->link.attach({device.server_id, sensor->iface}, true));
}

void RTCRobotHardware::detaching() {
  JointComponent::detaching();
  for (const auto& sensor : sensors_) sensor->link.detach();
}

void RTCRobotHardware::read_sensors(Status& now) {
  for (const auto& sensor : sensors_) {
    if (sensor->read()) sensor->write();
    auto& all = sensor->kind == Sensor::Kind::force ? now.force : sensor->kind == Sensor::Kind::rate ? now.rate : now.acceleration;
    all.push_back(sensor->values);
  }
}

std::vector<std::size_t> RTCRobotHardware::joints_named(const std::string& name) const {
  const auto joints = described();
  std::vector<std::string> members{name};
  {
    const auto groups = groups_.lock();
    if (const auto found = groups->find(name); found != groups->end()) members = found->second;
  }
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (base::to_lower(name) == "all" || std::ranges::find(members, name_of(joints[i])) != members.end()) numbers.push_back(i);
  }
  return numbers;
}

bool RTCRobotHardware::add_group(const std::string& name, const std::vector<std::string>& joints) {
  constexpr std::size_t most = 1000;
  const bool are_known = std::ranges::all_of(joints, [this](const std::string& joint) { return joints_named(joint).size() == 1; });
  auto groups = groups_.lock();
  if (!are_known || groups->contains(name) || groups->size() >= most) return false;
  groups->emplace(name, joints);
  return true;
}

// As many servos as joints.
void RTCRobotHardware::fit() {
  if (servos_.size() == part().size()) return;
  servos_.assign(part().size(), Servo{.is_on = servo_ != 0});
  for (Reference* reference : {&positions_, &velocities_, &efforts_}) reference->has_come = false;
}

void RTCRobotHardware::set_servo(const std::vector<std::size_t>& joints, bool is_on) {
  fit();
  for (const std::size_t i : joints) {
    if (i < servos_.size()) servos_[i].is_on = is_on, apply(i);
  }
}

void RTCRobotHardware::set_power(const std::vector<std::size_t>& joints, bool is_on) {
  fit();
  for (const std::size_t i : joints) {
    if (i < servos_.size()) servos_[i].is_powered = is_on, apply(i);
  }
}

void RTCRobotHardware::set_error_limit(const std::vector<std::size_t>& joints, double limit) {
  fit();
  if (!(limit >= 0)) return note(base::Error{"the limit of servo errors must be 0 (none) or more, got " + base::format_number(limit)});
  for (const std::size_t i : joints) {
    if (i < servos_.size()) servos_[i].error_limit = limit;
  }
}

void RTCRobotHardware::set_gain(const std::vector<std::size_t>& joints, double percent) {
  for (const std::size_t i : joints) {
    if (i < part().size()) note(part().set_gain(i, percent));
  }
}

// What has come for the old mode counts no more.
void RTCRobotHardware::set_mode(const std::vector<std::size_t>& joints, ControlMode mode) {
  fit();
  for (const std::size_t i : joints) {
    if (i >= servos_.size()) continue;
    servos_[i].mode = mode;
    apply(i);
  }
}

// Without servo or power the brakes hold; with both the joint stays where it is until a reference comes.
void RTCRobotHardware::apply(std::size_t i) {
  const bool is_free = servos_[i].mode == OpenHRP::RobotHardwareService::FREE;
  servos_[i].is_active() ? (is_free ? part().free(i) : part().hold(i)) : part().brake(i);
}

// The newest; one whose length is wrong is said once.
bool RTCRobotHardware::read(Reference& reference) {
  bool is_new = false;
  while (reference.port.isNew()) is_new = reference.port.read() || is_new;
  if (!is_new) return false;
  const bool is_right = reference.data.data.length() == part().size();
  if (!is_right && reference.was_right) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < part().size(); ++i) names.push_back(name_of(part().joint(i)));
    note(base::Error{std::string(reference.name) + " has " + std::to_string(reference.data.data.length()) + " values; expected " +
                     std::to_string(part().size()) + ": " + base::join(names, ", ") + "; it is ignored"});
  }
  reference.was_right = is_right;
  reference.has_come = reference.has_come || is_right;
  return is_right;
}

double RTCRobotHardware::value(const Reference& reference, std::size_t i) const {
  return reference.has_come && i < reference.data.data.length() ? reference.data.data[static_cast<CORBA::ULong>(i)] : 0;
}

void RTCRobotHardware::read_ports() {
  fit();
  const bool has_q = read(positions_), has_dq = read(velocities_), has_tau = read(efforts_);
  for (std::size_t i = 0; i < part().size(); ++i) {
    if (servos_[i].is_active()) command(i, has_q, has_dq, has_tau);
  }
}

void RTCRobotHardware::command(std::size_t i, bool has_q, bool has_dq, bool has_tau) {
  const auto mode = servos_[i].mode;
  const bool is_free = mode == Service::FREE, is_position = mode == Service::POSITION;
  const bool is_torque = mode == Service::TORQUE || (!mode && !positions_.has_come && !velocities_.has_come);
  const bool is_velocity = mode == Service::VELOCITY || (!mode && !positions_.has_come && velocities_.has_come);
  if (is_free) return;
  const shm::Joint& joint = part().joint(i);
  const auto effort = [&] { return limited(efforts_, i, -joint.max_effort, joint.max_effort); };
  const auto velocity = [&] { return limited(velocities_, i, -joint.max_velocity, joint.max_velocity); };
  if (is_torque) {
    if (const auto wanted = has_tau ? effort() : std::nullopt) note(part().push(i, *wanted));
  } else if (is_velocity) {
    if (const auto wanted = has_dq ? velocity() : std::nullopt) note(part().turn(i, *wanted));
  } else if (positions_.has_come && (has_q || has_dq || (has_tau && !is_position))) {
    const auto position = limited(positions_, i, joint.lower, joint.upper);
    if (position) note(part().follow(i, *position, velocity().value_or(0), is_position ? 0 : effort().value_or(0)));
  }
}

std::optional<double> RTCRobotHardware::limited(const Reference& reference, std::size_t i, double low, double high) {
  const double wanted = value(reference, i);
  const bool is_number = std::isfinite(wanted);
  if (is_number && wanted >= low && wanted <= high) return wanted;
  const std::string what = std::string(reference.name) + " of joint " + name_of(part().joint(i));
  const std::string limits = base::format_number(low) + " and " + base::format_number(high);
  note(base::Error{what + " must be within " + limits + ", got " + (is_number ? base::format_number(wanted) : "no number") + "; " +
                   (is_number ? "the nearest limit counts" : "it is ignored")});
  return is_number ? std::optional(std::clamp(wanted, low, high)) : std::nullopt;
}

void RTCRobotHardware::step() {
  for (std::size_t i = 0; i < part().size(); ++i) {
    Servo& servo = servos_[i];
    const auto& state = part().state(i);
    if (!servo.is_active() || !(servo.error_limit > 0) || state.mode != RTMSIM_JOINT_POSITION) continue;
    const double error = state.target - state.position;
    if (std::abs(error) <= servo.error_limit) continue;
    note(base::Error{"joint " + name_of(part().joint(i)) + ": servo error " + base::format_number(error) + " exceeds the limit " +
                     base::format_number(servo.error_limit) + "; its servo is off"});
    servo.is_on = false;
    apply(i);
  }
}

void RTCRobotHardware::publish(const shm::Stamp& stamp) {
  Status now;
  std::vector<double> velocities, commanded;
  for (std::size_t i = 0; i < part().size(); ++i) {
    const auto& state = part().state(i);
    now.position.push_back(state.position);
    now.command.push_back(state.mode == RTMSIM_JOINT_POSITION ? state.target : state.position);
    now.effort.push_back(state.effort);
    velocities.push_back(state.velocity);
    commanded.push_back(state.mode == RTMSIM_JOINT_EFFORT ? state.target : state.effort);
    const std::int32_t alarm = state.status == RTMSIM_JOINT_STALLED ? torque_limit_alarm : 0;
    now.servo.push_back(1 | (servos_[i].is_active() ? 2 : 0) | (servos_[i].is_powered ? 4 : 0) | alarm << Service::SERVO_ALARM_SHIFT);
  }
  const RTC::Time time = iface::to_time(stamp.sim_time_ns);
  q_.tm = dq_.tm = tau_.tm = ctau_.tm = servo_state_.tm = time;
  fill(q_.data, now.position);
  fill(dq_.data, velocities);
  fill(tau_.data, now.effort);
  fill(ctau_.data, commanded);
  q_out_.write();
  dq_out_.write();
  tau_out_.write();
  ctau_out_.write();
  servo_state_.data.length(static_cast<CORBA::ULong>(now.servo.size()));
  for (CORBA::ULong i = 0; i < servo_state_.data.length(); ++i) {
    servo_state_.data[i].length(1);
    servo_state_.data[i][0] = now.servo[i];
  }
  servo_state_out_.write();
  read_sensors(now);
  *status_.lock() = std::move(now);
}

extern "C" {
void RTCRobotHardwareInit(RTC::Manager* manager) { iface::register_type<RTCRobotHardware>(manager, specification); }
}
