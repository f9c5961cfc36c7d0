#include "shm/client.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "base/text.h"
#include "shm/attention.h"
#include "shm/futex.h"
#include "shm/lease_table.h"
#include "shm/process.h"
#include "shm/words.h"

namespace shm {
namespace {

constexpr std::chrono::milliseconds slice{100};  // longest sleep before the server's life is checked
constexpr int read_attempts = 8;

std::string describe(IfaceType type, std::string_view name) { return std::string(to_text(type)) + " " + base::in_quotes(name); }

// Segments of one server of one user. The one of its simulation tells of all. One that ends may have lost it, and still have a thousand
// others: a few are asked.
bool is_any_alive(std::span<const SegmentPlace> places) {
  constexpr std::size_t few = 8;
  const auto simulation = std::ranges::find(places, IfaceType::simulation, [](const SegmentPlace& place) { return place.name.type; });
  if (simulation != places.end()) return inspect(*simulation).is_alive;
  return std::ranges::any_of(places.first(std::min(few, places.size())), [](const SegmentPlace& place) { return inspect(place).is_alive; });
}

// Why there is no such iface: what the server has instead, or which servers there are.
std::string explain_absence(std::uint32_t server_id, IfaceType type, std::string_view name) {
  std::vector<std::string> same_type, other_types, servers;
  const auto places = segment_places();
  for (auto begin = places->begin(); begin != places->end();) {
    const uid_t uid = begin->name.uid;
    const std::uint32_t id = begin->name.server_id;
    const auto is_of_another = [&](const SegmentPlace& other) { return other.name.server_id != id || other.name.uid != uid; };
    const auto end = std::find_if(begin, places->end(), is_of_another);
    const std::span<const SegmentPlace> all(begin, end);
    begin = end;
    if (!is_any_alive(all)) continue;
    if (servers.empty() || servers.back() != std::to_string(id)) servers.push_back(std::to_string(id));
    if (id != server_id) continue;
    for (const auto& [found, in_refuge] : all) {
      if (found.type == type) {
        same_type.push_back(found.iface);
      } else if (std::string other(to_text(found.type)); std::ranges::find(other_types, other) == other_types.end()) {
        other_types.push_back(std::move(other));
      }
    }
  }
  const std::string start = "no " + describe(type, name) + " on server " + std::to_string(server_id);
  if (!same_type.empty()) return start + "; there is " + base::join(same_type, ", ");
  if (!other_types.empty()) return start + "; it has only " + base::join(other_types, ", ");
  if (!servers.empty()) return start + ", which is not running; running: " + base::join(servers, ", ");
  return start + ": no server is running";
}

}  // namespace

struct Iface::State {
  explicit State(Segment opened) : segment(std::move(opened)), server(ProcessLife::of(segment.facts().server)), owner(make_owner()) {}
  ~State() {
    if (lease) give_lease_back(segment, *lease, owner);
  }

  Segment segment;
  std::shared_ptr<const ProcessLife> server;  // its process
  std::uint64_t owner;
  std::optional<std::size_t> lease;
  bool is_subscribed = false;
  std::vector<std::uint64_t> info;    // a private copy
  std::vector<std::uint64_t> buffer;  // the sample read last
  std::uint64_t last_command = 0;     // what this handle wrote to command_latest
  std::size_t count = 0;              // ranges of a scan, contacts
  std::atomic<std::int64_t> checked_at{0};
  std::atomic<bool> is_dead{false};

