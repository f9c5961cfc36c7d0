// The writer side of a ring of frames. One thread at a time.
//
// Who may touch a slot: the writer, between lock = 0 and lock = sequence, and only if no lease holds the slot; a reader, while its hold
// names the slot and lock was the wanted sequence after the hold was stored. Both sides store first and look then (sequentially
// consistent), so at least one of them sees the other and steps back. Neither side waits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shm/segment.h"

namespace shm {

class FrameRing {
 public:
  // A segment without frames gives a ring that can't begin.
  explicit FrameRing(const Segment& segment);

  // The oldest slot that nobody holds and that is not the latest; nothing when there is none.
  std::optional<std::span<std::byte>> begin();
  // Publishes that slot; false when there is none begun. size 0 = the whole frame; unit: of thermal images [K].
  bool publish(const Stamp& stamp, const Pose& pose, std::size_t size, double unit);
  std::uint64_t dropped() const { return dropped_; }

 private:
  FrameHead& slot(std::size_t index) const { return segment_.as<FrameHead>(AreaIndex::frames, index); }
  bool is_held(std::size_t index) const;

  const Segment& segment_;
  CameraInfo info_{};
  std::vector<std::uint64_t> sequences_;  // of the frames in the slots
  std::vector<std::size_t> order_;        // slots, oldest frame first
  std::optional<std::size_t> latest_, begun_;
  std::uint64_t dropped_ = 0;
};

}  // namespace shm
