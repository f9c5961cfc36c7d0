// Injected faults: of a component by its property `fault.on_execute`, of a connection by dataport.fault. The text of a fault is that of
// base/fault_text.h with a seed as LAST; blanks separate faults. Times are those of the component's clock. Values; any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "base/guarded.h"
#include "base/result.h"
#include "core/sample.h"

namespace rt {

struct Fault {
  enum class Kind { error, exception, slow, hang, drop, delay, duplicate, reorder };
  Kind kind = Kind::error;
  std::chrono::nanoseconds from{}, until{};
  double amount = 0;  // slow: seconds; delay: samples; else a probability
  std::uint64_t seed = 0;
  bool is_at(std::chrono::nanoseconds now) const { return now >= from && now < until; }
};

// The error names the text and what was expected.
base::Result<std::vector<Fault>> parse_faults(std::string_view text);

// What a faulty connection makes of what is written to it. The same samples at the same times have the same fate, chosen by the seeds.
class FaultyLink {
 public:
  explicit FaultyLink(std::vector<Fault> faults) : faults_(std::move(faults)) {}
  // What goes out now in its place, the first first. Any thread.
  std::vector<Sample> pass(Sample sample, std::chrono::nanoseconds now);

 private:
  struct State {
    std::deque<Sample> held;   // delayed
    std::deque<Sample> later;  // go after the next one
    std::uint64_t count = 0;   // samples so far
  };
  void delay(State& state, std::chrono::nanoseconds now, std::vector<Sample>& out) const;
  const std::vector<Fault> faults_;
  base::Guarded<State, base::Rank::details> state_;
};

}  // namespace rt
