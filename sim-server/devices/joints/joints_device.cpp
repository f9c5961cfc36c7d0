#include "devices/joints/joints_device.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/text.h"
#include "shm/joint_part.h"

namespace sim {
namespace {

static_assert(static_cast<int>(JointMode::disabled) == RTMSIM_JOINT_DISABLED && static_cast<int>(JointMode::brake) == RTMSIM_JOINT_BRAKE);
static_assert(static_cast<int>(JointStatus::stalled) == RTMSIM_JOINT_STALLED);

// The end of a place in a file says more than its beginning.
std::string shortened(const std::string& text, std::size_t most) {
  constexpr std::string_view cut = "...";
  return text.size() <= most ? text : std::string(cut) + text.substr(text.size() - most + cut.size());
}

// A propeller's limits are those of its speed and thrust.
void list_propellers(std::vector<ListedJoint>& joints, const Propellers& propellers) {
  for (ListedJoint& listed : joints) {
    const auto place = propellers.find(listed.joint);
    if (!place) continue;
    const Propeller& propeller = propellers.all()[*place];
    listed.setup.velocity = propeller.setup().max_speed;
    listed.setup.effort = propeller.max_thrust();
    listed.setup.is_compensated = false;
    listed.gains_from = "propeller of " + propeller.setup().source;
  }
}

std::vector<shm::Joint> describe(const ModelDef& model, const std::vector<ListedJoint>& joints, const JointDynamics& dynamics) {
  std::vector<shm::Joint> all;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointDef& def = model.joints[joints[i].joint];
    const auto& setup = joints[i].setup;
    const JointDynamics::Body& body = dynamics.body(i);
    shm::Joint joint{};
    shm::set_text(joint.name, def.name);
    shm::set_text(joint.link, def.child);
    shm::set_text(joint.gains_from, shortened(joints[i].gains_from, sizeof joint.gains_from - 1));
    joint.id = static_cast<std::uint32_t>(i);
    joint.kind = setup.slides ? RTMSIM_JOINT_SLIDES : RTMSIM_JOINT_TURNS;
    joint.parent = static_cast<std::uint32_t>(body.parent + 1);
    joint.compensated = setup.is_compensated ? 1 : 0;
    joint.lower = setup.low, joint.upper = setup.high;
    joint.max_velocity = setup.velocity, joint.max_effort = setup.effort;
    joint.rest = def.axes[0].initial_position;
    joint.p = setup.gains.p, joint.i = setup.gains.i, joint.d = setup.gains.d;
    for (int k = 0; k < 3; ++k) joint.axis[k] = body.axis[k];
    joint.pose = to_pose(body.in_parent);
    all.push_back(joint);
  }
  return all;
}

}  // namespace

base::Result<std::unique_ptr<Device>> JointsDevice::make(DeviceWorld& world, ModelId model, std::shared_ptr<Propellers> propellers) {
  const ModelDef& def = world.physics.def(model);
  const auto joints = commandable_joints(def);
  if (joints.empty()) return std::unique_ptr<Device>();
  JointDynamics dynamics(def, joints);
  auto list = list_joints(def, joints, dynamics, world.world.physics.gravity.norm());
  if (propellers) list_propellers(list, *propellers);
  shm::JointsInfo info{};
  info.rate = stated_rate(world, 0);
  shm::set_text(info.model, def.name);
  const auto described = describe(def, list, dynamics);
  auto setup = set_up(world, model, 0, shm::joints_spec(name_of(def), info, described), {});
  if (!setup) return setup.error();
  return std::unique_ptr<Device>(
      std::make_unique<JointsDevice>(std::move(*setup), std::move(list), std::move(dynamics), std::move(propellers)));
}

JointsDevice::JointsDevice(Setup setup, std::vector<ListedJoint> joints, JointDynamics dynamics, std::shared_ptr<Propellers> propellers)
    : Sensor(std::move(setup)), dynamics_(std::move(dynamics)), propellers_(std::move(propellers)) {
  for (auto& listed : joints) {
    const JointServo servo(listed.setup);
    axes_.push_back({std::move(listed), servo});
    if (propellers_) axes_.back().propeller = propellers_->find(axes_.back().listed.joint);
  }
  const ModelDef& def = physics().def(model());
  carrier_ = link_of(def, {}, def.joints[axes_.front().listed.joint].parent);
  states_.resize(axes_.size());
  positions_.resize(axes_.size());
  gravity_.resize(axes_.size());
}

void JointsDevice::warn(const std::string& line) const { base::log(base::Level::warn, writer().name(), "{}", line); }

// Least and most of a command.
std::pair<double, double> JointsDevice::range_of(const Axis& axis, JointMode mode) const {
  const auto& setup = axis.listed.setup;
  if (mode == JointMode::position) return {setup.low, setup.high};
  if (axis.propeller) return propellers_->all()[*axis.propeller].range(mode == JointMode::effort);
  const double most = mode == JointMode::velocity ? setup.velocity : setup.effort;
  return {-most, most};
}

