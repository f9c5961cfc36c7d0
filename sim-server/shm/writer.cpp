#include "shm/writer.h"

#include <grp.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "base/text.h"
#include "shm/cut_guard.h"
#include "shm/frame_ring.h"
#include "shm/futex.h"
#include "shm/lease_table.h"
#include "shm/process.h"
#include "shm/words.h"

namespace shm {

struct IfaceWriter::Impl {
  Impl(Segment made, std::size_t sample)
      : segment(std::move(made)), sample_size(sample), staging((sample + 7) / 8), leases(segment), ring(segment) {}

  Segment segment;
  std::size_t sample_size;
  std::vector<std::uint64_t> staging;
  LeaseTable leases;
  FrameRing ring;
  std::uint64_t sequence = 0;
  std::uint32_t resets = 0;
  std::atomic<std::uint32_t> served{0};  // LeaseTable::times_switched_on at the last publication
  std::size_t range_count = 0, intensity_count = 0, contact_count = 0;

  std::uint64_t seen_command = 0;
  std::uint64_t commander = 0;  // owner word of the lease whose command is in force
  std::size_t commander_lease = 0;
  bool is_cut_told = false;  // under the lock of the server's ifaces

  Stamp next_stamp(std::chrono::nanoseconds sim_time, bool is_valid) const {
    return {sequence + 1, sim_time.count(), wall_ns(), is_valid ? 1U : 0U, resets};
  }
  void announce_latest() {
    Header& header = segment.header();
    served.store(leases.times_switched_on(), std::memory_order_relaxed);
    store(header.sequence, sequence);  // pairs with the acquire in Iface::sequence
    store(header.wake_word, static_cast<std::uint32_t>(sequence), std::memory_order_seq_cst);
    ring_readers();
  }
  void ring_readers() { shm::ring(segment.header().wake_word, segment.header().waiting); }
  bool read_command(std::size_t index, Command& command) const;
  CommandChange lose();
};

IfaceWriter::IfaceWriter(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

IfaceWriter::~IfaceWriter() { impl_->segment.close(); }

IfaceType IfaceWriter::type() const { return impl_->segment.name().type; }
const std::string& IfaceWriter::name() const { return impl_->segment.name().iface; }
const Segment& IfaceWriter::segment() const { return impl_->segment; }
bool IfaceWriter::is_subscribed() const { return impl_->leases.subscribers() > 0; }
bool IfaceWriter::owes_sample() const {
  return is_subscribed() && impl_->leases.times_switched_on() != impl_->served.load(std::memory_order_relaxed);
}
std::byte* IfaceWriter::staging() { return reinterpret_cast<std::byte*>(impl_->staging.data()); }
void IfaceWriter::set_resets(std::uint32_t resets) { impl_->resets = resets; }
std::uint64_t IfaceWriter::sequence() const { return impl_->sequence; }

std::span<float> IfaceWriter::ranges() {
  const std::size_t head = type() == IfaceType::sonar ? sizeof(SonarSample) : sizeof(LaserSample);
  return {reinterpret_cast<float*>(staging() + head), impl_->range_count};
}

std::span<float> IfaceWriter::intensities() { return {ranges().data() + impl_->range_count, impl_->intensity_count}; }

std::span<Contact> IfaceWriter::contacts() { return {reinterpret_cast<Contact*>(staging() + sizeof(BumperSample)), impl_->contact_count}; }

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

void IfaceWriter::publish_frame(std::chrono::nanoseconds sim_time, const Pose& pose, std::size_t size) {
  Impl& impl = *impl_;
  if (!impl.ring.publish(impl.next_stamp(sim_time, true), pose, size)) return;
  ++impl.sequence;
  impl.announce_latest();
}

std::uint64_t IfaceWriter::dropped() const { return impl_->ring.dropped(); }

bool IfaceWriter::Impl::read_command(std::size_t index, Command& command) const {
  const auto& lease = segment.as<Lease>(AreaIndex::leases, index);
  for (int attempt = 0; attempt < 8; ++attempt) {
    const std::uint64_t before = load(lease.command_lock);  // pairs with the release in Iface::command
    if (before % 2 != 0) continue;
    copy_out(&command, &lease.command, sizeof command);
    if (load(lease.command_lock, std::memory_order_relaxed) == before) return true;
  }
  return false;
}

CommandChange IfaceWriter::Impl::lose() {
  if (commander == 0) return CommandChange::none;
  commander = 0;
  return CommandChange::lost;
}

CommandChange IfaceWriter::poll_command(Command& command) {
  Impl& impl = *impl_;
  const std::uint64_t latest = load(impl.segment.header().command_latest);  // pairs with the release in Iface::command
  const auto is_held = [&] { return load(impl.segment.as<Lease>(AreaIndex::leases, impl.commander_lease).owner) == impl.commander; };
  if (latest == impl.seen_command) return impl.commander != 0 && !is_held() ? impl.lose() : CommandChange::none;
  const std::size_t index = latest & 0xffff;
  if (index >= impl.segment.area(AreaIndex::leases).count) {
    impl.seen_command = latest;
    return impl.commander != 0 && !is_held() ? impl.lose() : CommandChange::none;
  }
  const std::uint64_t owner = load(impl.segment.as<Lease>(AreaIndex::leases, index).owner);
  Command fresh;
  if (!impl.read_command(index, fresh)) return impl.commander != 0 && !is_held() ? impl.lose() : CommandChange::none;
  impl.seen_command = latest;
  if (owner == 0) return impl.lose();  // commanded and went before we looked
  const bool is_finite = std::all_of(std::begin(fresh.values), std::end(fresh.values), [](double value) { return std::isfinite(value); });
  if (!is_finite || fresh.kind > RTMSIM_COMMAND_POSE) return impl.commander != 0 && !is_held() ? impl.lose() : CommandChange::none;
  impl.commander = owner;
  impl.commander_lease = index;
  command = fresh;
  return CommandChange::fresh;
}

pid_t IfaceWriter::commander() const { return owner_pid(impl_->commander); }

struct Server::State {
  ServerOptions options;
  std::unique_ptr<ProcessWatch> watch;
  struct Ifaces {
    std::vector<std::weak_ptr<IfaceWriter::Impl>> all;
    std::int64_t last_tend = 0;
    std::uint64_t deaths = 0;
  };
  base::Guarded<Ifaces, base::Rank::buffer> ifaces;
  std::atomic<std::size_t> cuts_told{0};
};

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}
Server::~Server() = default;

base::Result<std::unique_ptr<Server>> Server::start(const ServerOptions& options) {
  remove_stale(options.server_id, options.server_id);
  for (const Found& found : find_segments(options.server_id)) {
    if (found.name.uid != ::geteuid() || !found.is_alive) continue;
    if (found.server.pid != own_mark().pid) {
      return base::Error{"server " + std::to_string(options.server_id) + " is already running as pid " + std::to_string(found.server.pid) +
                         "; choose another server id or end that one"};
    }
  }
  auto watch = ProcessWatch::start();
  if (!watch) return watch.error();
  auto state = std::make_unique<State>();
  state->options = options;
  state->watch = std::move(*watch);
  return std::unique_ptr<Server>(new Server(std::move(state)));
}

base::Result<std::unique_ptr<IfaceWriter>> Server::create(const IfaceSpec& spec) {
  const Geometry& geometry = spec.geometry;
  constexpr std::size_t largest = std::size_t{1} << 30;
  const bool is_plausible = geometry.info_size == spec.info.size() && geometry.sample_size < largest && geometry.frame_size < largest &&
                            (geometry.sample_size > 0 || geometry.frame_size > 0) && geometry.cells > 0 && geometry.leases > 0 &&
                            geometry.frame_slots >= 3 && geometry.frame_slots <= 255 && geometry.leases < 0xffff;
  if (!is_plausible) {
    return base::Error{std::string(to_text(spec.type)) + " " + base::in_quotes(spec.name) + ": its counts or sizes can't be; samples of " +
                       std::to_string(geometry.sample_size) + " bytes, frames of " + std::to_string(geometry.frame_size)};
  }
  auto segment =
      Segment::create({::geteuid(), state_->options.server_id, spec.type, spec.name}, geometry, spec.info, state_->options.access);
  if (!segment) return segment.error();
  auto impl = std::make_shared<IfaceWriter::Impl>(std::move(*segment), geometry.sample_size);
  if (spec.type == IfaceType::laser) {
    impl->range_count = impl->intensity_count = (geometry.sample_size - sizeof(LaserSample)) / (2 * sizeof(float));
    reinterpret_cast<LaserSample*>(impl->staging.data())->count = static_cast<std::uint32_t>(impl->range_count);
  } else if (spec.type == IfaceType::sonar) {
    impl->range_count = reinterpret_cast<const SonarInfo*>(spec.info.data())->count;
    reinterpret_cast<SonarSample*>(impl->staging.data())->count = static_cast<std::uint32_t>(impl->range_count);
  } else if (spec.type == IfaceType::bumper) {
    impl->contact_count = (geometry.sample_size - sizeof(BumperSample)) / sizeof(Contact);
  }
  state_->ifaces.lock()->all.push_back(impl);
  return std::make_unique<IfaceWriter>(std::move(impl));
}

void Server::tend() {
  const std::int64_t now = monotonic_ns();
  auto ifaces = state_->ifaces.lock();
  const std::uint64_t deaths = state_->watch->deaths();
  if (now - ifaces->last_tend < 100'000'000 && deaths == ifaces->deaths) return;
  ifaces->last_tend = now;
  ifaces->deaths = deaths;
  std::erase_if(ifaces->all, [](const auto& weak) { return weak.expired(); });
  for (const auto& weak : ifaces->all) {
    auto impl = weak.lock();
    if (!impl) continue;
    store(impl->segment.header().heartbeat_ns, now);
    impl->leases.reap(*state_->watch);
  }
}

std::vector<std::string> Server::take_cuts() {
  std::vector<std::string> names;
  const std::size_t now = cuts();
  if (now == state_->cuts_told.load(std::memory_order_relaxed)) return names;
  state_->cuts_told.store(now, std::memory_order_relaxed);
  auto ifaces = state_->ifaces.lock();
  for (const auto& weak : ifaces->all) {
    auto impl = weak.lock();
    if (impl && impl->segment.was_cut() && !std::exchange(impl->is_cut_told, true)) names.push_back(impl->segment.name().text());
  }
  return names;
}

ProcessWatch& Server::watch() { return *state_->watch; }
std::uint32_t Server::id() const { return state_->options.server_id; }

base::Result<Access> parse_access(const std::string& mode, const std::string& group) {
  Access access;
  if (!mode.empty()) {
    const bool is_octal = mode.size() <= 4 && mode.find_first_not_of("01234567") == std::string::npos;
    const long value = is_octal ? std::strtol(mode.c_str(), nullptr, 8) : -1;
    if (value < 0 || value > 0777 || (value & 0600) != 0600) {
      return base::Error{"shared memory mode " + base::in_quotes(mode) + " must be octal and let the owner read and write, like 0660"};
    }
    access.mode = static_cast<mode_t>(value);
  }
  if (!group.empty()) {
    const struct group* entry = ::getgrnam(group.c_str());
    const auto number = base::parse_integer(group);
    if (entry == nullptr && (!number || *number < 0 || *number > std::numeric_limits<gid_t>::max())) {
      return base::Error{"group " + base::in_quotes(group) + " is not known"};
    }
    access.group = entry != nullptr ? entry->gr_gid : static_cast<gid_t>(*number);
  }
  return access;
}

}  // namespace shm
