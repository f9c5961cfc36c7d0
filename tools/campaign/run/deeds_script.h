// The events and faults of a recorded run, done again in another one (DeedsRunner::written()). One thread at a time; see run/run_script.h.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "campaign/run/deeds_runner.h"
#include "run/run_script.h"

namespace campaign {

class DeedsScript final : public tools::RunScript {
 public:
  // `file`: what was written. Fails as read_plan() does.
  static Result<std::unique_ptr<DeedsScript>> read(const std::string& file);
  explicit DeedsScript(const Plan& plan)
      : deeds_({plan.events, plan.faults, {}, {}}, plan.seed, plan.run.duration_s), watched_(deeds_.watched()) {}

  std::vector<std::string> simulator_options() const { return deeds_.simulator_options(); }
  const std::vector<tools::Expectation>& watched() const override { return watched_; }
  tools::Result<void> begin(tools::RunScene& scene) override { return deeds_.begin(scene); }
  std::optional<std::int64_t> next_stop(std::int64_t done) const override { return deeds_.next_stop(done); }
  tools::Result<void> act(tools::RunScene& scene, std::int64_t done) override { return deeds_.act(scene, done); }
  bool excuses(const std::string& instance) const override { return deeds_.excuses(instance); }
  std::string written() const override { return deeds_.written(); }
  void end(tools::RunScene*, const tools::Seen&, tools::RunResult&) override {}

 private:
  DeedsRunner deeds_;
  std::vector<tools::Expectation> watched_;
};

}  // namespace campaign