void JointsDevice::order(Axis& axis, std::uint64_t owner, const JointOrder& order) {
  if (axis.is_halted) {
    axis.told = {owner, order};
    return;
  }
  const std::string& name = name_of(axis);
  if (axis.listed.leader >= 0) {
    if (std::exchange(axis.was_within, false))
      warn(fmt::format("joint {}: follows joint {} and takes no commands", name,
                       name_of(axes_[static_cast<std::size_t>(axis.listed.leader)])));
    return;
  }
  const std::pair<std::uint64_t, std::uint64_t> rivals = std::minmax({axis.owner, owner});
  if (axis.owner != 0 && axis.owner != owner && iface().holds_lease(axis.owner) && std::exchange(axis.rivals, rivals) != rivals) {
    warn(fmt::format("joint {}: {} takes it from {}, which commanded it", name, iface().client_name(owner),
                     iface().client_name(axis.owner)));
  }
  axis.owner = owner;
  is_active_ = true;
  const auto [least, most] = range_of(axis, order.mode);
  const bool is_taken = axis.servo.take(order, state_of(axis));
  const bool commands_propeller = axis.propeller && (order.mode == JointMode::velocity || order.mode == JointMode::effort);
  const bool is_within = is_taken && (!commands_propeller || (order.value >= least && order.value <= most));
  if (!is_within && axis.was_within)
    warn(fmt::format("joint {}: the command {:g} is outside of {:g} to {:g}, the nearest of which counts", name, order.value, least, most));
  axis.was_within = is_within;
}

void JointsDevice::take(std::uint64_t owner, const shm::Command& command) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    JointOrder order;
    if (command.kind == shm::CommandKind::stop) {
      if (axes_[i].owner != owner) continue;
      order.mode = JointMode::brake;
    } else if (command.kind == shm::CommandKind::joints) {
      const double* values = command.values.data() + RTMSIM_JOINT_VALUES * i;
      if (!(values[0] >= 1)) continue;
      const auto word = static_cast<std::uint32_t>(std::min(values[0], 1e9)), gain = word >> shm::joint_gain_shift;
      const std::uint32_t mode = word & ((1U << shm::joint_gain_shift) - 1);
      if (gain > shm::max_joint_gain + 1) continue;
      if (gain > 0) order.gain = (gain - 1) / 100.0;
      order.is_compensated = (mode & RTMSIM_JOINT_COMPENSATED) != 0;
      order.mode = static_cast<JointMode>(mode & 0xffU);
      if ((mode & ~(RTMSIM_JOINT_COMPENSATED | 0xffU)) != 0 || order.mode > JointMode::brake) continue;
      order.value = values[1], order.velocity = values[2], order.effort = values[3];
    } else {
      continue;
    }
    this->order(axes_[i], owner, order);
  }
}

// Those of a client that went.
void JointsDevice::brake_lost_joints() {
  if (std::exchange(owners_seen_, iface().owners_change()) == owners_seen_) return;
  std::size_t count = 0;
  for (Axis& axis : axes_) {
    if (axis.owner == 0 || iface().holds_lease(axis.owner)) continue;
    axis.owner = 0;
    if (axis.servo.mode() == JointMode::brake) continue;
    order(axis, 0, {.mode = JointMode::brake});
    ++count;
  }
  if (count > 0) warn(fmt::format("the client that commanded {} of {} joints has exited or detached: they brake", count, axes_.size()));
}

// Of what carries the first joint, which may lean, against its place in the model at the start.
Eigen::Matrix3d JointsDevice::base_rotation() const {
  if (!carrier_ || dynamics_.body(0).parent >= 0) return physics().model_pose(model()).linear();
  return physics().link_pose({model(), *carrier_}).linear() * physics().def(model()).links[*carrier_].pose.linear().transpose();
}

void JointsDevice::compute_gravity() {
  if (std::none_of(axes_.begin(), axes_.end(), [](const Axis& axis) { return axis.servo.wants_gravity(); })) return;
  const Eigen::Vector3d gravity = base_rotation().transpose() * world().world.physics.gravity;
  dynamics_.efforts(positions_, {}, {}, gravity, gravity_);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto& listed = axes_[i].listed;
    if (listed.leader >= 0) gravity_[static_cast<std::size_t>(listed.leader)] += listed.multiplier * gravity_[i];
  }
}

