// Leases of an iface, for both sides: the simulator counts and releases them (LeaseTable), a client acquires and releases one (take_lease).
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shm/process_watch.h"
#include "shm/segment.h"

namespace shm {

class LeaseTable {
 public:
  explicit LeaseTable(const Segment& segment);
  // Any thread. Counts anew only when the epoch has changed.
  std::uint32_t subscribers() const;
  // How often subscribers() has found the first one after there was none.
  std::uint32_t times_switched_on() const { return times_switched_on_.load(std::memory_order_relaxed); }
  // Takes the leases of dead clients back. One thread at a time.
  void reap(ProcessWatch& watch);

 private:
  struct Known {
    std::uint64_t owner = 0, start_time = 0;
    std::shared_ptr<const Watched> watched;
  };
  const Segment& segment_;
  std::vector<Known> known_;
  mutable std::atomic<std::uint64_t> counted_;  // (epoch << 32) | subscribers
  mutable std::atomic<std::uint32_t> times_switched_on_{0};
};

// Index of a lease that is ours from now on; nothing when all are taken.
std::optional<std::size_t> take_lease(const Segment& segment, std::uint64_t owner, std::uint32_t flags);
void set_lease_flags(const Segment& segment, std::size_t index, std::uint32_t flags);
// Does nothing when the lease is no longer `owner`'s.
void give_lease_back(const Segment& segment, std::size_t index, std::uint64_t owner);

}  // namespace shm
