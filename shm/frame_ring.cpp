#include "shm/frame_ring.h"

#include <algorithm>
#include <cstring>

#include "shm/words.h"

namespace shm {

FrameRing::FrameRing(const Segment& segment) : segment_(segment), sequences_(segment.area(AreaIndex::frames).count, 0) {
  for (std::size_t i = 0; i < sequences_.size(); ++i) order_.push_back(i);
  if (!sequences_.empty()) std::memcpy(&info_, segment.at(AreaIndex::info), sizeof info_);
}

bool FrameRing::is_held(std::size_t index) const {
  const std::uint32_t mark = static_cast<std::uint32_t>(index) + 1;
  for (std::size_t i = 0; i < segment_.area(AreaIndex::leases).count; ++i) {
    const auto& lease = segment_.as<Lease>(AreaIndex::leases, i);
    for (const auto& hold : lease.holds) {
      if (load(hold, std::memory_order_seq_cst) == mark) return true;  // pairs with the store in Iface::hold and its release
    }
  }
  return false;
}

std::optional<std::span<std::byte>> FrameRing::begin() {
  if (begun_) return std::span<std::byte>(reinterpret_cast<std::byte*>(&slot(*begun_) + 1), info_.frame_size);
  std::sort(order_.begin(), order_.end(), [this](std::size_t a, std::size_t b) { return sequences_[a] < sequences_[b]; });
  for (std::size_t index : order_) {
    if (latest_ == index || is_held(index)) continue;
    store(slot(index).lock, std::uint64_t{0}, std::memory_order_seq_cst);  // pairs with the look in Iface::hold
    if (is_held(index)) {
      store(slot(index).lock, sequences_[index], std::memory_order_seq_cst);
      continue;
    }
    begun_ = index;
    return begin();
  }
  ++dropped_;
  store(segment_.header().dropped, dropped_);
  return std::nullopt;
}

bool FrameRing::publish(const Stamp& stamp, const Pose& pose, std::size_t size, double unit) {
  if (!begun_) return false;
  FrameHead& head = slot(*begun_);
  head.stamp = stamp;
  head.pose = pose;
  head.width = info_.width;
  head.height = info_.height;
  head.format = info_.format;
  head.stride = info_.stride;
  head.unit = unit;
  head.size = size == 0 ? info_.frame_size : std::min<std::size_t>(size, info_.frame_size);
  store(head.lock, stamp.sequence, std::memory_order_seq_cst);
  sequences_[*begun_] = stamp.sequence;
  latest_ = begun_;
  begun_.reset();
  store(segment_.header().latest_slot, (stamp.sequence << 8) | *latest_, std::memory_order_seq_cst);  // pairs with Iface::hold
  return true;
}

}  // namespace shm
