// Operations of both sides of the lock step on participant slots. Any thread; the states are those of lockstep.h.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "shm/attention.h"
#include "shm/futex.h"
#include "shm/lockstep.h"
#include "shm/process.h"
#include "shm/segment.h"
#include "shm/words.h"

namespace shm {

inline constexpr std::uint32_t max_phase = 15;
inline constexpr std::int64_t longest_period = std::int64_t{1} << 60;

// ParticipantSlot::sleeping.
inline constexpr std::uint32_t awake = 0, asleep = 1, called = 2;

// ParticipantSlot::observes.
inline constexpr std::uint32_t takes_part = 0, observer = 1, waited_tool = 2;

inline ParticipantSlot& slot_at(const Segment& segment, std::size_t index) {
  return segment.as<ParticipantSlot>(AreaIndex::participants, index);
}
inline std::size_t slot_count(const Segment& segment) { return segment.area(AreaIndex::participants).count; }
inline Control& control_of(const Segment& segment) { return segment.as<Control>(AreaIndex::control); }

inline ProcessMark mark_of(const ParticipantSlot& slot) {
  return {owner_pid(load(slot.owner)), load(slot.pid_namespace), load(slot.start_time)};
}

inline std::uint64_t phase_counter_of(const Segment& segment) {
  return load(control_of(segment).moment, std::memory_order_acquire);  // pairs with advance_phase_counter
}

// Whatever a client has written there, it is one line of text for people.
inline std::string name_of(const ParticipantSlot& slot) {
  std::string name(slot.name, strnlen(slot.name, sizeof slot.name));
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return name;
}

inline void free_slot(ParticipantSlot& slot, std::uint64_t owner) {
  store(slot.state, static_cast<std::uint32_t>(RTMSIM_PARTICIPANT_FREE));
  store(slot.start_time, std::uint64_t{0});
  store(slot.observes, takes_part);  // of nobody who does not say so
  word(slot.owner).compare_exchange_strong(owner, 0, std::memory_order_acq_rel);
}

// False: it did not sleep.
inline bool wake_server(Control& control) {
  word(control.server_word).fetch_add(1, std::memory_order_seq_cst);
  if (load(control.server_waiting, std::memory_order_seq_cst) == 0) return false;  // pairs with Barrier's wait
  futex_wake(control.server_word, 1);
  return true;
}

inline std::uint32_t& tick_word(Control& control, std::size_t index) { return control.tick_words[index / 32 % RTMSIM_TICK_WORDS]; }
constexpr std::uint32_t tick_bit(std::size_t index) { return 1U << index % 32; }

inline void wake_participant(Control& control, std::size_t index) {
  word(tick_word(control, index)).fetch_add(1, std::memory_order_seq_cst);
  futex_wake_bits(tick_word(control, index), tick_bit(index));
}

inline void change_participants(const Segment& segment) {
  word(control_of(segment).participant_epoch).fetch_add(1, std::memory_order_acq_rel);
  call_attention(segment);
}

// Of all participants that are there or joining, by phase.
std::vector<ParticipantRecord> read_records(const Segment& segment);

}  // namespace shm
