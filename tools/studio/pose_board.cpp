#include "studio/pose_board.h"

#include <algorithm>
#include <cmath>

#include "studio/foxglove.h"

namespace studio {
namespace {

constexpr std::size_t numbers_per_link = 7;
constexpr std::size_t head_size = 24, entry_size = 24;
constexpr char poses_octet = static_cast<char>(0x81);
constexpr float full = 32767;
constexpr float smallest_move = 1e-4F;  // [m] a tenth of a millimetre is seen by nobody

std::int16_t quantised(float value) {
  return static_cast<std::int16_t>(std::lround(std::clamp(std::isfinite(value) ? value : 0.0F, -1.0F, 1.0F) * full));
}

float finite(float value) { return std::isfinite(value) ? value : 0.0F; }

}  // namespace

bool PoseBoard::update(std::uint32_t version, std::chrono::nanoseconds time, std::span<const float> poses) {
  const std::size_t count = poses.size() / numbers_per_link;
  const bool is_new_scene = version != version_ || count != links_.size() || updates_ == 0;
  ++updates_;
  if (is_new_scene) {
    links_.assign(count, {});
    version_ = version;
    whole_since_ = updates_;
  }
  bool has_changed = is_new_scene;
  for (std::size_t i = 0; i < count; ++i) {
    const auto pose = poses.subspan(i * numbers_per_link, numbers_per_link);
    Link now{{finite(pose[0]), finite(pose[1]), finite(pose[2])},
             {quantised(pose[4]), quantised(pose[5]), quantised(pose[6]), quantised(pose[3])},
             updates_};
    Link& link = links_[i];
    const auto has_moved = [&](std::size_t axis) { return std::abs(now.position[axis] - link.position[axis]) >= smallest_move; };
    if (!is_new_scene && !has_moved(0) && !has_moved(1) && !has_moved(2) && now.orientation == link.orientation) continue;
    link = now;
    has_changed = true;
  }
  if (has_changed) time_ = time;
  return has_changed;
}

void PoseBoard::clear() {
  links_.clear();
  version_ = 0;
  whole_since_ = ++updates_;
}

std::optional<std::string> PoseBoard::frame_since(std::uint64_t& seen) const {
  const bool is_whole = seen < whole_since_;
  std::uint32_t count = 0;
  std::string entries;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    if (!is_whole && link.changed <= seen) continue;
    put_u32(entries, static_cast<std::uint32_t>(i));
    for (const float value : link.position) put_f32(entries, value);
    for (const std::int16_t value : link.orientation) put_u16(entries, static_cast<std::uint16_t>(value));
    ++count;
  }
  seen = updates_;
  if (count == 0 && !is_whole) return std::nullopt;
  std::string frame;
  frame.reserve(head_size + count * entry_size);
  frame += poses_octet;
  frame += static_cast<char>(is_whole ? 1 : 0);
  put_u16(frame, 0);
  put_u32(frame, version_);
  put_u64(frame, static_cast<std::uint64_t>(time_.count()));
  put_u32(frame, count);
  put_u32(frame, 0);
  return frame + entries;
}

}  // namespace studio
