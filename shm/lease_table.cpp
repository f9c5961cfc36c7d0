#include "shm/lease_table.h"

#include <cstring>

#include "shm/process.h"
#include "shm/words.h"

namespace shm {
namespace {

constexpr std::uint32_t no_command = ~std::uint32_t{0};  // a kind that poll_command passes over

std::size_t count_of(const Segment& segment) { return segment.area(AreaIndex::leases).count; }
Lease& lease_at(const Segment& segment, std::size_t index) { return segment.as<Lease>(AreaIndex::leases, index); }
void change_epoch(const Segment& segment) { word(segment.header().lease_epoch).fetch_add(1, std::memory_order_acq_rel); }

// Nobody is to be taken for the author of what the one before has written, which may have died in the middle of it. For whoever owns the
// lease alone.
void forget_command(Lease& lease) {
  CommandHead none{};
  none.sequence = load(lease.command.sequence, std::memory_order_relaxed);
  none.kind = no_command;
  const std::uint64_t lock = load(lease.command_lock, std::memory_order_relaxed) | 1;
  store(lease.command_lock, lock, std::memory_order_relaxed);  // seen by whoever sees a word of the copy
  copy_in(&lease.command, &none, sizeof none);
  store(lease.command_lock, lock + 1);  // pairs with the acquire in IfaceWriter::poll_command
}

void clear(Lease& lease) {
  forget_command(lease);
  for (auto& hold : lease.holds) store(hold, 0U, std::memory_order_seq_cst);
  store(lease.flags, 0U);
  store(lease.start_time, std::uint64_t{0});
}

}  // namespace

LeaseTable::LeaseTable(const Segment& segment) : segment_(segment), known_(count_of(segment)), counted_(~std::uint64_t{0} << 32) {}

std::uint32_t LeaseTable::subscribers() const {
  const std::uint32_t epoch = load(segment_.header().lease_epoch);  // pairs with change_epoch
  const std::uint64_t counted = counted_.load(std::memory_order_relaxed);
  if (counted >> 32 == epoch) return static_cast<std::uint32_t>(counted);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < known_.size(); ++i) {
    const Lease& lease = lease_at(segment_, i);
    if (load(lease.owner) != 0 && (load(lease.flags) & RTMSIM_LEASE_SUBSCRIBER) != 0) ++count;
  }
  if (count > 0 && static_cast<std::uint32_t>(counted) == 0) times_switched_on_.fetch_add(1, std::memory_order_relaxed);
  counted_.store((static_cast<std::uint64_t>(epoch) << 32) | count, std::memory_order_relaxed);
  return count;
}

void LeaseTable::reap(ProcessWatch& watch) {
  bool has_changed = false;
  for (std::size_t i = 0; i < known_.size(); ++i) {
    Lease& lease = lease_at(segment_, i);
    Known& known = known_[i];
    std::uint64_t owner = load(lease.owner);
    if (owner == 0) {
      known = {};
      continue;
    }
    const std::uint64_t start_time = load(lease.start_time);
    if (known.owner != owner || known.start_time != start_time || !known.watched) {
      known = {owner, start_time, watch.watch({owner_pid(owner), load(lease.pid_namespace), start_time})};
    }
    if (!known.watched->is_dead()) continue;
    clear(lease);
    word(lease.owner).compare_exchange_strong(owner, 0, std::memory_order_acq_rel);
    known = {};
    has_changed = true;
  }
  if (has_changed) change_epoch(segment_);
}

std::optional<std::size_t> take_lease(const Segment& segment, std::uint64_t owner, std::uint32_t flags) {
  const ProcessMark mark = own_mark();
  for (std::size_t i = 0; i < count_of(segment); ++i) {
    Lease& lease = lease_at(segment, i);
    std::uint64_t free = 0;
    if (!word(lease.owner).compare_exchange_strong(free, owner, std::memory_order_acq_rel)) continue;
    clear(lease);
    store(lease.pid_namespace, mark.pid_namespace);
    store(lease.start_time, mark.start_time);
    std::strncpy(lease.name, own_program().c_str(), sizeof lease.name - 1);
    store(lease.flags, flags);
    change_epoch(segment);
    return i;
  }
  return std::nullopt;
}

void set_lease_flags(const Segment& segment, std::size_t index, std::uint32_t flags) {
  store(lease_at(segment, index).flags, flags);
  change_epoch(segment);
}

void give_lease_back(const Segment& segment, std::size_t index, std::uint64_t owner) {
  Lease& lease = lease_at(segment, index);
  if (load(lease.owner) != owner) return;
  clear(lease);
  word(lease.owner).compare_exchange_strong(owner, 0, std::memory_order_acq_rel);
  change_epoch(segment);
}

}  // namespace shm
