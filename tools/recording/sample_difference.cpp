#include "recording/sample_difference.h"

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

std::optional<std::string> differ(const DifferenceOptions& options, const std::string& place, const Json& a, const Json& b);

std::optional<std::string> one_alone(const std::string& place) { return place + ": exists in one of them only"; }

std::optional<std::string> objects_differ(const DifferenceOptions& options, const std::string& place, const Json& a, const Json& b) {
  for (auto one = a.begin(), other = b.begin(); one != a.end() || other != b.end(); ++one, ++other) {
    const std::string member = place_of(place, one != a.end() ? one.key() : other.key());
    if (one == a.end() || other == b.end() || one.key() != other.key()) return one_alone(member);
    if (auto what = differ(options, member, *one, *other)) return what;
  }
  return std::nullopt;
}

std::optional<std::string> arrays_differ(const DifferenceOptions& options, const std::string& place, const Json& a, const Json& b) {
  const auto element = [&](std::size_t i) { return place + "[" + std::to_string(i) + "]"; };
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (a[i] == b[i]) continue;
    if (auto what = differ(options, element(i), a[i], b[i])) return what;
  }
  return a.size() == b.size() ? std::nullopt : one_alone(element(std::min(a.size(), b.size())));
}

std::optional<std::string> differ(const DifferenceOptions& options, const std::string& place, const Json& a, const Json& b) {
  if (a.is_object() && b.is_object()) return objects_differ(options, place, a, b);
  if (a.is_array() && b.is_array()) return arrays_differ(options, place, a, b);
  if (a.is_structured() || b.is_structured()) return one_alone(place);
  if (a == b || json_text(a) == json_text(b)) return std::nullopt;
  if (std::ranges::any_of(options.ignored, [&](const std::string& one) { return holds(one, place); })) return std::nullopt;
  if (is_near(options, place, a, b)) return std::nullopt;
  return place + ": " + json_text(a) + " and " + json_text(b);
}

}  // namespace

std::optional<std::string> difference(const DifferenceOptions& options, const Json& first, const Json& second) {
  return differ(options, "", first, second);
}

base::Result<std::pair<std::string, double>> parse_tolerance(const std::string& text) {
  const auto equals = text.rfind('=');
  const auto number = base::parse_number(equals == std::string::npos ? text : text.substr(equals + 1));
  if (!number || !(*number >= 0) || equals == 0)
    return base::Error{"tolerance " + base::in_quotes(text) + ": expected MEMBER=NUMBER or NUMBER"};
  return std::pair(equals == std::string::npos ? std::string() : text.substr(0, equals), *number);
}

}  // namespace recorder
