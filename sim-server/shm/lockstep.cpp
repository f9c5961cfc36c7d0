#include "shm/lockstep.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <thread>
#include <utility>

#include "base/text.h"
#include "shm/futex.h"
#include "shm/process.h"
#include "shm/words.h"

namespace shm {
namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

constexpr std::uint32_t max_phase = 15;
constexpr nanoseconds spin_limit = std::chrono::microseconds(50);
constexpr nanoseconds server_slice = std::chrono::milliseconds(10);
constexpr nanoseconds client_slice = std::chrono::milliseconds(100);
constexpr std::int64_t longest_period = std::int64_t{1} << 60;

// Between two looks of a thread that spins.
void relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#else
  std::atomic_signal_fence(std::memory_order_seq_cst);
#endif
}

ParticipantSlot& slot_at(const Segment& segment, std::size_t index) { return segment.as<ParticipantSlot>(AreaIndex::participants, index); }
std::size_t slot_count(const Segment& segment) { return segment.area(AreaIndex::participants).count; }
Control& control_of(const Segment& segment) { return segment.as<Control>(AreaIndex::control); }

ProcessMark mark_of(const ParticipantSlot& slot) { return {owner_pid(load(slot.owner)), load(slot.pid_namespace), load(slot.start_time)}; }

// Whatever a client has written there, it is one line of text for people.
std::string name_of(const ParticipantSlot& slot) {
  std::string name(slot.name, strnlen(slot.name, sizeof slot.name));
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return name;
}

void free_slot(ParticipantSlot& slot, std::uint64_t owner) {
  store(slot.state, static_cast<std::uint32_t>(RTMSIM_PARTICIPANT_FREE));
  store(slot.start_time, std::uint64_t{0});
  word(slot.owner).compare_exchange_strong(owner, 0, std::memory_order_acq_rel);
}

void wake_server(Control& control) {
  word(control.server_word).fetch_add(1, std::memory_order_seq_cst);
  if (load(control.server_waiting, std::memory_order_seq_cst) != 0) futex_wake(control.server_word, 1);  // pairs with Barrier's wait
}

std::uint32_t& tick_word(Control& control, std::size_t index) { return control.tick_words[index / 32 % RTMSIM_TICK_WORDS]; }
constexpr std::uint32_t tick_bit(std::size_t index) { return 1U << index % 32; }

void wake_participant(Control& control, std::size_t index) {
  word(tick_word(control, index)).fetch_add(1, std::memory_order_seq_cst);
  futex_wake_bits(tick_word(control, index), tick_bit(index));
}

void change_participants(const Segment& segment) {
  Control& control = control_of(segment);
  word(control.participant_epoch).fetch_add(1, std::memory_order_acq_rel);
  word(control.attention).fetch_add(1, std::memory_order_seq_cst);
  ring(control.attention, control.attention_waiting);
}

// First multiple of period at or after `time`.
std::int64_t multiple_from(std::int64_t time, std::int64_t period) {
  if (time <= 0) return 0;
  const std::int64_t periods = (time - 1) / period + 1;
  return periods > longest_period / period ? longest_period : periods * period;
}

}  // namespace

struct Barrier::State {
  // The server's own account of an active participant.
  struct Member {
    std::size_t index = 0;
    std::uint64_t owner = 0;
    std::shared_ptr<const Watched> watched;
    std::string name;
    std::uint32_t phase = 0;
    std::int64_t period = 0, next_due = 0;
    std::uint32_t go = 0;
    std::uint64_t missed = 0;
    bool is_hanging = false;
  };

  State(const Segment& s, Server& srv, BarrierOptions o) : segment(s), server(srv), options(std::move(o)) {}

