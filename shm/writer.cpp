#include "shm/writer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

#include "shm/writer_impl.h"

namespace shm {

// Those above are of newer clients: not obeyed.
static constexpr std::uint32_t last_command_kind = RTMSIM_COMMAND_CHARGE;

IfaceWriter::IfaceWriter(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

IfaceWriter::~IfaceWriter() { impl_->segment.close(); }

IfaceType IfaceWriter::type() const { return impl_->segment.name().type; }
const std::string& IfaceWriter::name() const { return impl_->segment.name().iface; }
const Segment& IfaceWriter::segment() const { return impl_->segment; }
bool IfaceWriter::is_subscribed() const { return impl_->leases.subscribers() > 0; }
bool IfaceWriter::owes_sample() const {
  return is_subscribed() && impl_->leases.times_switched_on() != impl_->served.load(std::memory_order_relaxed);
}
std::uint32_t IfaceWriter::times_switched_on() const { return impl_->leases.times_switched_on(); }
std::byte* IfaceWriter::staging() { return reinterpret_cast<std::byte*>(impl_->staging.data()); }
void IfaceWriter::set_resets(std::uint32_t resets) { impl_->resets = resets; }
std::uint64_t IfaceWriter::sequence() const { return impl_->sequence; }

std::byte* IfaceWriter::followers(std::size_t array, [[maybe_unused]] std::size_t size) {
  const IfaceRow& row = row_of(type());
  assert(array < row.sample_tail.arrays && size == row.sample_tail.size && "no such array follows a sample of this type");
  return staging() + row.sample_size + array * impl_->count * row.sample_tail.size;
}

std::size_t IfaceWriter::count() const { return impl_->count; }

void IfaceWriter::publish(std::chrono::nanoseconds sim_time, bool is_valid) {
  Impl& impl = *impl_;
  assert(impl.sample_size > 0 && "this iface publishes frames");
  sample<Stamp>() = impl.next_stamp(sim_time, is_valid);
  const std::uint64_t next = ++impl.sequence;
  std::byte* cell = impl.segment.at(AreaIndex::cells, next % impl.segment.area(AreaIndex::cells).count);
  auto& lock = *reinterpret_cast<std::uint64_t*>(cell);
  // A reader that sees any word of the copy (release) sees this odd lock too, or a later one.
  store(lock, 2 * next + 1, std::memory_order_relaxed);
  copy_in(cell + sizeof lock, impl.staging.data(), impl.sample_size);
  store(lock, 2 * next + 2);  // pairs with the acquire in Iface::read
  impl.announce_latest();
}

std::optional<std::span<std::byte>> IfaceWriter::begin_frame() { return impl_->ring.begin(); }

void IfaceWriter::publish_frame(std::chrono::nanoseconds sim_time, const Pose& pose, std::size_t size, double unit) {
  Impl& impl = *impl_;
  if (!impl.ring.publish(impl.next_stamp(sim_time, true), pose, size, unit)) return;
  ++impl.sequence;
  impl.announce_latest();
}

std::uint64_t IfaceWriter::dropped() const { return impl_->ring.dropped(); }

bool IfaceWriter::Impl::read_command(std::size_t index, CommandHead& head) {
  const auto& lease = segment.as<Lease>(AreaIndex::leases, index);
  for (int attempt = 0; attempt < 8; ++attempt) {
    const std::uint64_t before = load(lease.command_lock);  // pairs with the release in Iface::command
    if (before % 2 != 0) continue;
    copy_out(&head, &lease.command, sizeof head);
    copy_out(fresh_values.data(), command_values_of(lease), fresh_values.size() * sizeof(double));
    if (load(lease.command_lock, std::memory_order_relaxed) == before) return true;
  }
  return false;
}

CommandChange IfaceWriter::Impl::lose() {
  if (commanding_owner == 0) return CommandChange::none;
  commanding_owner = 0;
  return CommandChange::lost;
}

CommandChange IfaceWriter::poll_command(Command& command) {
  Impl& impl = *impl_;
  const std::uint64_t latest = load(impl.segment.header().command_latest);  // pairs with the release in Iface::command
  const auto is_held = [&] {
    return load(impl.segment.as<Lease>(AreaIndex::leases, impl.commanding_lease).owner) == impl.commanding_owner;
  };
  if (latest == impl.seen_command) return impl.commanding_owner != 0 && !is_held() ? impl.lose() : CommandChange::none;
  const std::size_t index = latest & 0xffff;
  if (index >= impl.segment.area(AreaIndex::leases).count) {
    impl.seen_command = latest;
    return impl.commanding_owner != 0 && !is_held() ? impl.lose() : CommandChange::none;
  }
  const std::uint64_t owner = load(impl.segment.as<Lease>(AreaIndex::leases, index).owner);
  CommandHead fresh;
  if (!impl.read_command(index, fresh)) return impl.commanding_owner != 0 && !is_held() ? impl.lose() : CommandChange::none;
  impl.seen_command = latest;
  if (owner == 0) return impl.lose();  // commanded and went before we looked
  const bool is_finite = std::ranges::all_of(impl.fresh_values, [](double value) { return std::isfinite(value); });
  if (!is_finite || fresh.kind > last_command_kind) return impl.commanding_owner != 0 && !is_held() ? impl.lose() : CommandChange::none;
  impl.commanding_owner = owner;
  impl.commanding_lease = index;
  impl.command_values.swap(impl.fresh_values);
  const bool is_timed = (fresh.flags & RTMSIM_COMMAND_TIMED) != 0 && fresh.sim_time_ns > 0;
  command = {fresh.sequence, static_cast<CommandKind>(fresh.kind), impl.command_values,
             std::chrono::nanoseconds(is_timed ? fresh.sim_time_ns : 0)};
  return CommandChange::fresh;
}

bool IfaceWriter::poll_commands(const TakeCommand& take) {
  Impl& impl = *impl_;
  const std::uint64_t latest = load(impl.segment.header().command_latest);  // pairs with the release in Iface::command
  if (latest == impl.seen_command) return false;
  impl.seen_command = latest;
  const std::size_t count = impl.segment.area(AreaIndex::leases).count, last = latest & 0xffff;
  impl.seen_of_leases.resize(count);
  const auto deliver = [&](std::size_t index) {
    const auto& lease = impl.segment.as<Lease>(AreaIndex::leases, index);
    const std::uint64_t owner = load(lease.owner);
    auto& seen = impl.seen_of_leases[index];
    CommandHead fresh;
    if (owner == 0 || load(lease.command.sequence) == seen || !impl.read_command(index, fresh)) return;
    if (std::exchange(seen, fresh.sequence) == fresh.sequence) return;
    if (fresh.kind > last_command_kind || !std::ranges::all_of(impl.fresh_values, [](double v) { return std::isfinite(v); })) return;
    take(owner, {fresh.sequence, static_cast<CommandKind>(fresh.kind), impl.fresh_values});
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (i != last) deliver(i);
  }
  if (last < count) deliver(last);
  return true;
}

bool IfaceWriter::holds_lease(std::uint64_t owner) const {
  const std::size_t count = impl_->segment.area(AreaIndex::leases).count;
  for (std::size_t i = 0; i < count; ++i) {
    if (load(impl_->segment.as<Lease>(AreaIndex::leases, i).owner) == owner) return true;
  }
  return false;
}

std::uint32_t IfaceWriter::owners_change() const { return load(impl_->segment.header().lease_epoch); }  // pairs with change_epoch

std::string IfaceWriter::client_name(std::uint64_t owner) const {
  const std::size_t count = impl_->segment.area(AreaIndex::leases).count;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& lease = impl_->segment.as<Lease>(AreaIndex::leases, i);
    if (load(lease.owner) == owner) return {lease.name, strnlen(lease.name, sizeof lease.name)};
  }
  return "pid " + std::to_string(owner_pid(owner));
}

void IfaceWriter::drop_command() {
  auto& seen = impl_->seen_of_leases;
  seen.resize(impl_->segment.area(AreaIndex::leases).count);
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = load(impl_->segment.as<Lease>(AreaIndex::leases, i).command.sequence);
  impl_->seen_command = load(impl_->segment.header().command_latest);  // pairs with the release in Iface::command
}

pid_t IfaceWriter::commanding_pid() const { return owner_pid(impl_->commanding_owner); }

}  // namespace shm
