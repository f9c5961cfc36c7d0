// The server's side of the lock step.
#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "base/text.h"
#include "shm/lockstep.h"
#include "shm/participant_slots.h"
#include "shm/spinning.h"

namespace shm {
namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

constexpr nanoseconds server_slice = std::chrono::milliseconds(10);

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
    std::uint32_t phase = 0, turn = 0;
    std::int64_t period = 0, next_due = 0;
    std::uint32_t go = 0;
    std::uint64_t missed = 0;
    bool is_hanging = false;
    bool observes = false;    // as of this tick
    bool is_tool = false;     // likewise
    bool is_looking = false;  // an observer in its tick

    auto order() const { return std::pair(phase, turn); }
  };

  State(const Segment& s, Server& srv, BarrierOptions o) : segment(s), server(srv), options(std::move(o)) {}

  const Segment& segment;
  Server& server;
  BarrierOptions options;
  std::vector<Member> members;  // by phase and turn, then in the order of joining
  std::vector<Member*> due;     // of the turn that runs; kept, so that no tick has to make room
  std::uint32_t seen_epoch = 0;
  std::uint64_t seen_deaths = 0;
  std::uint32_t seen_attention = 0;  // of requests and the like, which are served while a tick waits
  bool has_scanned = false;
  std::array<SpinLimit, max_phase + 1> spins;  // by phase
  FreeProcessors free;
  WakeAhead ahead;
  std::optional<steady_clock::time_point> woken_ahead;  // those of the first phase of the next tick
  bool has_looked_ahead = false;
  bool is_ticking = false, has_gone = false;  // gone: members with owner 0 are to be removed after the tick
  std::int64_t last_now = -1;
  std::int64_t earliest_due = 0;   // of all
  std::int64_t earliest_turn = 0;  // of those who are waited for at once
  std::int64_t earliest_part = 0;  // of those who do not only look on
  bool is_looked_at = false;
  std::uint32_t resets = 0;
  mutable std::uint64_t phase_counter = 0;  // kept here, too: what a client scribbles into the shared one must not stay

  ParticipantSlot& slot(const Member& member) const { return slot_at(segment, member.index); }
  Control& control() const { return control_of(segment); }
  void advance_phase_counter() const {
    store(control().moment, ++phase_counter, std::memory_order_release);
  }  // pairs with the loads in phase_counter_of
  bool is_done(const Member& member) const { return load(slot(member).done, std::memory_order_seq_cst) == member.go; }
  void tell(BarrierEvent::Kind kind, const Member& member, bool was_in_tick = false) const {
    if (options.on_event)
      options.on_event({kind, member.name, owner_pid(member.owner), member.phase, member.period, member.is_tool, was_in_tick});
  }
  void schedule_all();
  void take_in(std::size_t index);
  void scan();
  bool remove_if_gone(Member& member);
  void drop(const Member& member, std::uint32_t why);
  void release(Member& member, std::int64_t now, std::uint64_t steps);
  void wake(std::span<Member* const> group);
  bool run_turn(std::span<Member*> group, std::int64_t now, std::uint64_t steps);
  void end_phase();
  bool observes(std::size_t index) const { return options.is_lockstep && load(slot_at(segment, index).observes) == observer; }
  bool is_tool(std::size_t index) const { return load(slot_at(segment, index).observes) != takes_part; }
  void let_look(std::int64_t now, std::uint64_t steps);
  void remove_gone();
  bool wait_for(std::span<Member*> group);
  bool look_for_end(std::span<Member*> group, nanoseconds limit) const;
  bool all_done(std::span<Member*> group) const {
    return std::all_of(group.begin(), group.end(), [this](const Member* m) { return m->owner == 0 || is_done(*m); });
  }
  // Of those who have no tick: they look for their next one.
  std::size_t count_awake() const {
    return static_cast<std::size_t>(std::ranges::count_if(members, [this](const Member& m) { return load(slot(m).sleeping) == awake; }));
  }
  // Between ticks.
  void look_for_processors() {
    if (const auto now = steady_clock::now(); free.is_due(now)) free.look(now, count_awake());
  }
  void wake_ahead(std::int64_t step);
  void learn_ahead(std::span<Member* const> group);
  void look_for_hangs(std::span<Member*> group, nanoseconds waited);
};

Barrier::Barrier(IfaceWriter& simulation, Server& server, BarrierOptions options)
    : state_(std::make_unique<State>(simulation.segment(), server, std::move(options))) {
  server.watch().on_death([&segment = state_->segment] {
    wake_server(control_of(segment));
    call_attention(segment);
  });
}

Barrier::~Barrier() {
  state_->server.watch().on_death({});
  store(state_->segment.header().state, static_cast<std::uint32_t>(RTMSIM_STATE_CLOSED));
  for (const auto& member : state_->members) wake_participant(state_->control(), member.index);
}