  const Segment& segment;
  Server& server;
  BarrierOptions options;
  std::vector<Member> members;  // by phase, then in the order of joining
  std::uint32_t seen_epoch = 0;
  std::uint64_t seen_deaths = 0;
  bool has_scanned = false;
  const bool has_processors = std::thread::hardware_concurrency() > 1;
  bool is_ticking = false, has_gone = false;  // gone: members with owner 0 are to be removed after the tick
  std::int64_t last_now = -1;
  std::int64_t earliest_due = 0;
  std::uint32_t resets = 0;

  ParticipantSlot& slot(const Member& member) const { return slot_at(segment, member.index); }
  Control& control() const { return control_of(segment); }
  bool is_done(const Member& member) const { return load(slot(member).done, std::memory_order_seq_cst) == member.go; }
  void tell(BarrierEvent::Kind kind, const Member& member) const {
    if (options.on_event) options.on_event({kind, member.name, owner_pid(member.owner), member.phase});
  }
  void schedule_all();
  void take_in(std::size_t index);
  void scan();
  bool remove_if_gone(Member& member);
  void drop(const Member& member, std::uint32_t why);
  void release(Member& member, std::int64_t now, std::uint64_t steps);
  void wake(std::span<Member* const> group);
  bool run_phase(std::span<Member*> group, std::int64_t now, std::uint64_t steps);
  bool wait_for(std::span<Member*> group);
  void look_for_hangs(std::span<Member*> group, nanoseconds waited);
};

Barrier::Barrier(IfaceWriter& simulation, Server& server, BarrierOptions options)
    : state_(std::make_unique<State>(simulation.segment(), server, std::move(options))) {
  server.watch().on_death([&control = state_->control()] { wake_server(control); });
}

Barrier::~Barrier() {
  state_->server.watch().on_death({});
  store(state_->segment.header().state, static_cast<std::uint32_t>(RTMSIM_STATE_CLOSED));
  for (const auto& member : state_->members) wake_participant(state_->control(), member.index);
}

void Barrier::State::schedule_all() {
  earliest_due = longest_period;
  for (const Member& member : members) earliest_due = std::min(earliest_due, member.next_due);
}

void Barrier::State::take_in(std::size_t index) {
  ParticipantSlot& slot = slot_at(segment, index);
  Member member;
  member.index = index;
  member.owner = load(slot.owner);
  member.name = name_of(slot);
  member.phase = slot.phase;
  member.period = load(slot.period_ns);
  const bool is_good = member.phase <= max_phase && member.period > 0 && member.period < longest_period && member.owner != 0;
  member.watched = server.watch().watch(mark_of(slot));
  if (member.watched->is_dead()) return free_slot(slot, member.owner);
  member.next_due = multiple_from(last_now + 1, std::max<std::int64_t>(member.period, 1));
  std::uint32_t joining = RTMSIM_PARTICIPANT_JOINING;
  store(slot.go, 0U);
  store(slot.error, is_good ? 0U : static_cast<std::uint32_t>(RTMSIM_DROPPED_REFUSED));
  const auto wanted = static_cast<std::uint32_t>(is_good ? RTMSIM_PARTICIPANT_ACTIVE : RTMSIM_PARTICIPANT_DROPPED);
  if (!word(slot.state).compare_exchange_strong(joining, wanted, std::memory_order_acq_rel)) return;  // it left again
  wake_participant(control(), index);
  if (!is_good) return;
  const auto place =
      std::upper_bound(members.begin(), members.end(), member.phase, [](std::uint32_t phase, const Member& m) { return phase < m.phase; });
  tell(BarrierEvent::Kind::joined, *members.insert(place, std::move(member)));
}

// True, with the slot freed, when the participant has left, died or lost its slot.
bool Barrier::State::remove_if_gone(Member& member) {
  ParticipantSlot& mine = slot(member);
  if (member.watched->is_dead()) {
    free_slot(mine, member.owner);
    tell(BarrierEvent::Kind::died, member);
    return true;
  }
  if (load(mine.owner) == member.owner && load(mine.state) == RTMSIM_PARTICIPANT_ACTIVE) return false;
  if (load(mine.owner) == member.owner) free_slot(mine, member.owner);
  tell(BarrierEvent::Kind::left, member);
  return true;
}