  Header& header() const { return segment.header(); }
  Lease& own_lease() const { return segment.as<Lease>(AreaIndex::leases, *lease); }
  bool has_lease() const { return lease && load(own_lease().owner) == owner; }
  base::Result<void> prepare();
  base::Result<void> ensure_lease();
  bool copy_sample(std::uint64_t number);
  Status status(bool is_hurried);
};

// Copies the constants and checks that samples of their size fit into the cells.
base::Result<void> Iface::State::prepare() {
  const IfaceRow& row = row_of(segment.name().type);
  const auto fail = [&](const char* what) { return base::Error{"shared memory " + segment.name().text() + " " + what}; };
  const std::span<const std::byte> constants = segment.info();
  if (constants.size() < (row.oldest_info_size > 0 ? row.oldest_info_size : row.info_size)) return fail("has an info that is too small");
  info.assign(round_up(std::max(constants.size(), row.info_size), 8) / 8, 0);
  std::memcpy(info.data(), constants.data(), constants.size());
  const auto plausible = plausible_count(row, info.data());
  if (!plausible) return fail("has a count that can't be");
  if (row.oldest_info_size == 0 && constants.size() < info_size(row, *plausible))
    return fail("has an info that is too small for its count");
  if (row.sample_tail.arrays > 0) count = *plausible;
  const Area& cells = segment.area(AreaIndex::cells);
  const std::size_t room = cells.count > 0 ? cells.stride - 8 : 0;
  const std::size_t needed = sample_size(row, count);
  if (room < needed) return fail("has cells that are too small");
  if (has_frames(segment.name().type)) {
    const Area& frames = segment.area(AreaIndex::frames);
    const auto& camera = *reinterpret_cast<const CameraInfo*>(info.data());
    if (frames.count < 1 || frames.stride < sizeof(FrameHead) || camera.frame_size > frames.stride - sizeof(FrameHead)) {
      return fail("has slots that are too small");
    }
  }
  buffer.resize(needed / 8);
  return {};
}

Status Iface::State::status(bool is_hurried) {
  if (load(header().state) != RTMSIM_STATE_LIVE) return Status::closed;
  if (is_dead.load(std::memory_order_relaxed)) return Status::dead;
  const std::int64_t now = monotonic_ns();
  if (is_hurried && now - checked_at.load(std::memory_order_relaxed) < std::chrono::nanoseconds(slice).count() / 2) return Status::live;
  checked_at.store(now, std::memory_order_relaxed);
  Header judged = segment.facts();
  judged.heartbeat_ns = load(header().heartbeat_ns);
  if (is_server_alive(judged, *server)) return Status::live;
  is_dead.store(true, std::memory_order_relaxed);
  return Status::dead;
}

base::Result<void> Iface::State::ensure_lease() {
  if (has_lease()) return {};
  const auto fail = [&](const std::string& what) {
    return base::Error{describe(segment.name().type, segment.name().iface) + " on server " + std::to_string(segment.name().server_id) +
                       " " + what};
  };
  switch (status(false)) {
    case Status::closed:
      return fail("is closed");
    case Status::dead:
      return fail("is dead: pid " + std::to_string(segment.facts().server.pid) + " has ended");
    case Status::live:
      break;
  }
  owner = make_owner();
  lease = take_lease(segment, owner, is_subscribed ? RTMSIM_LEASE_SUBSCRIBER : 0);
  if (!lease) return fail("has no free lease: " + std::to_string(segment.area(AreaIndex::leases).count) + " clients use it already");
  return {};
}

HeldFrame::HeldFrame(std::shared_ptr<void> keeper, std::uint32_t* hold, const FrameHead& head, std::span<const std::byte> data)
    : keeper_(std::move(keeper)), hold_(hold), head_(head), data_(data) {}

HeldFrame::HeldFrame(HeldFrame&& other) noexcept
    : keeper_(std::move(other.keeper_)), hold_(std::exchange(other.hold_, nullptr)), head_(other.head_), data_(other.data_) {}

HeldFrame& HeldFrame::operator=(HeldFrame&& other) noexcept {
  if (this == &other) return *this;
  release();
  keeper_ = std::move(other.keeper_);
  hold_ = std::exchange(other.hold_, nullptr);
  head_ = other.head_;
  data_ = other.data_;
  return *this;
}

HeldFrame::~HeldFrame() { release(); }

void HeldFrame::release() {
  if (hold_ != nullptr) store(*hold_, 0U, std::memory_order_seq_cst);  // pairs with FrameRing::is_held
  hold_ = nullptr;
  keeper_.reset();
}

Iface::Iface(std::shared_ptr<State> state) : state_(std::move(state)) {}
Iface::Iface(Iface&&) noexcept = default;
Iface& Iface::operator=(Iface&& other) noexcept {
  if (this == &other) return *this;
  if (state_) unsubscribe();
  state_ = std::move(other.state_);
  return *this;
}
Iface::~Iface() {
  if (state_) unsubscribe();
}

base::Result<Iface> Iface::open(std::uint32_t server_id, IfaceType type, std::string_view name) {
  if (auto good = check_name(name); !good) return good.error();
  SegmentName wanted{::geteuid(), server_id, type, std::string(name)};
  auto segment = Segment::open(wanted);
  if (!segment) {
    bool is_found = false;
    const auto places = segment_places();
    for (const SegmentPlace& place : *places) {
      const SegmentName& other = place.name;
      if (other.server_id != server_id || other.type != type || other.iface != name) continue;
      is_found = true;
      if (other.uid == wanted.uid || !inspect(place).is_alive) continue;
      segment = Segment::open(other);
      if (segment) break;
    }
    if (!segment && is_found) return segment.error();
    if (!segment) return base::Error{explain_absence(server_id, type, name)};
  }
  auto state = std::make_shared<State>(std::move(*segment));
  if (auto good = state->prepare(); !good) return good.error();
  const auto fail = [&](const std::string& what) {
    return base::Error{describe(type, name) + " on server " + std::to_string(server_id) + " " + what};
  };
  switch (state->status(false)) {
    case Status::live:
      break;
    case Status::closed:
      return fail("is closed");
    case Status::dead:
      return fail("was left behind by pid " + std::to_string(state->segment.facts().server.pid) + ", which has ended");
  }
  return Iface(std::move(state));
}

IfaceType Iface::type() const { return state_->segment.name().type; }
const std::string& Iface::name() const { return state_->segment.name().iface; }
std::uint32_t Iface::server_id() const { return state_->segment.name().server_id; }
const Segment& Iface::segment() const { return state_->segment; }

const void* Iface::info_bytes([[maybe_unused]] std::size_t size) const {
  assert(size <= state_->info.size() * 8 && "not the info of this type");
  return state_->info.data();
}

const void* Iface::sample_bytes([[maybe_unused]] std::size_t size) const {
  assert(size <= state_->buffer.size() * 8 && "not the sample of this type");
  return state_->buffer.data();
}

std::span<const std::byte> Iface::sample_data() const { return std::as_bytes(std::span(state_->buffer)); }

std::span<const std::byte> Iface::info_data() const { return std::as_bytes(std::span(state_->info)); }

const std::byte* Iface::info_followers(std::size_t array) const {
  const IfaceRow& row = row_of(type());
  return info_data().data() + row.info_size + array * state_->count * row.info_tail.size;
}

const std::byte* Iface::sample_followers(std::size_t array) const {
  const IfaceRow& row = row_of(type());
  return sample_data().data() + row.sample_size + array * state_->count * row.sample_tail.size;
}

std::size_t Iface::count() const { return state_->count; }

std::size_t Iface::filled() const {
  const IfaceRow& row = row_of(type());
  if (row.filled == nullptr) return 0;
  return std::min<std::size_t>(*static_cast<const std::uint32_t*>(row.filled(sample_data().data())), state_->count);
}

std::span<const Pose> Iface::sonar_poses() const {
  if (type() != IfaceType::sonar) return {};
  return {reinterpret_cast<const Pose*>(info_followers(0)), state_->count};
}

base::Result<void> Iface::subscribe() {
  if (state_->is_subscribed && state_->has_lease()) return {};
  const bool has_lease = state_->has_lease();
  state_->is_subscribed = true;
  if (auto good = state_->ensure_lease(); !good) {
    state_->is_subscribed = false;
    return good;
  }
  if (has_lease) set_lease_flags(state_->segment, *state_->lease, RTMSIM_LEASE_SUBSCRIBER);
  call_server_of(state_->segment.name());  // where time stands still a sample is made for us alone
  return {};
}

void Iface::unsubscribe() {
  State& state = *state_;
  const bool was_subscribed = std::exchange(state.is_subscribed, false);
  if (!state.has_lease()) return;
  const Lease& lease = state.own_lease();
  const bool holds_frames = std::any_of(std::begin(lease.holds), std::end(lease.holds), [](const auto& hold) { return load(hold) != 0; });
  if (holds_frames) {
    set_lease_flags(state.segment, *state.lease, 0);  // the last held frame's keeper gives it back
    return;
  }
  give_lease_back(state.segment, *state.lease, state.owner);
  state.lease.reset();
  if (was_subscribed) call_server_of(state.segment.name());
}

bool Iface::is_subscribed() const { return state_->is_subscribed && state_->has_lease(); }

std::uint64_t Iface::sequence() const { return load(state_->header().sequence); }  // pairs with the release in publish

// Copies a sample out of its cell; false when the cell has another one by now.
bool Iface::State::copy_sample(std::uint64_t number) {
  const Area& cells = segment.area(AreaIndex::cells);
  const std::byte* cell = segment.at(AreaIndex::cells, number % cells.count);
  const auto& lock = *reinterpret_cast<const std::uint64_t*>(cell);
  if (load(lock) != 2 * number + 2) return false;  // pairs with the release in publish
  copy_out(buffer.data(), cell + sizeof lock, buffer.size() * 8);
  return load(lock, std::memory_order_relaxed) == 2 * number + 2;
}

bool Iface::read() {
  if (state_->segment.area(AreaIndex::cells).count == 0) return false;
  for (int attempt = 0; attempt < read_attempts; ++attempt) {
    const std::uint64_t latest = sequence();
    if (latest == 0) return false;
    if (state_->copy_sample(latest)) return true;
  }
  return false;
}

bool Iface::read_after(std::uint64_t than) {
  const std::uint64_t cells = state_->segment.area(AreaIndex::cells).count;
  if (cells == 0) return false;
  for (std::uint64_t number = than + 1; number <= sequence(); ++number) {
    number = std::max(number, sequence() - std::min(sequence(), cells - 1));
    if (state_->copy_sample(number)) return true;
  }
  return false;
}

void Iface::expect() const {
  const Header& header = state_->header();
  __builtin_prefetch(&header.state);
  __builtin_prefetch(&header.sequence);
}

// What follows the first lines the processor fetches by itself.
void Iface::bring() const {
  constexpr std::size_t line = 64, most = 4 * line;
  const State& state = *state_;
  const Area& cells = state.segment.area(AreaIndex::cells);
  if (cells.count == 0) return;
  const std::byte* cell = state.segment.at(AreaIndex::cells, sequence() % cells.count);
  for (std::size_t at = 0; at < std::min<std::size_t>(cells.stride, most); at += line) __builtin_prefetch(cell + at);
}

ScanView Iface::laser_scan() const {
  const auto& head = sample<LaserSample>();
  const auto* ranges = reinterpret_cast<const float*>(&head + 1);
  return {&head, {ranges, state_->count}, {ranges + state_->count, state_->count}};
}

SonarView Iface::sonar_scan() const {
  const auto& head = sample<SonarSample>();
  return {&head, {reinterpret_cast<const float*>(&head + 1), state_->count}};
}

BumperView Iface::bumper() const {
  const auto& head = sample<BumperSample>();
  return {&head, {reinterpret_cast<const Contact*>(&head + 1), filled()}};
}

Wait Iface::wait(std::uint64_t than, std::chrono::nanoseconds timeout) {
  State& state = *state_;
  Header& header = state.header();
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    const std::uint32_t seen = load(header.wake_word, std::memory_order_seq_cst);
    const bool is_newer = sequence() > than;
    if (is_newer && (has_frames(type()) || read())) return Wait::fresh;
    if (state.status(true) != Status::live) return Wait::closed;
    const auto left = deadline - std::chrono::steady_clock::now();
    if (left.count() <= 0) return Wait::timed_out;
    announce(header.waiting, seen);
    if (load(header.wake_word, std::memory_order_seq_cst) != seen) continue;  // pairs with the store in announce_latest
    futex_wait(header.wake_word, seen, std::min<std::chrono::nanoseconds>(left, slice));
  }
}