void Barrier::State::schedule_all() {
  earliest_due = earliest_turn = earliest_part = longest_period;
  for (const Member& member : members) {
    earliest_due = std::min(earliest_due, member.next_due);
    if (!member.observes) earliest_turn = std::min(earliest_turn, member.next_due);
    if (!member.is_tool) earliest_part = std::min(earliest_part, member.next_due);
  }
}

// Who has lost its place while a tick ran.
void Barrier::State::remove_gone() {
  if (std::exchange(has_gone, false)) std::erase_if(members, [](const Member& member) { return member.owner == 0; });
  schedule_all();
}

void Barrier::State::take_in(std::size_t index) {
  ParticipantSlot& slot = slot_at(segment, index);
  Member member;
  member.index = index;
  member.owner = load(slot.owner);
  member.name = name_of(slot);
  member.phase = slot.phase;
  member.turn = slot.turn;
  member.period = load(slot.period_ns);
  member.observes = observes(index);
  member.is_tool = is_tool(index);
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
      std::upper_bound(members.begin(), members.end(), member, [](const Member& a, const Member& b) { return a.order() < b.order(); });
  tell(BarrierEvent::Kind::joined, *members.insert(place, std::move(member)));
}

// True, with the slot freed, when the participant has left, died or lost its slot.
bool Barrier::State::remove_if_gone(Member& member) {
  ParticipantSlot& mine = slot(member);
  if (member.watched->is_dead()) {
    const bool was_in_tick = is_ticking && !is_done(member);
    free_slot(mine, member.owner);
    tell(BarrierEvent::Kind::died, member, was_in_tick);
    return true;
  }
  if (load(mine.owner) == member.owner && load(mine.state) == RTMSIM_PARTICIPANT_ACTIVE) return false;
  if (load(mine.owner) == member.owner) free_slot(mine, member.owner);
  tell(BarrierEvent::Kind::left, member);
  return true;
}

