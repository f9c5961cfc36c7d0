// The events and faults of a recorded run, done again in another one (ActionRunner::written()). One thread at a time; see run/run_script.h.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "campaign/run/action_runner.h"
#include "run/run_script.h"

namespace campaign {

class ActionScript final : public tools::RunScript {
 public:
  // `file`: what was written. Fails as read_plan() does.
  static Result<std::unique_ptr<ActionScript>> read(const std::string& file);
  explicit ActionScript(const Plan& plan)
      : actions_({plan.events, plan.faults, {}, {}}, plan.seed, plan.run.duration_s), watched_(actions_.watched()) {}

  std::vector<std::string> simulator_options() const { return actions_.simulator_options(); }
  const std::vector<tools::Expectation>& watched() const override { return watched_; }
  tools::Result<void> begin(tools::RunScene& scene) override { return actions_.begin(scene); }
  std::optional<std::int64_t> next_stop(std::int64_t done) const override { return actions_.next_stop(done); }
  tools::Result<void> act(tools::RunScene& scene, std::int64_t done) override { return actions_.act(scene, done); }
  bool excuses(const std::string& instance) const override { return actions_.excuses(instance); }
  std::string written() const override { return actions_.written(); }
  void end(tools::RunScene*, const tools::Seen&, tools::RunResult&) override {}

 private:
  ActionRunner actions_;
  std::vector<tools::Expectation> watched_;
};

}  // namespace campaign
