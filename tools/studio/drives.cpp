#include "studio/drives.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>

#include "base/text.h"

namespace studio {
namespace {

constexpr std::chrono::milliseconds timeout{500};
constexpr std::size_t max_handles = 256;

// In the order of RTMSIM_JOINT_POSITION to RTMSIM_JOINT_BRAKE.
constexpr std::array<std::string_view, 5> modes{"position", "velocity", "effort", "free", "brake"};
static_assert(RTMSIM_JOINT_POSITION == 1 && static_cast<std::size_t>(RTMSIM_JOINT_BRAKE) == modes.size());

base::Result<std::vector<double>> values_for(const shm::Iface& iface, std::span<const JointCommand> commands) {
  const std::span joints(reinterpret_cast<const shm::Joint*>(iface.info_followers(0)), iface.count());
  const auto name_of = [](const shm::Joint& joint) { return std::string(joint.name, strnlen(joint.name, sizeof joint.name)); };
  std::vector<double> values(RTMSIM_JOINT_VALUES * joints.size(), 0.0);
  for (const JointCommand& command : commands) {
    const auto joint = std::ranges::find(joints, command.joint, name_of);
    if (joint == joints.end()) {
      std::vector<std::string> names;
      std::ranges::transform(joints, std::back_inserter(names), name_of);
      return base::Error{"joint " + base::in_quotes(command.joint) + ": is not one of " + base::join(names, ", ")};
    }
    const auto at = RTMSIM_JOINT_VALUES * static_cast<std::size_t>(joint - joints.begin());
    values[at] = static_cast<double>(1 + (std::ranges::find(modes, command.mode) - modes.begin()));
    values[at + 1] = command.value;
  }
  return values;
}

}  // namespace

std::span<const std::string_view> joint_modes() { return modes; }

base::Result<void> Drives::drive(std::uint64_t viewer, const std::string& iface, const std::vector<double>& velocity) {
  const auto type = velocity.size() == 6 ? shm::IfaceType::position3d : shm::IfaceType::position2d;
  const auto handle = handle_of(viewer, iface, type);
  if (!handle) return handle.error();
  (*handle)->renewed = Clock::now();
  const auto done = (*handle)->iface.command(shm::CommandKind::velocity, velocity);
  if (!done) release(viewer, iface);  // it may be there again next time
  return done;
}

base::Result<void> Drives::move_joints(std::uint64_t viewer, const std::string& iface, std::span<const JointCommand> commands) {
  const auto handle = handle_of(viewer, iface, shm::IfaceType::joints);
  if (!handle) return handle.error();
  const auto values = values_for((*handle)->iface, commands);
  if (!values) return values.error();
  (*handle)->renewed = Clock::now();
  const auto done = (*handle)->iface.command(shm::CommandKind::joints, *values);
  if (!done) release(viewer, iface);
  return done;
}

base::Result<Drives::Handle*> Drives::handle_of(std::uint64_t viewer, const std::string& name, shm::IfaceType type) {
  const auto key = std::pair(viewer, name);
  const auto known = handles_.find(key);
  if (known != handles_.end() && known->second.iface.type() == type && known->second.iface.status() == shm::Status::live)
    return &known->second;
  handles_.erase(key);
  if (handles_.size() >= max_handles) return base::Error{"iface " + name + ": 256 robots and arms are moved by hand already"};
  auto opened = shm::Iface::open(server_id_, type, name);
  if (!opened) return opened.error();
  return &handles_.emplace(key, Handle{std::move(*opened), Clock::now()}).first->second;
}

void Drives::release(std::uint64_t viewer, const std::string& iface) { handles_.erase({viewer, iface}); }

void Drives::release_all(std::uint64_t viewer) {
  std::erase_if(handles_, [&](const auto& entry) { return entry.first.first == viewer; });
}

void Drives::tend() {
  const auto now = Clock::now();
  std::erase_if(handles_, [&](const auto& entry) { return now - entry.second.renewed > timeout; });
}

}  // namespace studio
