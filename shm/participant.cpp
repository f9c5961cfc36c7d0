// The clients' side of the lock step, and what anybody may read of it.
#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <utility>
#include <vector>

#include "base/text.h"
#include "shm/lockstep.h"
#include "shm/participant_slots.h"
#include "shm/spinning.h"

namespace shm {
namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

constexpr nanoseconds client_slice = std::chrono::milliseconds(100);
constexpr std::size_t all_bits = 32 * RTMSIM_TICK_WORDS;

// All slots, the best first: who is woken wakes everybody on the same bit of the same word, so there should be nobody, or only such as have
// their ticks at the same time. What is seen here may just change: that costs wakes, nothing else.
std::vector<std::size_t> slots_by_company(const Segment& segment, const ParticipantOptions& options) {
  enum Company { nobody, alike, others };
  std::array<Company, all_bits> company{};
  for (std::size_t i = 0; i < slot_count(segment); ++i) {
    const ParticipantSlot& slot = slot_at(segment, i);
    if (load(slot.owner) == 0) continue;
    const bool is_alike = load(slot.phase) == options.phase && load(slot.turn) == options.turn &&
                          load(slot.period_ns) == options.period.count() && (load(slot.observes) == observer) == options.observes;
    company[i % all_bits] = std::max(company[i % all_bits], is_alike ? alike : others);
  }
  std::vector<std::size_t> slots(slot_count(segment));
  std::iota(slots.begin(), slots.end(), std::size_t{0});
  std::ranges::stable_sort(slots, {}, [&](std::size_t i) { return company[i % all_bits]; });
  return slots;
}

}  // namespace

std::vector<ParticipantRecord> read_records(const Segment& segment) {
  std::vector<ParticipantRecord> records;
  for (std::size_t i = 0; i < slot_count(segment); ++i) {
    const ParticipantSlot& slot = slot_at(segment, i);
    const std::uint64_t owner = load(slot.owner);
    const std::uint32_t state = load(slot.state);
    if (owner == 0 || (state != RTMSIM_PARTICIPANT_JOINING && state != RTMSIM_PARTICIPANT_ACTIVE)) continue;
    ParticipantRecord record;
    record.name = name_of(slot);
    record.pid = owner_pid(owner);
    record.phase = slot.phase;
    record.period_ns = load(slot.period_ns);
    record.ticks = load(slot.ticks);
    record.missed = load(slot.missed);
    record.max_ns = load(slot.max_ns);
    record.mean_ns = record.ticks > 0 ? load(slot.total_ns) / static_cast<std::int64_t>(record.ticks) : 0;
    record.is_active = state == RTMSIM_PARTICIPANT_ACTIVE;
    record.is_late = record.is_active && load(slot.done) != load(slot.go);
    records.push_back(std::move(record));
  }
  std::stable_sort(records.begin(), records.end(), [](const auto& a, const auto& b) { return a.phase < b.phase; });
  return records;
}

base::Result<std::vector<ParticipantRecord>> read_participants(const Iface& simulation) {
  if (slot_count(simulation.segment()) == 0) return base::Error{"iface '" + simulation.name() + "' has no participants"};
  return read_records(simulation.segment());
}

std::uint64_t phase_counter_of(const Iface& simulation) {
  return slot_count(simulation.segment()) == 0 ? 0 : phase_counter_of(simulation.segment());
}

struct Participant::Impl {
  explicit Impl(Iface opened) : simulation(std::move(opened)) {}
  ~Impl() { leave(); }

  Iface simulation;
  std::size_t index = 0;
  std::uint64_t owner = 0;
  std::uint32_t last_go = 0;
  bool is_in_tick = false, is_tool = false;
  steady_clock::time_point tick_start, check_at;  // check_at: when to look next whether the server lives
  std::uint64_t phase_counter = 0;                // of the last tick
  std::uint64_t ticks = 0;
  std::int64_t total = 0, max = 0;
  std::atomic<bool> is_interrupted{false};
  TurnWait turn;

  ParticipantSlot& slot() const { return slot_at(simulation.segment(), index); }
  std::uint32_t part(bool observes) const { return observes ? observer : is_tool ? waited_tool : takes_part; }
  bool is_ours() const { return load(slot().owner) == owner; }
  base::Result<void> take_slot(const ParticipantOptions& options);
  bool finish(steady_clock::time_point now);
  bool has_tick() const { return load(slot().go) != last_go; }
  bool ticks_in_each_step() const { return load(slot().period_ns) <= simulation.info<SimulationInfo>().step_ns; }
  void linger() const;
  void look_for_tick(nanoseconds limit) const;
  void leave();
};

