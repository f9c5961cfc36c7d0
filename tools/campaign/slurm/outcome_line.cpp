#include "campaign/slurm/outcome_line.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace campaign {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string to_line(const OutcomeLine& line) {
  const auto& outcome = line.outcome;
  Json json{{"key", line.key},       {"problem", outcome.problem},       {"state", outcome.state_hash},
            {"folder", line.folder}, {"simulated", outcome.simulated_s}, {"wall", outcome.wall_s},
            {"logs", outcome.logs},  {"measures", Json::object()},       {"verdicts", Json::array()}};
  for (const auto& [name, value] : outcome.measures) json["measures"][name] = value;
  for (const auto& verdict : outcome.verdicts) json["verdicts"].push_back({verdict.expectation, verdict.problem, verdict.details});
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<OutcomeLine> from_line(const std::string& text) {
  const auto json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  try {
    OutcomeLine line;
    auto& outcome = line.outcome;
    json.at("key").get_to(line.key);
    json.at("folder").get_to(line.folder);
    json.at("problem").get_to(outcome.problem);
    json.at("state").get_to(outcome.state_hash);
    json.at("simulated").get_to(outcome.simulated_s);
    json.at("wall").get_to(outcome.wall_s);
    json.at("logs").get_to(outcome.logs);
    json.at("measures").get_to(outcome.measures);
    for (const auto& verdict : json.at("verdicts"))
      outcome.verdicts.push_back({verdict.at(0).get<std::string>(), verdict.at(1).get<std::string>(), verdict.at(2).get<std::string>()});
    return line;
  } catch (const Json::exception&) {  // of another version
    return std::nullopt;
  }
}

}  // namespace campaign