std::optional<HeldFrame> Iface::hold() {
  State& state = *state_;
  const Area& frames = state.segment.area(AreaIndex::frames);
  if (frames.count == 0 || !state.has_lease()) return std::nullopt;
  auto& holds = state.own_lease().holds;
  auto* hold = std::find_if(std::begin(holds), std::end(holds), [](const auto& one) { return load(one) == 0; });
  if (hold == std::end(holds)) return std::nullopt;
  for (int attempt = 0; attempt < read_attempts; ++attempt) {
    const std::uint64_t latest = load(state.header().latest_slot);  // pairs with the store in FrameRing::publish
    const std::size_t index = latest & 0xff;
    if (latest == 0 || index >= frames.count) return std::nullopt;
    store(*hold, static_cast<std::uint32_t>(index) + 1, std::memory_order_seq_cst);
    const auto& head = state.segment.as<FrameHead>(AreaIndex::frames, index);
    if (load(head.lock, std::memory_order_seq_cst) == latest >> 8) {  // pairs with the stores in FrameRing::begin
      FrameHead copy{};
      copy.lock = latest >> 8;
      // All but the lock, which the writer may try and put back while we hold the slot.
      std::memcpy(&copy.stamp, &head.stamp, sizeof copy - offsetof(FrameHead, stamp));
      copy.size = std::min<std::uint64_t>(copy.size, frames.stride - sizeof(FrameHead));
      const std::span<const std::byte> data(reinterpret_cast<const std::byte*>(&head + 1), copy.size);
      return HeldFrame(state_, hold, copy, data);
    }
    store(*hold, 0U, std::memory_order_seq_cst);
  }
  return std::nullopt;
}

