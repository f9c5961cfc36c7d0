#include "shm/specs.h"

#include <algorithm>

namespace shm {
namespace {

// Small samples are many in a time: a reader that was asleep for a while finds those it missed. Worlds have thousands of truths, which are
// read for the present.
std::uint32_t cells_for(IfaceType type, std::size_t sample_size) {
  constexpr std::size_t least = 4, most = 32, room = 16384;  // [bytes]
  if (type == IfaceType::truth || sample_size == 0) return least;
  return static_cast<std::uint32_t>(std::clamp(room / sample_size, least, most));
}

}  // namespace

IfaceSpec iface_spec(IfaceType type, const std::string& name, std::span<const std::byte> info) {
  const IfaceRow& row = row_of(type);
  IfaceSpec spec{type, name, {info.begin(), info.end()}, {}};
  spec.geometry.info_size = info.size();
  spec.geometry.command_values = row.command_values;
  if (info.size() < row.info_size) return spec;  // which cannot be made: it has no samples
  const auto count = plausible_count(row, info.data());
  spec.geometry.sample_size = count && info.size() >= info_size(row, *count) ? sample_size(row, *count) : 0;
  spec.geometry.cells = cells_for(type, spec.geometry.sample_size);
  return spec;
}

IfaceSpec simulation_spec(const SimulationInfo& info, std::uint32_t request_slots, std::uint32_t participants) {
  IfaceSpec spec = iface_spec(IfaceType::simulation, "world", info);
  spec.geometry.leases = 128;
  spec.geometry.request_slots = request_slots;
  spec.geometry.participants = participants;
  return spec;
}

IfaceSpec sonar_spec(const std::string& name, const SonarInfo& info, std::span<const Pose> poses) {
  return spec_with(IfaceType::sonar, name, info, poses);
}

IfaceSpec joints_spec(const std::string& name, const JointsInfo& info, std::span<const Joint> joints) {
  IfaceSpec spec = spec_with(IfaceType::joints, name, info, joints);
  spec.geometry.command_values = RTMSIM_JOINT_VALUES * static_cast<std::uint32_t>(joints.size());
  return spec;
}

IfaceSpec camera_spec(IfaceType type, const std::string& name, const CameraInfo& info, std::uint32_t slots) {
  CameraInfo whole = info;
  const std::uint32_t pixel = bytes_per_pixel(static_cast<Format>(info.format));
  const bool is_good = pixel > 0 && plausible_count(row_of(type), &info);
  if (is_good && whole.stride == 0) whole.stride = whole.width * pixel;
  if (is_good && whole.frame_size == 0) whole.frame_size = static_cast<std::uint64_t>(whole.stride) * whole.height;
  const bool fits = is_good && whole.stride >= static_cast<std::uint64_t>(whole.width) * pixel &&
                    whole.frame_size >= static_cast<std::uint64_t>(whole.stride) * whole.height;
  IfaceSpec spec = iface_spec(type, name, whole);
  spec.geometry.frame_size = fits ? whole.frame_size : 0;
  spec.geometry.frame_slots = slots;
  return spec;
}

}  // namespace shm
