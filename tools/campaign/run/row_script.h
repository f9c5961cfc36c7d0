// The hooks of a row in its run. One thread at a time; see run/run_script.h.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "campaign/run/action_runner.h"
#include "campaign/run/campaign.h"
#include "run/run_script.h"

namespace campaign {

struct RowScriptOptions {
  std::string folder;  // for the picture
  Actions actions;
  double duration_s = 0;
  bool checks_invariants = false;
  bool draws = true;
};

class RowScript final : public tools::RunScript {
 public:
  // All must live as long.
  RowScript(const Campaign& campaign, const Row& row, RowScriptOptions options);

  // That components are created with because of faults.
  std::vector<std::string> properties() const { return actions_.properties(); }
  // For sim-server.
  std::vector<std::string> simulator_options() const { return actions_.simulator_options(); }

  tools::Result<void> alter(tools::SavedSystem& system) override;
  const std::vector<tools::Expectation>& watched() const override { return watched_; }
  tools::Result<void> begin(tools::RunScene& scene) override { return actions_.begin(scene); }
  std::optional<std::int64_t> next_stop(std::int64_t done) const override { return actions_.next_stop(done); }
  tools::Result<void> act(tools::RunScene& scene, std::int64_t done) override { return actions_.act(scene, done); }
  bool excuses(const std::string& instance) const override { return actions_.excuses(instance); }
  std::string written() const override { return actions_.written(); }
  void end(tools::RunScene* scene, const tools::Seen& seen, tools::RunResult& result) override;

  const std::map<std::string, double>& measures() const { return measures_; }
  const std::set<std::string>& features() const { return features_; }

 private:
  void add_features(const tools::Seen& seen);

  const Campaign& campaign_;
  const Row& row_;
  RowScriptOptions options_;
  ActionRunner actions_;
  std::vector<std::string> invariant_ports_;
  std::vector<tools::Expectation> watched_;
  std::map<std::string, double> measures_;
  std::set<std::string> features_;
};

}  // namespace campaign