void Barrier::State::scan() {
  std::erase_if(members, [this](Member& member) { return remove_if_gone(member); });
  for (std::size_t i = 0; i < slot_count(segment); ++i) {
    ParticipantSlot& slot = slot_at(segment, i);
    const std::uint64_t owner = load(slot.owner);
    if (owner == 0) continue;
    const std::uint32_t state = load(slot.state);  // pairs with the release in Participant::join
    if (state == RTMSIM_PARTICIPANT_JOINING) {
      take_in(i);
    } else if (std::none_of(members.begin(), members.end(), [i](const Member& member) { return member.index == i; })) {
      // Taken but never asked to join, dropped, or scribbled over: only of interest when its process is dead.
      if (load(slot.start_time) != 0 && !is_alive(mark_of(slot))) free_slot(slot, owner);
    }
  }
  schedule_all();
}

std::size_t Barrier::refresh() {
  State& state = *state_;
  const std::uint32_t epoch = load(state.control().participant_epoch);  // pairs with change_participants
  const std::uint64_t deaths = state.server.watch().deaths();
  if (!state.has_scanned || epoch != state.seen_epoch || deaths != state.seen_deaths) {
    state.has_scanned = true;
    state.seen_epoch = epoch;
    state.seen_deaths = deaths;
    state.scan();
  }
  return state.members.size();
}

void Barrier::State::drop(const Member& member, std::uint32_t why) {
  ParticipantSlot& mine = slot(member);
  store(mine.error, why);
  store(mine.state, static_cast<std::uint32_t>(RTMSIM_PARTICIPANT_DROPPED));
  wake_participant(control(), member.index);
  tell(BarrierEvent::Kind::dropped, member);
}

void Barrier::State::release(Member& member, std::int64_t now, std::uint64_t steps) {
  ParticipantSlot& mine = slot(member);
  constexpr auto relaxed = std::memory_order_relaxed;
  store(mine.now_ns, now, relaxed);
  store(mine.due_ns, member.next_due, relaxed);
  store(mine.steps, steps, relaxed);
  store(mine.resets, resets, relaxed);
  const std::int64_t wanted = load(mine.period_ns, relaxed);
  if (wanted != member.period && wanted > 0 && wanted < longest_period) member.period = wanted;
  member.next_due = multiple_from(now + 1, member.period);
  if (++member.go == 0) member.go = 1;
  store(mine.go, member.go, std::memory_order_seq_cst);  // pairs with the load in Participant::wait; publishes the tick
}

// One system call for up to 32 sleepers, which also keeps the first of them from taking the processor away from us before the others
// are awake.
void Barrier::State::wake(std::span<Member* const> group) {
  std::array<std::uint32_t, RTMSIM_TICK_WORDS> bits{};
  for (const Member* member : group) {
    if (load(slot(*member).sleeping, std::memory_order_seq_cst) == 0) continue;  // pairs with the store in Participant::wait
    bits[member->index / 32 % RTMSIM_TICK_WORDS] |= tick_bit(member->index);
  }
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (bits[i] == 0) continue;
    word(control().tick_words[i]).fetch_add(1, std::memory_order_seq_cst);
    futex_wake_bits(control().tick_words[i], bits[i]);
  }
}

void Barrier::State::look_for_hangs(std::span<Member*> group, nanoseconds waited) {
  for (Member* member : group) {
    if (member->owner == 0 || is_done(*member)) continue;
    if (waited >= options.hang_warning && !member->is_hanging) {
      member->is_hanging = true;
      tell(BarrierEvent::Kind::hangs, *member);
    }
    if (options.participant_timeout.count() > 0 && waited >= options.participant_timeout) {
      drop(*member, RTMSIM_DROPPED_HUNG);
      member->owner = 0;
    }
  }
}

