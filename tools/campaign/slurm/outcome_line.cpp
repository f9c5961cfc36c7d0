#include "campaign/slurm/outcome_line.h"

#include <nlohmann/json.hpp>

namespace campaign {

using Json = nlohmann::ordered_json;

std::string to_line(const OutcomeLine& line) {
  const Json json{{"key", line.key}, {"folder", line.folder}, {"run", to_json(line.outcome.run)}, {"measures", line.outcome.measures}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<OutcomeLine> from_line(const std::string& text) {
  const auto json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  try {
    OutcomeLine line;
    json.at("key").get_to(line.key);
    json.at("folder").get_to(line.folder);
    line.outcome.run = tools::run_result_of(json.at("run"));
    line.outcome.run.has_begun = true;  // a row that did not begin has no line
    json.at("measures").get_to(line.outcome.measures);
    return line;
  } catch (const Json::exception&) {  // of another version
    return std::nullopt;
  }
}

}  // namespace campaign
