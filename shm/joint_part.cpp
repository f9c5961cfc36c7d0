#include "shm/joint_part.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/text.h"

namespace shm {
namespace {

constexpr double time_to_full_speed = 0.25;  // [s] while no acceleration is set
// [s] that the simulator continues a motion without a new command. After a longer wait than twice the one before, the motion is where the
// joint was told to stop, not where it would be: the joint would hurry after it, faster than its speed.
constexpr double max_command_age = 0.05;

std::string name_of(const Joint& joint) { return {joint.name, strnlen(joint.name, sizeof joint.name)}; }

base::Error outside(const std::string& joint, const std::string& what, double value, double low, double high) {
  return base::Error{"joint " + joint + ": " + what + " must be within " + base::format_number(low) + " and " + base::format_number(high) +
                     ", got " + (std::isnan(value) ? "nan" : base::format_number(value)) + "; it is ignored"};
}

}  // namespace

void JointMotion::advance(double dt) {
  const double missing = goal - position, step = acceleration * dt;
  // So fast that it can stop at the goal.
  const double stopping = std::sqrt(step * step / 4 + 2 * acceleration * std::abs(missing)) - step / 2;
  const double wanted = std::copysign(std::min(speed, stopping), missing);
  velocity += std::clamp(wanted - velocity, -step, step);
  if (std::abs(missing) <= std::abs(velocity) * dt + 1e-9 && std::abs(velocity) <= 1.5 * step) {
    position = goal;
    velocity = 0;
    return;
  }
  position += velocity * dt;
}

base::Result<void> JointPart::choose(const Iface& iface, std::string_view names) {
  const std::span<const Joint> all(reinterpret_cast<const Joint*>(iface.info_followers(0)), iface.count());
  std::vector<Member> chosen;
  const auto add = [&](const Joint& joint) {
    Member member;
    member.joint = joint;
    member.motion.speed = joint.max_velocity;
    member.motion.acceleration = joint.max_velocity / time_to_full_speed;
    chosen.push_back(member);
  };
  const auto words = base::split_list(names);
  if (words.empty()) std::ranges::for_each(all, add);
  for (const std::string& name : words) {
    const auto found = std::ranges::find_if(all, [&](const Joint& joint) { return name_of(joint) == name; });
    if (found == all.end()) {
      std::vector<std::string> known;
      for (const auto& joint : all) known.push_back(name_of(joint));
      return base::Error{"iface " + iface.name() + " has no joint " + base::in_quotes(name) + "; it has " + base::join(known, ", ")};
    }
    add(*found);
  }
  members_ = std::move(chosen);
  values_.assign(RTMSIM_JOINT_VALUES * iface.count(), 0.0);
  time_ns_ = -1, was_reset_ = false;
  return {};
}

void JointPart::read(const Iface& iface) {
  const auto& stamp = iface.sample<JointsSample>().stamp;
  const auto* states = reinterpret_cast<const JointState*>(iface.sample_followers(0));
  const bool is_first = time_ns_ < 0 || std::exchange(starts_anew_, false),
             is_reset = !is_first && (stamp.resets != resets_ || stamp.sim_time_ns < time_ns_);
  const double longest = std::max(max_command_age, 2 * dt_);
  const double dt = dt_ = is_first || is_reset ? 0 : static_cast<double>(stamp.sim_time_ns - time_ns_) * 1e-9;
  time_ns_ = stamp.sim_time_ns, resets_ = stamp.resets, was_reset_ = is_reset;
  for (Member& member : members_) {
    if (member.joint.id < iface.count()) member.state = states[member.joint.id];
    if (is_reset) member.mode = RTMSIM_JOINT_NONE, member.has_changed = false;
    if (member.mode != RTMSIM_JOINT_POSITION || member.is_path || member.motion.has_arrived() || dt <= 0) continue;
    member.motion.advance(std::min(dt, longest));
    member.has_changed = true;
  }
}

base::Result<void> JointPart::send(Iface& iface) {
  const auto has_changed = [](const Member& member) { return member.has_changed; };
  if (std::ranges::none_of(members_, has_changed)) return {};
  for (Member& member : members_) {
    double* at = values_.data() + static_cast<std::size_t>(RTMSIM_JOINT_VALUES) * member.joint.id;
    const bool is_motion = member.mode == RTMSIM_JOINT_POSITION && !member.is_path;
    at[0] = member.mode | (member.gain == 100 ? 0 : (member.gain + 1) << joint_gain_shift);
    at[1] = is_motion ? member.motion.position : member.value;
    at[2] = is_motion ? member.motion.velocity : member.velocity;
    at[3] = member.effort;
    member.has_changed = false;
  }
  return iface.command(CommandKind::joints, values_);
}

std::string JointPart::text_of(std::size_t i) const { return name_of(members_[i].joint); }

void JointPart::order(Member& member, std::uint32_t mode, double value, double effort) {
  member.mode = mode, member.value = value, member.effort = effort;
  member.velocity = 0, member.is_path = false;
  member.has_changed = true;
}

base::Result<void> JointPart::move(std::size_t i, double goal) {
  Member& member = members_[i];
  if (!(goal >= member.joint.lower && goal <= member.joint.upper) || std::isinf(goal))
    return outside(text_of(i), "a position", goal, member.joint.lower, member.joint.upper);
  if (member.mode != RTMSIM_JOINT_POSITION || member.is_path) {
    member.motion.position = std::clamp(member.state.position, member.joint.lower, member.joint.upper);
    member.motion.velocity = member.state.velocity;
  }
  member.motion.goal = goal;
  order(member, RTMSIM_JOINT_POSITION, goal);
  return {};
}

base::Result<void> JointPart::turn(std::size_t i, double velocity, double max_effort) {
  const double most = members_[i].joint.max_velocity;
  if (!(std::abs(velocity) <= most)) return outside(text_of(i), "a speed", velocity, -most, most);
  order(members_[i], RTMSIM_JOINT_VELOCITY, velocity, max_effort);
  return {};
}

base::Result<void> JointPart::push(std::size_t i, double effort) {
  const double most = members_[i].joint.max_effort;
  if (!(std::abs(effort) <= most)) return outside(text_of(i), "an effort", effort, -most, most);
  order(members_[i], RTMSIM_JOINT_EFFORT, effort);
  return {};
}

base::Result<void> JointPart::follow(std::size_t i, double position, double velocity, double effort) {
  Member& member = members_[i];
  if (!(position >= member.joint.lower && position <= member.joint.upper) || std::isinf(position))
    return outside(text_of(i), "a position", position, member.joint.lower, member.joint.upper);
  if (!std::isfinite(velocity) || !std::isfinite(effort)) return outside(text_of(i), "a velocity or effort", std::nan(""), -1e9, 1e9);
  order(member, RTMSIM_JOINT_POSITION, position, effort);
  member.velocity = velocity, member.is_path = true;
  return {};
}

base::Result<void> JointPart::set_gain(std::size_t i, double percent) {
  if (!(percent >= 0 && percent <= max_joint_gain)) return outside(text_of(i), "a gain in percent", percent, 0, max_joint_gain);
  Member& member = members_[i];
  member.gain = static_cast<std::uint32_t>(std::lround(percent));
  member.has_changed = member.has_changed || member.mode != RTMSIM_JOINT_NONE;
  return {};
}

void JointPart::free(std::size_t i) { order(members_[i], RTMSIM_JOINT_FREE, 0); }

void JointPart::brake(std::size_t i) { order(members_[i], RTMSIM_JOINT_BRAKE, 0); }

void JointPart::hold(std::size_t i) {
  Member& member = members_[i];
  member.motion.position = member.motion.goal = std::clamp(member.state.position, member.joint.lower, member.joint.upper);
  member.motion.velocity = 0;
  order(member, RTMSIM_JOINT_POSITION, member.motion.goal);
}

base::Result<void> JointPart::set_speed(std::size_t i, double speed) {
  const double most = members_[i].joint.max_velocity;
  if (!(speed > 0 && speed <= most)) return outside(text_of(i), "a speed", speed, 0, most);
  members_[i].motion.speed = speed;
  return {};
}

base::Result<void> JointPart::set_acceleration(std::size_t i, double acceleration) {
  constexpr double most = 1e6;
  if (!(acceleration > 0 && acceleration <= most)) return outside(text_of(i), "an acceleration", acceleration, 0, most);
  members_[i].motion.acceleration = acceleration;
  return {};
}

bool JointPart::is_moving(std::size_t i) const {
  const Member& member = members_[i];
  return (member.mode == RTMSIM_JOINT_POSITION && !member.is_path && !member.motion.has_arrived()) ||
         member.state.status == RTMSIM_JOINT_MOVING;
}

}  // namespace shm
