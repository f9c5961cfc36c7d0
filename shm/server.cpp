#include "shm/server.h"

#include <unistd.h>

#include <atomic>
#include <utility>

#include "base/cut_guard.h"
#include "base/guarded.h"
#include "base/text.h"
#include "shm/writer_impl.h"

namespace shm {

struct Server::State {
  ServerOptions options;
  std::unique_ptr<ProcessWatch> watch;
  struct Ifaces {
    std::vector<std::weak_ptr<IfaceWriter::Impl>> all;
    std::int64_t last_tend = 0;
    std::uint64_t deaths = 0;
  };
  base::Guarded<Ifaces, base::Rank::samples> ifaces;
  std::atomic<std::size_t> cuts_told{0};
  Bytes bytes = std::make_shared<std::atomic<std::uint64_t>>(0);
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

namespace {
std::string mebibytes(std::uint64_t bytes) { return std::to_string((bytes + (1U << 20U) - 1) >> 20U) + " MiB"; }
}  // namespace

base::Result<std::unique_ptr<IfaceWriter>> Server::create(const IfaceSpec& spec) {
  const Geometry& geometry = spec.geometry;
  constexpr std::size_t largest = std::size_t{1} << 30;
  const bool is_plausible = geometry.info_size == spec.info.size() && geometry.sample_size < largest && geometry.frame_size < largest &&
                            (geometry.sample_size > 0 || geometry.frame_size > 0) && geometry.cells > 0 && geometry.leases > 0 &&
                            geometry.command_values <= max_command_values && geometry.frame_slots >= 3 && geometry.frame_slots <= 255 &&
                            geometry.leases < 0xffff;
  if (!is_plausible) {
    return base::Error{std::string(to_text(spec.type)) + " " + base::in_quotes(spec.name) + ": its counts or sizes can't be; samples of " +
                       std::to_string(geometry.sample_size) + " bytes, frames of " + std::to_string(geometry.frame_size)};
  }
  const std::uint64_t wanted = static_cast<std::uint64_t>(geometry.sample_size) * geometry.cells +
                               static_cast<std::uint64_t>(geometry.frame_size) * geometry.frame_slots;
  if (state_->bytes->load() + wanted > state_->options.max_bytes) {
    return base::Error{std::string(to_text(spec.type)) + " " + base::in_quotes(spec.name) + " needs " + mebibytes(wanted) +
                       " of shared memory beside " + mebibytes(state_->bytes->load()) + " of the other ifaces, which is more than " +
                       mebibytes(state_->options.max_bytes) + " in all (--shm-limit)"};
  }
  auto segment =
      Segment::create({::geteuid(), state_->options.server_id, spec.type, spec.name}, geometry, spec.info, state_->options.access);
  if (!segment) return segment.error();
  const IfaceRow& row = row_of(spec.type);
  const std::size_t count = row.sample_tail.arrays > 0 ? row.count(spec.info.data()) : 0;
  auto impl = std::make_shared<IfaceWriter::Impl>(std::move(*segment), geometry.sample_size, count, state_->bytes);
  if (row.is_always_full) {
    auto& filled = *static_cast<std::uint32_t*>(const_cast<void*>(row.filled(impl->staging.data())));
    filled = static_cast<std::uint32_t>(count);
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
  const std::size_t now = base::cuts();
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

}  // namespace shm