// Members that die, leave or are dropped meanwhile get owner 0; the caller removes them. False when on_waiting wants to end.
bool Barrier::State::wait_for(std::span<Member*> group) {
  Control& shared = control();
  steady_clock::time_point start, last_look;
  int sleeps = 0;
  std::uint64_t deaths = seen_deaths;
  const auto let_go = [&] {
    for (Member* member : group) {
      if (member->owner != 0 && !is_done(*member) && remove_if_gone(*member)) member->owner = 0;
    }
  };
  const auto all_done = [&] {
    return std::all_of(group.begin(), group.end(), [this](const Member* m) { return m->owner == 0 || is_done(*m); });
  };
  // The tick of one is often over before a sleep and the waking from it would be. Several need the processors themselves.
  if (group.size() == 1 && has_processors) {
    for (const auto end = steady_clock::now() + spin_limit; steady_clock::now() < end;) {
      if (all_done()) {
        for (Member* member : group) member->is_hanging = false;
        return true;
      }
      for (int i = 0; i < 16; ++i) relax();
    }
  }
  while (true) {
    const std::uint32_t seen = load(shared.server_word, std::memory_order_seq_cst);
    if (const std::uint64_t deaths_now = server.watch().deaths(); deaths_now != deaths) {
      deaths = deaths_now;
      let_go();
    }
    if (all_done()) break;
    // The clock is read only when one sleep was not enough.
    if (++sleeps == 2) {
      start = last_look = steady_clock::now();
    } else if (sleeps > 2) {
      if (const auto now = steady_clock::now(); now - last_look >= server_slice) {
        last_look = now;
        let_go();
        look_for_hangs(group, now - start);
        if (options.on_waiting && !options.on_waiting()) return false;
      }
    }
    store(shared.server_waiting, 1U, std::memory_order_seq_cst);  // pairs with wake_server
    futex_wait(shared.server_word, seen, server_slice);
  }
  for (Member* member : group) member->is_hanging = member->is_hanging && member->owner != 0 && !is_done(*member);
  return true;
}

bool Barrier::State::run_phase(std::span<Member*> group, std::int64_t now, std::uint64_t steps) {
  if (!options.is_lockstep) {
    for (Member* member : group) {
      if (is_done(*member)) {
        release(*member, now, steps);
        wake({&member, 1});
        continue;
      }
      member->next_due = multiple_from(now + 1, member->period);
      store(slot(*member).missed, ++member->missed, std::memory_order_relaxed);
    }
    return true;
  }
  // Whoever counts down to one or below wakes the server, which then looks at all `done` words itself: the count is only a hint, so
  // that a participant that died between the two costs nothing but an extra look.
  store(control().server_waiting, 1U, std::memory_order_relaxed);
  store(control().pending, static_cast<std::int32_t>(group.size()), std::memory_order_seq_cst);
  for (Member* member : group) release(*member, now, steps);
  wake(group);
  const bool is_over = wait_for(group);
  store(control().server_waiting, 0U, std::memory_order_relaxed);
  return is_over;
}

bool Barrier::tick(nanoseconds now, std::uint64_t steps) {
  State& state = *state_;
  refresh();
  state.last_now = now.count();
  if (now.count() < state.earliest_due) return true;
  std::array<State::Member*, 256> due;  // no allocation in the loop; there are fewer slots than that
  std::size_t begin = 0;
  bool is_complete = true;
  state.is_ticking = true;
  while (begin < state.members.size() && is_complete) {
    const std::uint32_t phase = state.members[begin].phase;
    std::size_t end = begin, count = 0;
    for (; end < state.members.size() && state.members[end].phase == phase; ++end) {
      if (state.members[end].owner != 0 && state.members[end].next_due <= now.count() && count < due.size())
        due[count++] = &state.members[end];
    }
    const std::span<State::Member*> group(due.data(), count);
    if (count > 0) is_complete = state.run_phase(group, now.count(), steps);
    for (const auto* member : group) state.has_gone = state.has_gone || member->owner == 0;
    begin = end;
  }
  state.is_ticking = false;
  if (std::exchange(state.has_gone, false)) std::erase_if(state.members, [](const State::Member& member) { return member.owner == 0; });
  state.schedule_all();
  return is_complete;
}

