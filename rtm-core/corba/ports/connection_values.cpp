#include "corba/ports/connection_values.h"

#include <algorithm>

#include "core/connector_settings.h"

namespace corba {

std::vector<std::string> misunderstood_values(const std::map<std::string, std::string>& properties) {
  const rt::KeyValues values(properties.begin(), properties.end());
  auto lines = rt::read_connector_settings(values, rt::Side::out).warnings;
  for (auto& line : rt::read_connector_settings(values, rt::Side::in).warnings) {
    if (std::ranges::find(lines, line) == lines.end()) lines.push_back(std::move(line));
  }
  return lines;
}

std::string refusal_of_values(const std::map<std::string, std::string>& properties) {
  const rt::KeyValues values(properties.begin(), properties.end());
  const auto refusal = rt::read_connector_settings(values, rt::Side::out).refusal;
  return refusal.code == rt::ReturnCode::ok ? rt::read_connector_settings(values, rt::Side::in).refusal.reason : refusal.reason;
}

}  // namespace corba
