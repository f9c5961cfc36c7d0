#include "campaign/run/row_script.h"

#include <algorithm>
#include <cmath>

#include "campaign/run/measures.h"

namespace campaign {

RowScript::RowScript(const Campaign& campaign, const Row& row, RowScriptOptions options)
    : campaign_(campaign),
      row_(row),
      options_(std::move(options)),
      actions_(options_.actions, row.seed, options_.duration_s),
      watched_(watched_values(campaign.plan().measures)) {
  for (auto& watched : actions_.watched()) watched_.push_back(std::move(watched));
  if (!options_.checks_invariants) return;
  for (const auto& connector : campaign.system().connectors) {
    if (!connector.is_data || connector.has_one_port()) continue;  // which may be an InPort
    const auto& name = connector.source.port_name;
    const auto port = connector.source.instance + ":" + name.substr(name.find('.') + 1);
    if (std::ranges::find(invariant_ports_, port) != invariant_ports_.end()) continue;
    invariant_ports_.push_back(port);
    tools::Expectation all;  // an empty member: every number
    all.kind = tools::Expectation::Kind::value;
    all.port = port;
    watched_.push_back(std::move(all));
  }
}

tools::Result<void> RowScript::alter(tools::SavedSystem& system) {
  if (const auto altered = campaign_.alter(system, row_); !altered) return altered;
  return actions_.alter(system);
}

void RowScript::end(tools::RunScene* scene, const tools::Seen& seen, tools::RunResult& result) {
  if (scene && result.problem.empty()) {
    for (auto& verdict : actions_.verdicts()) result.verdicts.push_back(std::move(verdict));
    for (const auto& port : invariant_ports_) {
      const auto value = seen.values.find(port + " ");
      const auto count = value == seen.values.end() ? 0 : value->second.not_numbers;
      result.verdicts.push_back({"no NaN from " + port, count == 0 ? "" : std::to_string(count) + " numbers were NaN"});
    }
    for (const auto& watched : watched_) {
      const auto value = seen.values.find(watched.port + " " + watched.member);
      if (value == seen.values.end() || value->second.samples > 0 || value->second.problem.empty() || watched.member.empty()) continue;
      result.verdicts.push_back({watched.port + " has " + watched.member, value->second.problem});
    }
    measures_ = take_measures(campaign_.plan().measures, seen, placed_models(row_, campaign_.models()), 0);
  }
  result.marks = actions_.marks();
  result.notes.insert(result.notes.end(), actions_.notes().begin(), actions_.notes().end());
  add_features(seen);
  if (!scene || !options_.draws || result.is_passed()) return;
  // A picture that cannot be drawn takes nothing from the verdict.
  constexpr std::uint32_t picture_size = 480;  // [pixels]
  static_cast<void>(scene->simulator.screenshot(options_.folder + "/picture.png", picture_size));
}

void RowScript::add_features(const tools::Seen& seen) {
  constexpr double cell = 0.5;  // [m]
  for (const auto& [component, state] : seen.states) features_.insert(component + " " + state);
  for (const auto& [model, poses] : seen.record.poses) {
    for (const auto& pose : poses)
      features_.insert(model + " " + std::to_string(std::lround(pose.x / cell)) + " " + std::to_string(std::lround(pose.y / cell)));
  }
  const auto bucket = [](double value) {
    if (std::isnan(value) || value == 0) return std::string("0");
    return std::string(value < 0 ? "-" : "+") +
           std::to_string(std::isinf(value) ? 999 : static_cast<int>(std::floor(std::log2(std::abs(value)))));
  };
  for (const auto& [name, value] : seen.values)
    features_.insert(name + " " + bucket(value.lowest) + " " + bucket(value.highest) + " " + bucket(static_cast<double>(value.samples)));
}

}  // namespace campaign
