// Checks that the components of a system accept the parameter values of a plan. Only components know the types, so a run is started for it
// and ended before its first step. One thread at a time; see run/run_script.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "campaign/plan/plan.h"
#include "run/run_script.h"

namespace campaign {

class ValueScript final : public tools::RunScript {
 public:
  explicit ValueScript(const Plan& plan);
  // Whether there is anything to ask.
  bool is_needed() const { return !wanted_.empty(); }
  // What a component does not take; empty: it takes all, or has not come so far.
  const std::string& problem() const { return problem_; }

  const std::vector<tools::Expectation>& watched() const override { return watched_; }
  tools::Result<void> begin(tools::RunScene& scene) override;
  std::optional<std::int64_t> next_stop(std::int64_t) const override { return std::nullopt; }
  tools::Result<void> act(tools::RunScene&, std::int64_t) override { return {}; }
  bool excuses(const std::string&) const override { return true; }
  void end(tools::RunScene*, const tools::Seen&, tools::RunResult&) override {}

 private:
  struct Wanted {
    std::string where;  // in the plan
    std::string component, parameter, value;
  };
  std::vector<Wanted> wanted_;
  std::vector<tools::Expectation> watched_;
  std::string problem_;
};

}  // namespace campaign
