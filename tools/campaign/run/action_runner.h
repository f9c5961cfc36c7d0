// Executes the events and faults of a run at their steps, and evaluates conditions. One thread at a time; see
// run/run_script.h.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "campaign/plan/plan.h"
#include "run/run_script.h"

namespace campaign {

struct Actions {
  std::vector<Event> events = {};
  std::vector<Fault> faults = {};
  std::vector<Condition> never = {}, eventually = {};
};

class ActionRunner {
 public:
  // `seed`: of the run; random faults draw from it.
  ActionRunner(Actions actions, std::uint64_t seed, double duration_s);

  // Faults of components and connections that are properties of what is created.
  Result<void> alter(tools::SavedSystem& system) const;
  std::vector<std::string> properties() const;
  // A plan with what the run does that neither the system nor the properties of its components say; empty: nothing.
  std::string written() const;
  // For sim-server: faults of sensors and drives, which it times itself.
  std::vector<std::string> simulator_options() const;
  // Ports that conditions are about.
  std::vector<tools::Expectation> watched() const;

  Result<void> begin(tools::RunScene& scene);
  std::optional<std::int64_t> next_stop(std::int64_t done) const;
  Result<void> act(tools::RunScene& scene, std::int64_t done);
  bool excuses(const std::string& instance) const;
  // Of never and eventually.
  std::vector<tools::Verdict> verdicts() const;
  // Faults, and events that happened, in no order.
  std::vector<tools::RunMark> marks() const;
  // What did nothing, and why: each once.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct Timed {
    std::int64_t step = 0;
    enum class What { event, fault, end_of_fault } what = What::event;
    std::size_t place = 0;
  };
  Result<void> carry_out(tools::RunScene& scene, const Timed& timed);
  Result<void> happen(tools::RunScene& scene, const Event& event);
  Result<void> start_fault(tools::RunScene& scene, std::size_t place);
  Result<void> end_fault(tools::RunScene& scene, std::size_t place);
  Result<void> restart(tools::RunScene& scene, const std::string& instance);
  void note(const std::string& text);
  Result<void> look(tools::RunScene& scene, double now_s);
  Result<bool> is_true(tools::RunScene& scene, const Condition& condition, double now_s);
  bool polls() const;

  Actions actions_;
  std::uint64_t seed_;
  double duration_s_;
  double step_s_ = 0.001;
  std::int64_t look_every_ = 100;  // steps
  std::vector<Timed> timed_;       // by step
  std::size_t next_ = 0;
  std::map<std::size_t, double> happened_;   // event on a condition -> when [s]
  std::map<std::size_t, double> broken_;     // never -> when [s]
  std::map<std::size_t, double> fulfilled_;  // eventually -> when [s]
  std::set<std::size_t> killed_;             // faults that killed a host which is not there again
  std::set<std::string> away_;               // components of such hosts
  std::vector<std::string> late_;            // whose host starts again when the naming service is back
  int naming_gone_ = 0;                      // faults that keep it away
  std::vector<std::string> notes_;
};

// Whether the world has no such model, or none that a link's name begins with. False, too, when the simulator does not answer.
bool is_missing(const tools::RunScene& scene, const std::string& model);
// One event, now. A text: why it did nothing.
Result<std::string> carry_out_event(tools::RunScene& scene, const Event& event);

}  // namespace campaign
