// The tick of a lock step that runs on this thread: its time, its phase counter, and the data that passes in it. An execution context on
// simulated time puts a ScopedTick around the callbacks. The thread of the tick only.
//
// Rule of delivery: data that is written at phase counter m (odd while a phase runs) can be read only when the counter is above m. Readers
// of higher phases see it in the same tick, readers of the same phase and of lower phases in their next tick. The order of threads within a
// phase makes no difference.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

namespace base {

inline constexpr bool is_in_phase(std::uint64_t phase_counter) { return phase_counter % 2 == 1; }

// A sample on its way through a port.
struct Passage {
  bool is_out = false;                                 // of an OutPort, by a write; else of an InPort, by a read
  std::string_view port;                               // with the name of its component
  std::string_view type;                               // of the data
  std::span<const std::span<const std::byte>> octets;  // encoded
  // Where a hash for passed_again() goes; it stays empty when the octets are as fast.
  std::optional<std::uint64_t>* hash = nullptr;
};

class Tick {
 public:
  virtual ~Tick() = default;
  virtual std::chrono::nanoseconds time() const = 0;  // simulated
  // The phase counter; 0 if time does not wait for the tick.
  virtual std::uint64_t phase_counter() const = 0;
  // `work` is called when the callbacks are over, still within the tick, on its thread; several in the order in which they came. It may ask
  // for the end of the next tick again.
  virtual void at_end(std::function<void(Tick&)> work) = 0;
  // False: nobody wants to hear of data.
  virtual bool keeps_data() const = 0;
  virtual void passed(const Passage& passage) = 0;
  // The same data as `hash` is of, without its octets: they need not be encoded and looked at again. False: they are wanted.
  virtual bool passed_again(const Passage& passage, std::uint64_t hash) = 0;
};

// nullptr: this thread is in no tick.
Tick* current_tick();
// Only where time waits for it.
Tick* tick_in_lock_step();

class ScopedTick {
 public:
  explicit ScopedTick(Tick& tick);
  ~ScopedTick();
  ScopedTick(const ScopedTick&) = delete;
  ScopedTick& operator=(const ScopedTick&) = delete;

 private:
  Tick* previous_;
};

// For its life this thread is in no tick: for calls to a servant, which in the same process are made on the caller's thread and shall be
// like those from another process.
class OutsideTicks {
 public:
  OutsideTicks();
  ~OutsideTicks();
  OutsideTicks(const OutsideTicks&) = delete;
  OutsideTicks& operator=(const OutsideTicks&) = delete;

 private:
  Tick* previous_;
};

}  // namespace base