void Barrier::State::scan() {
  std::erase_if(members, [this](Member& member) { return remove_if_gone(member); });
  std::vector<bool> is_member(slot_count(segment), false);
  for (const Member& member : members) is_member[member.index] = true;
  for (std::size_t i = 0; i < slot_count(segment); ++i) {
    ParticipantSlot& slot = slot_at(segment, i);
    const std::uint64_t owner = load(slot.owner);
    if (owner == 0) continue;
    const std::uint32_t state = load(slot.state);  // pairs with the release in Participant::join
    if (state == RTMSIM_PARTICIPANT_JOINING) {
      take_in(i);
    } else if (!is_member[i]) {
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
    if (load(slot(*member).sleeping, std::memory_order_seq_cst) == awake) continue;  // pairs with the store in Participant::wait
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
  // Several need the processors themselves.
  SpinLimit& spin = spins[group.front()->phase];
  const bool may_spin = free.are_there_for(group.size());
  const auto began = may_spin ? steady_clock::now() : steady_clock::time_point();
  if (may_spin && look_for_end(group, spin.next())) return spin.took(steady_clock::now() - began), true;
  const auto let_go = [&] {
    for (Member* member : group) {
      if (member->owner != 0 && !is_done(*member) && remove_if_gone(*member)) member->owner = 0;
    }
  };
  while (true) {
    const std::uint32_t seen = load(shared.server_word, std::memory_order_seq_cst);
    if (const std::uint64_t deaths_now = server.watch().deaths(); deaths_now != deaths) {
      deaths = deaths_now;
      let_go();
    }
    if (all_done(group)) break;
    if (const auto called = load(shared.attention, std::memory_order_seq_cst); called != seen_attention) {
      seen_attention = called;
      if (options.on_waiting && !options.on_waiting()) return false;
    }
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
  if (may_spin) spin.took(steady_clock::now() - began);
  store(shared.server_waiting, 0U, std::memory_order_relaxed);
  return true;
}

// The ends of ticks that are over before a sleep and the waking from it would be. False: it takes longer, or somebody asks for something.
bool Barrier::State::look_for_end(std::span<Member*> group, nanoseconds limit) const {
  for (const auto end = steady_clock::now() + limit; !all_done(group);) {
    if (steady_clock::now() >= end || load(control().attention) != seen_attention) return false;
    give_way();
  }
  for (Member* member : group) member->is_hanging = false;
  return true;
}

// Those who are due first are woken while the last steps before are still made, and are there when their tick begins.
void Barrier::State::wake_ahead(std::int64_t step) {
  if (std::exchange(has_looked_ahead, true)) return;
  due.clear();
  for (Member& member : members) {
    if (!due.empty() && member.order() != due[0]->order()) break;
    if (member.next_due < earliest_turn + step && !member.observes) due.push_back(&member);
  }
  look_for_processors();
  if (due.empty() || !free.are_there_for(due.size())) return;
  for (const Member* member : due) {
    std::uint32_t expected = asleep;
    word(slot(*member).sleeping).compare_exchange_strong(expected, called, std::memory_order_seq_cst);
  }
  wake(due);
  woken_ahead = steady_clock::now();
}

void Barrier::State::learn_ahead(std::span<Member* const> group) {
  has_looked_ahead = false;
  const auto woken = std::exchange(woken_ahead, std::nullopt);
  if (!woken) {
    free.look(steady_clock::now());
    return ahead.began();
  }
  ahead.began(steady_clock::now() - *woken,
              std::all_of(group.begin(), group.end(), [this](const Member* m) { return load(slot(*m).sleeping) == awake; }));
}

// Of a phase in which nobody was due nothing is counted.
void Barrier::State::end_phase() {
  if (phase_counter % 2 == 1) advance_phase_counter();
}

bool Barrier::State::run_turn(std::span<Member*> group, std::int64_t now, std::uint64_t steps) {
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
  if (phase_counter % 2 == 0) advance_phase_counter();  // the first turn of its phase
  // Who has died in an earlier turn of this tick did not die in its own.
  for (Member* member : group) {
    if (server.watch().deaths() != seen_deaths && member->watched->is_dead() && remove_if_gone(*member)) member->owner = 0;
  }
  store(control().pending, static_cast<std::int32_t>(group.size()), std::memory_order_seq_cst);
  for (Member* member : group) {
    if (member->owner != 0) release(*member, now, steps);
  }
  wake(group);
  return wait_for(group);
}

// Their wake costs the server one system call, and what they do nothing as long as a processor is free.
void Barrier::State::let_look(std::int64_t now, std::uint64_t steps) {
  due.clear();
  for (Member& member : members) {
    if (member.owner != 0 && member.next_due <= now && member.observes) due.push_back(&member);
  }
  if (due.empty()) return;
  is_looked_at = true;
  store(control().pending, static_cast<std::int32_t>(due.size()), std::memory_order_seq_cst);
  for (Member* member : due) {
    member->is_looking = true;
    release(*member, now, steps);
  }
  wake(due);
}

bool Barrier::settle() {
  State& state = *state_;
  if (!std::exchange(state.is_looked_at, false)) return true;
  state.due.clear();
  for (State::Member& member : state.members) {
    if (std::exchange(member.is_looking, false)) state.due.push_back(&member);
  }
  if (state.due.empty()) return true;
  state.is_ticking = true;
  const bool is_complete = state.wait_for(state.due);
  state.is_ticking = false;
  for (const auto* member : state.due) state.has_gone = state.has_gone || member->owner == 0;
  state.remove_gone();
  return is_complete;
}

bool Barrier::tick(nanoseconds now, std::uint64_t steps) {
  State& state = *state_;
  refresh();
  const std::int64_t step = now.count() - std::exchange(state.last_now, now.count());
  if (state.options.is_lockstep && now.count() < state.earliest_turn && now.count() + step * state.ahead.steps() >= state.earliest_turn)
    state.wake_ahead(step);
  if (now.count() < state.earliest_due) return true;
  if (!settle()) return false;
  state.look_for_processors();
  for (State::Member& member : state.members) {
    member.observes = state.observes(member.index);
    member.is_tool = state.is_tool(member.index);
  }
  std::size_t begin = 0;
  bool is_complete = true, has_begun = false;
  state.is_ticking = true;
  while (begin < state.members.size() && is_complete) {
    const auto order = state.members[begin].order();
    std::size_t end = begin;
    state.due.clear();
    for (; end < state.members.size() && state.members[end].order() == order; ++end) {
      State::Member& member = state.members[end];
      if (member.owner != 0 && member.next_due <= now.count() && !member.observes) state.due.push_back(&member);
    }
    const std::span<State::Member*> group(state.due);
    if (!group.empty() && !std::exchange(has_begun, true)) state.learn_ahead(group);
    if (!group.empty()) is_complete = state.run_turn(group, now.count(), steps);
    if (!is_complete || end == state.members.size() || state.members[end].phase != order.first) state.end_phase();
    for (const auto* member : group) state.has_gone = state.has_gone || member->owner == 0;
    begin = end;
  }
  state.is_ticking = false;
  if (is_complete) state.let_look(now.count(), steps);
  state.remove_gone();
  return is_complete;
}

std::optional<nanoseconds> Barrier::next_due() const {
  if (state_->members.empty()) return std::nullopt;
  return nanoseconds(state_->earliest_due);
}

std::optional<bool> Barrier::has_turn(nanoseconds now) {
  refresh();
  if (std::ranges::all_of(state_->members, &State::Member::is_tool)) return std::nullopt;
  return now.count() >= state_->earliest_part;
}

void Barrier::rewind(nanoseconds now, std::uint32_t resets) {
  state_->resets = resets;
  state_->last_now = now.count() - 1;
  for (auto& member : state_->members) member.next_due = multiple_from(now.count(), member.period);
  state_->schedule_all();
}

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
  state.remove_gone();
  return true;
}

std::vector<ParticipantRecord> Barrier::records() const { return read_records(state_->segment); }

}  // namespace shm
