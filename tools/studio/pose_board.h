// The current poses of all links, with their times: each viewer gets what has moved since its last message. One thread at a
// time.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace studio {

class PoseBoard {
 public:
  // `poses`: seven numbers for each link, x y z [m] and the quaternion w x y z. True when a viewer would see a difference.
  bool update(std::uint32_t version, std::chrono::nanoseconds time, std::span<const float> poses);
  void clear();

  // The frame 0x81 of what has changed since `seen`, which is then up to date; nothing when nothing has.
  std::optional<std::string> frame_since(std::uint64_t& seen) const;

  std::size_t links() const { return links_.size(); }

 private:
  struct Link {
    std::array<float, 3> position{};
    std::array<std::int16_t, 4> orientation{};
    std::uint64_t changed = 0;  // the number of the update that moved it
  };
  std::vector<Link> links_;
  std::uint32_t version_ = 0;
  std::chrono::nanoseconds time_{0};
  std::uint64_t updates_ = 0;
  std::uint64_t whole_since_ = 0;  // who has seen nothing newer gets all links
};

}  // namespace studio
