#include "run/stepping.h"

#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>

#include "base/interrupt.h"
#include "base/text.h"

namespace tools {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto look_period = 100ms;  // at the processes: one that dies is named within it
constexpr auto long_time = 1s;       // without a step: the late participants are named

std::string late_text(Simulator& simulator) { return base::join(late_participants(simulator), ", "); }

std::string wait_text(Simulator& simulator, double time_s, double timeout_s) {
  const auto late = late_text(simulator);
  return (late.empty() ? "the simulator" : late) + ": did not finish its tick at " + base::format_number(time_s) +
         " s for more than a second of real time; waiting up to " + base::format_number(timeout_s) + " s (--hang-timeout)";
}

std::string hang_text(Simulator& simulator, double time_s, double timeout_s) {
  const auto late = late_text(simulator);
  const auto end = " at " + base::format_number(time_s) + " s after " + base::format_number(timeout_s) + " s (--hang-timeout)";
  return late.empty() ? "the simulator did not finish the step" + end : late + ": did not finish its tick" + end;
}

// A process that has exited can be waited for a moment after its shared memory says so.
base::Result<void> with_reason(const base::Error& problem, const std::function<base::Result<void>()>& alive) {
  constexpr auto limit = 300ms, pause = 10ms;
  for (const auto end = Clock::now() + limit; Clock::now() < end; std::this_thread::sleep_for(pause)) {
    if (const auto good = alive(); !good) return good;
  }
  return problem;
}

}  // namespace

base::Result<void> make_steps(Simulator& simulator, std::int64_t steps, const Stepping& stepping) {
  if (const auto begun = simulator.begin_steps(steps, stepping.is_paced); !begun) return begun;
  SimulatedMoment last;
  auto moved = Clock::now();
  bool is_told = false;
  for (;;) {
    const auto done = simulator.await_steps(look_period);
    if (base::is_interrupted()) return base::Error{"run: interrupted"};
    if (const auto good = stepping.alive(); !good) return good;
    if (!done) return with_reason(done.error(), stepping.alive);
    if (*done) return {};
    const auto now = Clock::now();
    if (const auto moment = simulator.now()) {
      if (std::exchange(last, *moment).steps != moment->steps) moved = now;
      stepping.passed(last.time_s);
    }
    if (now - moved > long_time && !std::exchange(is_told, true))
      stepping.warn(base::printable(wait_text(simulator, last.time_s, stepping.hang_timeout_s)));
    if (now - moved > std::chrono::duration<double>(stepping.hang_timeout_s))
      return base::Error{hang_text(simulator, last.time_s, stepping.hang_timeout_s)};
  }
}

}  // namespace tools
