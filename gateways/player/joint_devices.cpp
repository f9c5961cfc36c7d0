#include "joint_devices.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/log.h"
#include "base/text.h"
#include "protocol/payloads.h"

namespace gateway {
namespace {

constexpr std::int64_t show_period = 10'000'000;  // [ns] of simulated time between two messages of data
constexpr std::size_t max_waiting = 64, max_logged = 100;
constexpr double unlimited = 1e9;  // [rad or m]; what a joint without limits says

float limit(double value) { return static_cast<float>(std::clamp(value, -unlimited, unlimited)); }

}  // namespace

// ---- all ----

void JointDevice::choose(const JointGroup& group) { group_ = group; }

void JointDevice::on_attach() {
  commands_.reset();
  commanding_client_ = nullptr;
  on_unused();
  const auto chosen = part_.choose(iface(), base::join(group_.joints, ","));
  if (!chosen) part_.clear();
  note(chosen);
  begin();
}

void JointDevice::on_unused() {
  has_state_ = false;
  waiting_.clear();
  shown_ns_ = -1;
}

void JointDevice::note(const base::Result<void>& done) {
  if (done || logged_.size() >= max_logged || !logged_.insert(done.error().message).second) return;
  base::log(base::Level::warn, "player-gateway", "{}: {}", player::to_text(address()), done.error().message);
}

base::Result<void> JointDevice::for_joint(std::int32_t joint, const std::function<base::Result<void>(std::size_t)>& work) {
  const bool is_all = joint == -1;
  if (!is_all && (joint < 0 || static_cast<std::size_t>(joint) >= part_.size()))
    return base::Error{"there is no joint " + std::to_string(joint) + ", only 0 to " + std::to_string(part_.size() - 1)};
  for (std::size_t i = 0; i < part_.size(); ++i) {
    if (!is_all && i != static_cast<std::size_t>(joint)) continue;
    if (const auto done = work(i); !done) return done;
  }
  return {};
}

void JointDevice::brake() {
  for (std::size_t i = 0; i < part_.size(); ++i) part_.brake(i);
}

void JointDevice::release() {
  is_release_due_ = !has_state_;
  if (is_release_due_) return;
  for (std::size_t i = 0; i < part_.size(); ++i) {
    if (part_.is_held(i)) part_.hold(i);
  }
}

void JointDevice::send() {
  if (!commands_) {
    auto opened = shm::Iface::open(iface().server_id(), shm::IfaceType::joints, iface().name());
    if (!opened) return note(opened.error());
    commands_ = std::move(*opened);
  }
  note(part_.send(*commands_));
}

void JointDevice::show_sample() {
  const auto& stamp = iface().sample<shm::JointsSample>().stamp;
  if (part_.size() == 0) return;
  if (!is_for_newcomer() || !has_state_) {
    part_.read(iface());
    has_state_ = true;
    step();
    for (const auto& one : std::exchange(waiting_, {})) obey(*one.client, one.subtype, one.payload);
    if (is_release_due_) release();
    if (commands_) send();
  }
  if (!is_for_newcomer() && shown_ns_ >= 0 && stamp.sim_time_ns >= shown_ns_ && stamp.sim_time_ns < shown_ns_ + show_period) return;
  if (!is_for_newcomer()) shown_ns_ = stamp.sim_time_ns;
  show(stamp);
}

void JointDevice::obey(Client& client, std::uint8_t subtype, const std::string& payload) {
  if (part_.size() == 0) return;
  if (!has_state_) {
    if (waiting_.size() < max_waiting) waiting_.push_back({&client, subtype, payload});
    return;
  }
  commanding_client_ = &client;
  do_command(subtype, payload);
  send();
}

void JointDevice::forget(Client& client) {
  std::erase_if(waiting_, [&](const Waiting& one) { return one.client == &client; });
  if (commanding_client_ != &client) return;
  commanding_client_ = nullptr;
  let_go();
  if (!source() || !commands_) return;
  for (std::size_t i = 0; i < part_.size(); ++i) {
    if (part_.is_commanded(i)) part_.brake(i);
  }
  send();
}

// ---- actarray ----

void ActArray::begin() {
  is_powered_ = true, has_brakes_on_ = false;
  last_speeds_.assign(part().size(), 0);
  speeds_.clear();
  for (std::size_t i = 0; i < part().size(); ++i) speeds_.push_back(part().joint(i).max_velocity);
}

void ActArray::show(const shm::Stamp& stamp) {
  const double dt = static_cast<double>(stamp.sim_time_ns - last_ns_) * 1e-9;
  std::vector<player::Actuator> actuators;
  for (std::size_t i = 0; i < part().size(); ++i) {
    const shm::JointState& now = part().state(i);
    constexpr std::uint8_t idle = 1, moving = 2, braked = 4, stalled = 8;
    player::Actuator one{static_cast<float>(now.position), static_cast<float>(now.velocity), 0, static_cast<float>(now.effort), idle};
    if (dt > 0) one.acceleration = static_cast<float>((now.velocity - last_speeds_[i]) / dt);
    if (now.status == RTMSIM_JOINT_MOVING || part().is_moving(i)) one.state = moving;
    if (now.status == RTMSIM_JOINT_BRAKED) one.state = braked;
    if (now.status == RTMSIM_JOINT_STALLED || now.mode == RTMSIM_JOINT_DISABLED) one.state = stalled;
    last_speeds_[i] = now.velocity;
    actuators.push_back(one);
  }
  last_ns_ = stamp.sim_time_ns;
  publish(1, player::encode(actuators, is_powered_), stamp);
}

std::string ActArray::geometry() const {
  std::vector<player::ActuatorGeometry> all;
  for (std::size_t i = 0; i < part().size(); ++i) {
    const shm::Joint& joint = part().joint(i);
    player::ActuatorGeometry one;
    one.turns = joint.kind == RTMSIM_JOINT_TURNS;
    one.axis = {joint.axis[0], joint.axis[1], joint.axis[2]};
    one.min = limit(joint.lower), one.max = limit(joint.upper);
    one.centre = std::isfinite(joint.lower + joint.upper) ? static_cast<float>((joint.lower + joint.upper) / 2) : 0;
    one.home = static_cast<float>(joint.rest);
    one.speed = static_cast<float>(speeds_[i]);
    if (i + 1 < part().size() && part().joint(i + 1).parent == joint.id + 1) {
      const shm::Pose& next = place(i + 1);
      one.length = static_cast<float>(std::hypot(next.x, next.y, next.z));
      one.orientation = to_pose3d(next);
    }
    all.push_back(one);
  }
  return player::encode(all, part().size() > 0 ? to_pose3d(place(0)) : player::Pose3d{});
}

// The geometry is always answered: client libraries do not see a rejection, and use what they have not got.
std::optional<Answer> ActArray::answer(std::uint8_t subtype, const std::string& payload, const Later&) {
  constexpr std::uint8_t power = 1, brakes = 2, get_geometry = 3, speed = 4;
  if (subtype == get_geometry) return ack(geometry());
  if (subtype == power || subtype == brakes) {
    const auto is_on = player::decode_byte(payload);
    if (!is_on || part().size() == 0) return nack();
    (subtype == power ? is_powered_ : has_brakes_on_) = *is_on != 0;
    may_move() ? release() : brake();
    send();
    return ack();
  }
  const auto wanted = player::decode_joint_number(payload);
  if (!wanted) return nack();
  const auto done = for_joint(wanted->joint, [&](std::size_t i) {
    const auto set = subtype == speed ? part().set_speed(i, wanted->value) : part().set_acceleration(i, wanted->value);
    if (set && subtype == speed) speeds_[i] = wanted->value;
    return set;
  });
  note(done);
  return done ? ack() : nack();
}

base::Result<void> ActArray::may_move() const {
  if (is_powered_ && !has_brakes_on_) return {};
  return base::Error{std::string(is_powered_ ? "the brakes are on" : "the power is off") + "; commands are ignored"};
}

base::Result<void> ActArray::command_one(std::uint8_t subtype, std::size_t joint, double value) {
  switch (subtype) {
    case 1:
    case 2:
      return part().move(joint, value);
    case 3:
    case 4:
      return part().turn(joint, value);
    default:
      return part().push(joint, value);
  }
}

void ActArray::do_command(std::uint8_t subtype, const std::string& payload) {
  constexpr std::uint8_t home = 5;
  if (const auto may = may_move(); !may) return note(may);
  if (subtype == home) {
    const auto joint = player::decode_joint(payload);
    if (joint) note(for_joint(*joint, [&](std::size_t i) { return part().move(i, part().joint(i).rest); }));
    return;
  }
  if (subtype == 1 || subtype == 3 || subtype == 6) {
    const auto wanted = player::decode_joint_number(payload);
    if (wanted) note(for_joint(wanted->joint, [&](std::size_t i) { return command_one(subtype, i, wanted->value); }));
    return;
  }
  const auto values = player::decode_joint_numbers(payload);
  if (!values) return;
  if (values->size() > part().size())
    return note(
        base::Error{"a command has " + std::to_string(values->size()) + " values for " + std::to_string(part().size()) + " joints"});
  for (std::size_t i = 0; i < values->size(); ++i) note(command_one(subtype, i, (*values)[i]));
}

// ---- gripper ----

std::uint8_t Gripper::state() const {
  constexpr double near = 0.02;  // of the way between open and closed
  std::size_t open = 0, closed = 0, moving = 0;
  for (std::size_t i = 0; i < part().size(); ++i) {
    const shm::JointState& now = part().state(i);
    const shm::Joint& joint = part().joint(i);
    if (now.mode == RTMSIM_JOINT_DISABLED) return 4;
    const double part_open = (now.position - joint.lower) / (joint.upper - joint.lower);
    const bool is_held = now.status == RTMSIM_JOINT_STALLED || (now.status == RTMSIM_JOINT_BRAKED && part_open < 1 - near);
    const bool is_closed = is_held || part_open < near;
    closed += is_closed ? 1 : 0;
    open += part_open > 1 - near ? 1 : 0;
    moving += !is_closed && part().is_moving(i) ? 1 : 0;
  }
  if (closed == part().size()) return 2;
  return moving > 0 || open < part().size() ? 3 : 1;
}

void Gripper::show(const shm::Stamp& stamp) { publish(1, player::encode(player::GripperState{state()}), stamp); }

// The way of the fingers is the room between them.
std::optional<Answer> Gripper::answer(std::uint8_t, const std::string&, const Later&) {
  if (part().size() == 0) return nack();
  double width = 0;
  for (std::size_t i = 0; i < part().size(); ++i) {
    const shm::Joint& joint = part().joint(i);
    if (joint.kind == RTMSIM_JOINT_SLIDES && std::isfinite(joint.upper - joint.lower)) width += joint.upper - joint.lower;
  }
  const player::Size3d size{.width = width};
  return ack(player::encode_gripper_geometry(to_pose3d(place(0)), size, size));
}

void Gripper::do_command(std::uint8_t subtype, const std::string& payload) {
  constexpr std::uint8_t open = 1, close = 2;
  constexpr double speed = 0.5;  // of the highest
  if (!payload.empty()) return;
  for (std::size_t i = 0; i < part().size(); ++i) {
    const shm::Joint& joint = part().joint(i);
    if (subtype == open) {
      note(part().set_speed(i, speed * joint.max_velocity));
      note(part().move(i, joint.upper));
    } else if (subtype == close) {
      note(part().turn(i, -speed * joint.max_velocity, joint.max_effort));  // until something stops it: then it presses
    } else {
      part().brake(i);
    }
  }
}

// ---- ptz ----

void Ptz::show(const shm::Stamp& stamp) {
  if (part().size() < 2) return;
  player::PtzState state;
  state.pan = static_cast<float>(part().state(0).position), state.tilt = static_cast<float>(part().state(1).position);
  state.pan_speed = static_cast<float>(part().state(0).velocity), state.tilt_speed = static_cast<float>(part().state(1).velocity);
  state.zoom = static_cast<float>(group().field_of_view);
  publish(1, player::encode(state), stamp);
}

std::optional<Answer> Ptz::answer(std::uint8_t subtype, const std::string& payload, const Later&) {
  constexpr std::uint8_t control_mode = 2, get_geometry = 4;
  constexpr std::uint32_t velocity = 0, position = 1;
  if (subtype == control_mode) {
    const auto mode = player::decode_u32(payload);
    if (!mode || (*mode != velocity && *mode != position)) return nack();
    has_velocities_ = *mode == velocity;
    return ack(player::encode_u32(*mode));
  }
  if (subtype == get_geometry) return part().size() > 0 ? ack(player::encode_geometry(to_pose3d(place(0)), {})) : nack();
  return ack(player::encode_u32(0));  // status: all is well
}

void Ptz::do_command(std::uint8_t, const std::string& payload) {
  const auto wanted = player::decode_ptz_command(payload);
  if (!wanted) return;
  if (part().size() < 2) return note(base::Error{"a pan and a tilt joint are needed, got " + std::to_string(part().size()) + " joints"});
  for (std::size_t i = 0; i < 2; ++i) {
    const double speed = i == 0 ? wanted->pan_speed : wanted->tilt_speed, goal = i == 0 ? wanted->pan : wanted->tilt;
    if (has_velocities_) {
      note(part().turn(i, speed));
      continue;
    }
    // 0: as fast as it can.
    if (speed >= 0) note(part().set_speed(i, speed > 0 ? std::min(speed, part().joint(i).max_velocity) : part().joint(i).max_velocity));
    note(part().move(i, goal));
  }
}

}  // namespace gateway