std::optional<nanoseconds> Barrier::next_due() const {
  if (state_->members.empty()) return std::nullopt;
  return nanoseconds(state_->earliest_due);
}

void Barrier::rewind(nanoseconds now, std::uint32_t resets) {
  state_->resets = resets;
  state_->last_now = now.count() - 1;
  for (auto& member : state_->members) member.next_due = multiple_from(now.count(), member.period);
  state_->schedule_all();
}

void Barrier::set_lockstep(bool is_lockstep) { state_->options.is_lockstep = is_lockstep; }

bool Barrier::drop(const std::string& name) {
  State& state = *state_;
  bool is_found = false;
  for (auto& member : state.members) {
    if (member.owner == 0 || member.name != name) continue;
    state.drop(member, RTMSIM_DROPPED_ASKED);
    member.owner = 0;
    is_found = true;
  }
  if (!is_found) return false;
  state.has_gone = true;
  if (state.is_ticking) return true;  // asked by on_waiting: the tick removes it
  state.has_gone = false;
  std::erase_if(state.members, [](const State::Member& member) { return member.owner == 0; });
  state.schedule_all();
  return true;
}

namespace {

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

}  // namespace

std::vector<ParticipantRecord> Barrier::records() const { return read_records(state_->segment); }

base::Result<std::vector<ParticipantRecord>> read_participants(const Iface& simulation) {
  if (slot_count(simulation.segment()) == 0) return base::Error{"iface '" + simulation.name() + "' has no participants"};
  return read_records(simulation.segment());
}

struct Participant::Impl {
  explicit Impl(Iface opened) : simulation(std::move(opened)) {}
  ~Impl() { leave(); }

  Iface simulation;
  std::size_t index = 0;
  std::uint64_t owner = 0;
  std::uint32_t last_go = 0;
  bool is_in_tick = false;
  steady_clock::time_point tick_start, check_at;  // check_at: when to look next whether the server lives
  std::uint64_t ticks = 0;
  std::int64_t total = 0, max = 0;
  std::atomic<bool> is_interrupted{false};

  ParticipantSlot& slot() const { return slot_at(simulation.segment(), index); }
  bool is_ours() const { return load(slot().owner) == owner; }
  base::Result<void> take_slot(const ParticipantOptions& options);
  void finish(steady_clock::time_point now);
  void leave();
};

