#include "sample_difference.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace recorder {

namespace {

// "data" is, or holds, "data.vx" and "data[3]".
bool holds(const std::string& member, const std::string& part) {
  return member.empty() || part == member || (part.starts_with(member) && (part[member.size()] == '.' || part[member.size()] == '['));
}

bool is_near(const DifferenceOptions& options, const std::string& member, const Json& a, const Json& b) {
  if (!a.is_number() || !b.is_number()) return false;
  double tolerance = 0;
  for (const auto& [part, eps] : options.tolerances) {
    if (holds(part, member)) tolerance = std::max(tolerance, eps);
  }
  return std::abs(a.get<double>() - b.get<double>()) <= tolerance;
}

}  // namespace

std::optional<std::string> difference(const DifferenceOptions& options, const Json& first, const Json& second) {
  const auto a = members_of(first);
  const auto b = members_of(second);
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    if (i >= a.size() || i >= b.size() || a[i].first != b[i].first) {
      const std::string& member = i < a.size() ? a[i].first : b[i].first;
      return member + ": is there in one of them only";
    }
    const auto& [member, value] = a[i];
    if (value == b[i].second || value.dump() == b[i].second.dump()) continue;
    if (std::ranges::any_of(options.ignored, [&](const std::string& one) { return holds(one, member); })) continue;
    if (is_near(options, member, value, b[i].second)) continue;
    return member + ": " + value.dump() + " and " + b[i].second.dump();
  }
  return std::nullopt;
}

base::Result<std::pair<std::string, double>> parse_tolerance(const std::string& text) {
  const auto equals = text.rfind('=');
  const auto number = base::parse_number(equals == std::string::npos ? text : text.substr(equals + 1));
  if (!number || !(*number >= 0) || equals == 0)
    return base::Error{"tolerance " + base::in_quotes(text) + ": expected MEMBER=NUMBER or NUMBER"};
  return std::pair(equals == std::string::npos ? std::string() : text.substr(0, equals), *number);
}

}  // namespace recorder