void JointsDevice::before_step(const Moment& moment) {
  iface().poll_commands([this](std::uint64_t owner, const shm::Command& command) { take(owner, command); });
  if (is_active_) brake_lost_joints();
  if (propellers_) turn_propellers(moment);
  if (!is_active_) return;
  for (std::size_t i = 0; i < axes_.size(); ++i) states_[i] = state_of(axes_[i]), positions_[i] = states_[i].position;
  compute_gravity();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Axis& axis = axes_[i];
    if (!axis.servo.is_active() || axis.propeller) continue;
    const bool was_disabled = axis.servo.mode() == JointMode::disabled;
    const JointRow row = axis.servo.row(states_[i], axis.servo.wants_gravity() ? gravity_[i] : 0, moment.dt);
    if (!was_disabled && axis.servo.mode() == JointMode::disabled)
      warn(fmt::format("joint {}: its position or command is no number; it is disabled until a reset", name_of(axis)));
    world().physics.set_row({model(), axis.listed.joint}, row);
  }
}

// Those that a client commands follow it, the others the vehicle.
void JointsDevice::turn_propellers(const Moment& moment) {
  for (Axis& axis : axes_) {
    if (!axis.propeller) continue;
    Propeller& propeller = propellers_->all()[*axis.propeller];
    const Propellers::Wish own{axis.servo.mode() == JointMode::effort, axis.servo.is_turning() ? axis.servo.target() : 0};
    Propellers::Wish& wish = propellers_->followed[*axis.propeller];
    if (!axis.is_halted) wish = axis.owner != 0 ? own : propellers_->wishes[*axis.propeller];
    wish.is_thrust ? propeller.set_thrust(wish.value) : propeller.set_speed(wish.value);
    propeller.before_step(world().physics, physics().wind(), moment.dt);
  }
}

void JointsDevice::after_step(const Moment& moment) {
  if (!is_active_) return;
  for (Axis& axis : axes_) {
    if (axis.servo.is_active() && !axis.propeller) axis.servo.follow(state_of(axis), moment.dt);
  }
}

void JointsDevice::measure(const Moment&) const {
  auto& out = sample<shm::JointsSample>();
  const std::span<shm::JointState> states = followers<shm::JointState>(0);
  out.count = static_cast<std::uint32_t>(axes_.size());
  out.commanded = 0;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Axis& axis = axes_[i];
    const JointState now = state_of(axis);
    if (axis.owner != 0) ++out.commanded;
    states[i] = {now.position,
                 now.velocity,
                 axis.servo.effort(),
                 axis.servo.target(),
                 static_cast<std::uint32_t>(axis.servo.mode()),
                 static_cast<std::uint32_t>(axis.servo.status())};
    if (!axis.propeller) continue;
    const Propeller& propeller = propellers_->all()[*axis.propeller];
    states[i].velocity = propeller.speed(physics());
    states[i].effort = propeller.thrust();
    states[i].status = now.velocity != 0 ? RTMSIM_JOINT_MOVING : RTMSIM_JOINT_IDLE;
  }
}

base::Result<std::size_t> JointsDevice::find(std::string_view joint) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    names.push_back(name_of(axes_[i]));
    if (names.back() == joint) return i;
  }
  return base::Error{"there is no joint " + base::in_quotes(joint) + ", only " + base::join(names, ", ")};
}

void JointsDevice::set_fault(std::size_t joint, double strength, bool is_halted) {
  Axis& axis = axes_[joint];
  axis.strength = strength;
  apply_strength(axis);
  axis.is_halted = is_halted;
  if (is_halted || !axis.told) return;
  const Told told = *std::exchange(axis.told, std::nullopt);
  const bool is_there = told.owner != 0 && iface().holds_lease(told.owner);
  order(axis, is_there ? told.owner : 0, is_there ? told.order : JointOrder{.mode = JointMode::brake});
}

void JointsDevice::set_power(bool has_power) {
  has_power_ = has_power;
  for (Axis& axis : axes_) apply_strength(axis);
}

void JointsDevice::apply_strength(Axis& axis) {
  const double strength = has_power_ ? axis.strength : 0;
  axis.servo.set_strength(strength);
  if (axis.propeller) propellers_->all()[*axis.propeller].set_strength(strength);
}

void JointsDevice::restart() {
  has_power_ = true;
  for (Axis& axis : axes_) {
    axis.told.reset();
    axis.servo.reset();
    axis.strength = 1;
    axis.owner = 0;
    axis.was_within = true;
  }
  is_active_ = false;
  for (std::size_t i = 0; propellers_ && i < propellers_->all().size(); ++i) {
    propellers_->all()[i].reset();
    propellers_->wishes[i] = propellers_->followed[i] = {};
  }
}

void JointsDevice::add_state_to(StateHash& hash) const {
  for (std::size_t i = 0; propellers_ && i < propellers_->all().size(); ++i) propellers_->all()[i].add_to(hash);
  if (!is_active_) return;  // worlds whose joints nobody commands keep their hashes
  hash.add(writer().name());
  for (const Axis& axis : axes_) {
    axis.servo.add_to(hash);
    if (!axis.told) continue;
    const JointOrder& order = axis.told->order;
    hash.add_all(static_cast<std::uint64_t>(order.mode), order.value, order.velocity, order.effort);
  }
}

}  // namespace sim