base::Result<void> Participant::Impl::take_slot(const ParticipantOptions& options) {
  const Segment& segment = simulation.segment();
  owner = make_owner();
  const ProcessMark mark = own_mark();
  for (std::size_t i = 0; i < slot_count(segment); ++i) {
    ParticipantSlot& candidate = slot_at(segment, i);
    std::uint64_t free = 0;
    if (!word(candidate.owner).compare_exchange_strong(free, owner, std::memory_order_acq_rel)) continue;
    index = i;
    store(candidate.pid_namespace, mark.pid_namespace);
    store(candidate.start_time, mark.start_time);
    candidate.phase = options.phase;
    store(candidate.period_ns, static_cast<std::int64_t>(options.period.count()));
    set_text(candidate.name, options.name);
    store(candidate.done, 0U);
    store(candidate.sleeping, 0U);
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
  if (options.period.count() <= 0 || options.period.count() >= longest_period) {
    return fail("period must be more than 0 and less than " + std::to_string(longest_period / 1'000'000'000) + " s, got " +
                std::to_string(options.period.count()) + " ns");
  }
  auto simulation = Iface::open(server_id, IfaceType::simulation, "world");
  if (!simulation) return simulation.error();
  if (slot_count(simulation->segment()) == 0) return fail("the server takes no participants");
  auto impl = std::make_unique<Impl>(std::move(*simulation));
  if (auto good = impl->take_slot(options); !good) {
    impl->owner = 0;
    return good.error();
  }
  return Participant(std::move(impl));
}

void Participant::Impl::finish(steady_clock::time_point now) {
  if (!is_in_tick) return;
  is_in_tick = false;
  if (!is_ours()) return;
  ParticipantSlot& mine = slot();
  const std::int64_t took = std::chrono::duration_cast<nanoseconds>(now - tick_start).count();
  total += took;
  max = std::max(max, took);
  store(mine.ticks, ++ticks, std::memory_order_relaxed);
  store(mine.total_ns, total, std::memory_order_relaxed);
  store(mine.max_ns, max, std::memory_order_relaxed);
  store(mine.done, last_go, std::memory_order_seq_cst);  // pairs with Barrier's is_done
  Control& control = control_of(simulation.segment());
  if (word(control.pending).fetch_sub(1, std::memory_order_seq_cst) <= 1) wake_server(control);
}

void Participant::finish() { impl_->finish(steady_clock::now()); }

Participant::State Participant::wait(Tick& tick, nanoseconds timeout) {
  Impl& impl = *impl_;
  const Segment& segment = impl.simulation.segment();
  ParticipantSlot& mine = impl.slot();
  const std::uint32_t& shared = tick_word(control_of(segment), impl.index);
  auto now = steady_clock::now();  // read once per sleep
  impl.finish(now);
  const auto deadline = now + timeout;
  while (true) {
    if (load(segment.header().state) != RTMSIM_STATE_LIVE) return State::closed;
    if (!impl.is_ours() || load(mine.state) == RTMSIM_PARTICIPANT_DROPPED) {
      impl.leave();
      return State::dropped;
    }
    if (impl.is_interrupted.load(std::memory_order_relaxed) && impl.is_interrupted.exchange(false)) return State::timed_out;
    store(mine.sleeping, 1U, std::memory_order_seq_cst);  // pairs with the load in Barrier's wake
    const std::uint32_t seen = load(shared, std::memory_order_seq_cst);
    const std::uint32_t go = load(mine.go, std::memory_order_seq_cst);
    if (go != impl.last_go && load(mine.state) == RTMSIM_PARTICIPANT_ACTIVE) {
      constexpr auto relaxed = std::memory_order_relaxed;
      store(mine.sleeping, 0U, relaxed);
      tick = {nanoseconds(load(mine.now_ns, relaxed)), nanoseconds(load(mine.due_ns, relaxed)), load(mine.steps, relaxed),
              load(mine.resets, relaxed)};
      impl.last_go = go;
      impl.is_in_tick = true;
      impl.tick_start = now;
      return State::tick;
    }
    if (now >= deadline) {
      store(mine.sleeping, 0U, std::memory_order_relaxed);
      return State::timed_out;
    }
    if (now >= impl.check_at) {
      impl.check_at = now + client_slice;
      if (impl.simulation.status() != Status::live) return State::closed;
    }
    futex_wait_bits(shared, seen, tick_bit(impl.index), std::min(deadline, impl.check_at));
    store(mine.sleeping, 0U, std::memory_order_relaxed);
    now = steady_clock::now();
  }
}

void Participant::set_period(nanoseconds period) {
  if (impl_->is_ours() && period.count() > 0) store(impl_->slot().period_ns, static_cast<std::int64_t>(period.count()));
}

bool Participant::is_active() const { return impl_->is_ours() && load(impl_->slot().state) == RTMSIM_PARTICIPANT_ACTIVE; }

void Participant::interrupt() {
  impl_->is_interrupted.store(true);
  if (impl_->is_ours()) wake_participant(control_of(impl_->simulation.segment()), impl_->index);
}

}  // namespace shm