base::Result<void> Participant::Impl::take_slot(const ParticipantOptions& options) {
  const Segment& segment = simulation.segment();
  owner = make_owner();
  const ProcessMark mark = own_mark();
  for (const std::size_t i : slots_by_company(segment, options)) {
    ParticipantSlot& candidate = slot_at(segment, i);
    std::uint64_t free = 0;
    if (!word(candidate.owner).compare_exchange_strong(free, owner, std::memory_order_acq_rel)) continue;
    index = i;
    store(candidate.pid_namespace, mark.pid_namespace);
    store(candidate.start_time, mark.start_time);
    store(candidate.phase, options.phase);  // who looks for a place reads them meanwhile
    store(candidate.turn, options.turn);
    is_tool = options.is_tool;
    store(candidate.observes, part(options.observes));
    store(candidate.period_ns, static_cast<std::int64_t>(options.period.count()));
    set_text(candidate.name, options.name);
    store(candidate.done, 0U);
    store(candidate.sleeping, awake);
    store(candidate.ticks, std::uint64_t{0});
    store(candidate.total_ns, std::int64_t{0});
    store(candidate.max_ns, std::int64_t{0});
    store(candidate.missed, std::uint64_t{0});
    store(candidate.go, 0U);
    store(candidate.state, static_cast<std::uint32_t>(RTMSIM_PARTICIPANT_JOINING));  // pairs with Barrier's scan
    change_participants(segment);
    return {};
  }
  return base::Error{"participant " + base::in_quotes(options.name) + ": all " + std::to_string(slot_count(segment)) +
                     " places on server " + std::to_string(simulation.server_id()) + " are taken"};
}

void Participant::Impl::leave() {
  if (owner == 0 || !is_ours()) return;
  ParticipantSlot& mine = slot();
  std::uint32_t state = RTMSIM_PARTICIPANT_JOINING;
  // Not taken in yet, or dropped: the slot is ours to free. Else the server does.
  if (word(mine.state).compare_exchange_strong(state, RTMSIM_PARTICIPANT_FREE, std::memory_order_acq_rel) ||
      state == RTMSIM_PARTICIPANT_DROPPED) {
    free_slot(mine, owner);
  } else {
    store(mine.state, static_cast<std::uint32_t>(RTMSIM_PARTICIPANT_LEAVING));
    if (is_in_tick) {
      store(mine.done, last_go, std::memory_order_seq_cst);
      Control& control = control_of(simulation.segment());
      word(control.pending).fetch_sub(1, std::memory_order_seq_cst);
      wake_server(control);
    }
  }
  change_participants(simulation.segment());
  owner = 0;
}