base::Result<void> Iface::command(CommandKind kind, std::span<const double> values, std::chrono::nanoseconds duration) {
  State& state = *state_;
  const auto fail = [&](const std::string& what) { return base::Error{describe(type(), name()) + ": command " + what}; };
  const std::size_t most = state.segment.facts().command_values;
  if (most == 0) return fail("is not possible: this iface takes none");
  if (values.size() > most)
    return fail("of " + std::to_string(values.size()) + " values, at most " + std::to_string(most) + " are possible");
  for (double value : values) {
    if (!(std::abs(value) <= 1e9)) return fail("value must be finite and within 1e9, got " + base::format_number(value));
  }
  if (auto good = state.ensure_lease(); !good) return good;
  if (state.status(true) != Status::live) return fail("ignored: the simulator has exited");
  Lease& lease = state.own_lease();
  CommandHead fresh{};
  fresh.sequence = load(lease.command.sequence, std::memory_order_relaxed) + 1;
  fresh.kind = static_cast<std::uint32_t>(kind);
  if (duration.count() > 0) fresh.flags = RTMSIM_COMMAND_TIMED, fresh.sim_time_ns = duration.count();
  const std::uint64_t lock = load(lease.command_lock, std::memory_order_relaxed) & ~std::uint64_t{1};
  store(lease.command_lock, lock + 1, std::memory_order_relaxed);  // seen by whoever sees a word of the copy
  copy_in(&lease.command, &fresh, sizeof fresh);
  double* shared = command_values_of(lease);
  copy_in(shared, values.data(), values.size_bytes());
  for (std::size_t i = values.size(); i < most; ++i) store(shared[i], 0.0);
  store(lease.command_lock, lock + 2);  // pairs with the acquire in IfaceWriter::poll_command
  auto latest = word(state.header().command_latest);
  std::uint64_t before = latest.load(std::memory_order_relaxed);
  do {
    state.last_command = (((before >> 16) + 1) << 16) | *state.lease;
  } while (!latest.compare_exchange_weak(before, state.last_command, std::memory_order_release, std::memory_order_relaxed));
  return {};
}

base::Result<void> Iface::command_velocity(double vx, double vy, double va) {
  const double values[] = {vx, vy, va};
  return command(CommandKind::velocity, values);
}

bool Iface::is_commanding() const {
  return state_->has_lease() && state_->last_command != 0 && load(state_->header().command_latest) == state_->last_command;
}

Status Iface::status() const { return state_->status(true); }

base::Result<void> Iface::reopen() {
  auto fresh = open(server_id(), type(), name());
  if (!fresh) return fresh.error();
  if (state_->is_subscribed) {
    if (auto good = fresh->subscribe(); !good) return good;
  }
  *this = std::move(*fresh);
  return {};
}

}  // namespace shm
