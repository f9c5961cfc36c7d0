// rtse run: a whole system of processes, started from a profile, run in lock step with a simulated world, judged, and ended without
// remains. One thread at a time.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "run/expectations.h"
#include "run/run_options.h"
#include "system/profile/rts_profile.h"
#include "system/session.h"

namespace tools {

class Reporter;
class RunScript;
class PreforkServers;

// A system that is wired and active and stands before its first step, in the hands of who drives it.
class RunningSystem {
 public:
  struct Process {
    std::string what;  // "sim-server", "rtcd of A, B"
    pid_t pid = 0;
  };
  virtual ~RunningSystem() = default;
  virtual const std::string& naming() const = 0;     // HOST:PORT
  virtual const std::string& simulator() const = 0;  // its id
  virtual double step() const = 0;                   // [s]
  virtual std::vector<Process> processes() const = 0;
  // As fast as it can. Fails when a process has ended or hangs, after an interrupt, and when another client pauses the simulation.
  virtual Result<void> make_steps(std::int64_t steps) = 0;
};

// What a program adds to a run that it makes itself.
struct RunHooks {
  std::vector<std::string> simulator_options{};  // more words for sim-server
  const PreforkServers* prefork = nullptr;       // that make what is started; null: everything is started alone
  RunScript* script = nullptr;                   // see run_script.h; null: nothing happens but the run
  // Makes the steps instead of the run; nothing is judged then.
  std::function<Result<void>(RunningSystem&)> driver{};
  std::function<void()> recording{};  // the file of the recording is there, and grows from now on
};

// What happened in a run at a time, for the time line of its page.
struct RunMark {
  double time = 0;   // [simulated s]
  std::string kind;  // "event", "fault", "restored"
  std::string text;
  std::string subject = {};  // the model or component; empty: none
};

struct RunResult {
  std::uint64_t seed = 0;
  // Nothing was run, because what was asked for does not fit: the system or its options, or the file of expectations.
  enum class Refusal { none, system, expectations } refusal = Refusal::none;
  bool has_begun = false;          // its naming service and its simulator were there: what came then is its own
  std::string problem;             // why the system could not be started or run to the end; empty: it was
  std::string logs;                // last lines of all processes, when there was a problem
  std::vector<std::string> notes;  // what is not as the world's file says
  std::vector<Verdict> verdicts;
  std::vector<RunMark> marks;  // what a script did; not in JSON
  std::string page;            // HTML of the run; empty: none was wanted, or it could not be written
  std::string state_hash;
  std::string run_hash;    // of the hash log
  int runs = 1;            // 2 with --twice
  double simulated_s = 0;  // in each of them
  double wall_s = 0;       // of all
  double path_m = 0;       // of the model that went farthest
  bool is_passed() const { return first_problem().empty(); }
  // The first thing that was not as expected; empty: nothing.
  std::string first_problem() const;
};

// Returns when everything that it started has ended. catch_interrupts() first: an interrupt is a problem like others. `reporter` receives
// what takes long, what failed beside the first problem, and the progress.
RunResult run_system(CORBA::ORB_ptr orb, const RunOptions& options, Reporter& reporter, const RunHooks& hooks = {});

// For other programs: rtse run --json prints it, and reads what it has started prints. Throws what nlohmann::json throws for members of
// another type; members that are missing have the values of a new RunResult.
nlohmann::ordered_json to_json(const RunResult& result);
RunResult run_result_of(const nlohmann::ordered_json& json);
// The verdicts as JUnit XML: a test case for each run and for each of its expectations; a run with a problem is an error.
Result<void> write_junit(const std::string& file, const RunOptions& options, const std::vector<RunResult>& results);

}  // namespace tools