Participant::Participant(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Participant::Participant(Participant&&) noexcept = default;
Participant& Participant::operator=(Participant&&) noexcept = default;
Participant::~Participant() = default;

base::Result<Participant> Participant::join(std::uint32_t server_id, const ParticipantOptions& options) {
  const auto fail = [&](const std::string& what) { return base::Error{"participant " + base::in_quotes(options.name) + ": " + what}; };
  if (options.name.empty()) return fail("needs a name");
  if (options.phase > max_phase) return fail("phase must be 0 to 15, got " + std::to_string(options.phase));
  if (options.period.count() < 0 || options.period.count() >= longest_period) {
    return fail("period must be at least 0 and less than " + std::to_string(longest_period / 1'000'000'000) + " s, got " +
                std::to_string(options.period.count()) + " ns");
  }
  auto simulation = Iface::open(server_id, IfaceType::simulation, "world");
  if (!simulation) return simulation.error();
  if (slot_count(simulation->segment()) == 0) return fail("the server takes no participants");
  ParticipantOptions wanted = options;
  if (wanted.period.count() == 0) wanted.period = nanoseconds(simulation->info<SimulationInfo>().step_ns);
  auto impl = std::make_unique<Impl>(std::move(*simulation));
  if (auto good = impl->take_slot(wanted); !good) {
    impl->owner = 0;
    return good.error();
  }
  return Participant(std::move(impl));
}

// True: it was the last one of its phase, and the server is awake.
bool Participant::Impl::finish(steady_clock::time_point now) {
  if (!is_in_tick) return false;
  is_in_tick = false;
  if (!is_ours()) return false;
  ParticipantSlot& mine = slot();
  const std::int64_t took = std::chrono::duration_cast<nanoseconds>(now - tick_start).count();
  total += took;
  max = std::max(max, took);
  store(mine.ticks, ++ticks, std::memory_order_relaxed);
  store(mine.total_ns, total, std::memory_order_relaxed);
  store(mine.max_ns, max, std::memory_order_relaxed);
  store(mine.done, last_go, std::memory_order_seq_cst);  // pairs with Barrier's is_done
  Control& control = control_of(simulation.segment());
  if (word(control.pending).fetch_sub(1, std::memory_order_seq_cst) > 1) return false;
  return !wake_server(control);
}

// Until the server has passed to the next phase, and a little longer: who takes part there is woken meanwhile and goes on on this
// processor, which has not gone to sleep. When no phase follows at once, and after observers, there is nobody to wait for.
void Participant::Impl::linger() const {
  constexpr nanoseconds most = std::chrono::microseconds(20), pause = std::chrono::microseconds(3);
  if (phase_counter % 2 == 0) return;
  const auto begin = steady_clock::now();
  std::optional<steady_clock::time_point> over;
  std::uint64_t seen = phase_counter;
  for (auto now = begin; now - begin < most && !has_tick(); now = steady_clock::now()) {
    if (const auto at = phase_counter_of(simulation.segment()); at != std::exchange(seen, at)) over = now;
    if (over && now - *over > pause) return;
    give_way();
  }
}

// For one that has been woken before its tick.
void Participant::Impl::look_for_tick(nanoseconds limit) const {
  for (const auto end = steady_clock::now() + limit; !has_tick() && !is_interrupted.load(std::memory_order_relaxed);) {
    if (steady_clock::now() >= end) return;
    give_way();
  }
}

void Participant::finish() { impl_->finish(steady_clock::now()); }

Participant::State Participant::wait(Tick& tick, nanoseconds timeout) {
  const State state = await(timeout);
  if (state == State::tick) tick = begin();
  return state;
}

Participant::State Participant::look() const {
  const Impl& impl = *impl_;
  if (load(impl.simulation.segment().header().state) != RTMSIM_STATE_LIVE) return State::closed;
  const std::uint32_t state = load(impl.slot().state);
  if (impl.owner == 0 || !impl.is_ours() || state == RTMSIM_PARTICIPANT_DROPPED) return State::dropped;
  const bool is_called = load(impl.slot().go, std::memory_order_seq_cst) != impl.last_go && state == RTMSIM_PARTICIPANT_ACTIVE;
  return is_called ? State::tick : State::timed_out;
}

Tick Participant::begin() {
  Impl& impl = *impl_;
  const ParticipantSlot& mine = impl.slot();
  constexpr auto relaxed = std::memory_order_relaxed;
  impl.last_go = load(mine.go, std::memory_order_seq_cst);  // pairs with the store in Barrier's release
  const Tick tick = {nanoseconds(load(mine.now_ns, relaxed)), nanoseconds(load(mine.due_ns, relaxed)), load(mine.steps, relaxed),
                     load(mine.resets, relaxed), phase_counter_of(impl.simulation.segment())};
  impl.phase_counter = tick.phase_counter;
  impl.is_in_tick = true;
  impl.tick_start = steady_clock::now();
  return tick;
}

Participant::State Participant::await(nanoseconds timeout) {
  Impl& impl = *impl_;
  const Segment& segment = impl.simulation.segment();
  ParticipantSlot& mine = impl.slot();
  const std::uint32_t& shared = tick_word(control_of(segment), impl.index);
  auto now = steady_clock::now();  // read once per sleep
  const auto deadline = now + timeout;
  if (impl.is_in_tick) {
    if (impl.finish(now)) impl.linger();
    // Others would take the processors from those that they wait for.
    if (impl.ticks_in_each_step())
      static_cast<void>(impl.turn.look([&] { return impl.has_tick() || impl.is_interrupted.load(std::memory_order_relaxed); }, deadline));
    now = steady_clock::now();
  }
  while (true) {
    if (load(segment.header().state) != RTMSIM_STATE_LIVE) return State::closed;
    if (!impl.is_ours() || load(mine.state) == RTMSIM_PARTICIPANT_DROPPED) {
      impl.leave();
      return State::dropped;
    }
    if (impl.is_interrupted.load(std::memory_order_relaxed) && impl.is_interrupted.exchange(false)) return State::timed_out;
    store(mine.sleeping, asleep, std::memory_order_seq_cst);  // pairs with the load in Barrier's wake
    const std::uint32_t seen = load(shared, std::memory_order_seq_cst);
    const bool is_called_now = look() == State::tick;
    if (is_called_now || now >= deadline) {
      store(mine.sleeping, awake, std::memory_order_relaxed);
      impl.turn.slept();
      return is_called_now ? State::tick : State::timed_out;
    }
    if (now >= impl.check_at) {
      impl.check_at = now + client_slice;
      if (impl.simulation.status() != Status::live) return State::closed;
    }
    futex_wait_bits(shared, seen, tick_bit(impl.index), std::min(deadline, impl.check_at));
    const bool is_called = load(mine.sleeping, std::memory_order_relaxed) == called;  // else somebody else was, on the same bit
    store(mine.sleeping, awake, std::memory_order_relaxed);
    now = steady_clock::now();
    if (!is_called || impl.has_tick() || now >= deadline || now >= impl.check_at) continue;
    impl.look_for_tick(WakeAhead::longest);
    now = steady_clock::now();
  }
}

void Participant::set_period(nanoseconds period) {
  if (impl_->is_ours() && period.count() > 0) store(impl_->slot().period_ns, static_cast<std::int64_t>(period.count()));
}

void Participant::set_observing(bool observes) {
  if (impl_->is_ours()) store(impl_->slot().observes, impl_->part(observes));
}

bool Participant::is_active() const { return impl_->is_ours() && load(impl_->slot().state) == RTMSIM_PARTICIPANT_ACTIVE; }

void Participant::interrupt() {
  impl_->is_interrupted.store(true);
  if (impl_->is_ours()) wake_participant(control_of(impl_->simulation.segment()), impl_->index);
}

}  // namespace shm
