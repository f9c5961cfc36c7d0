#include "run/verdict_time.h"

#include <algorithm>
#include <cmath>

namespace tools {
namespace {

using Kind = Expectation::Kind;
using Poses = std::vector<RecordedPose>;

std::optional<double> first_outside(const Expectation& expectation, const Poses& poses) {
  for (const auto& pose : poses) {
    if (expectation.condition.shortfall(values_at(pose)).value() > 0) return pose.time;
  }
  return std::nullopt;
}

std::optional<double> first_contact(const Expectation& expectation, const std::vector<RecordedContact>& contacts) {
  for (const auto& contact : contacts) {
    if (contact.model != expectation.model && contact.other != expectation.model) continue;
    const auto& other = contact.model == expectation.model ? contact.other : contact.model;
    if (std::ranges::find(expectation.except, other) == expectation.except.end()) return contact.time;
  }
  return std::nullopt;
}

std::optional<double> path_too_long(const Expectation& expectation, const Poses& poses) {
  if (!expectation.max) return std::nullopt;
  double length = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    length += path_length({poses[i - 1], poses[i]});
    if (length > *expectation.max) return poses[i].time;
  }
  return std::nullopt;
}

std::optional<double> first_violation(const Expectation& expectation, const Seen& seen) {
  const auto value = seen.values.find(expectation.port + " " + expectation.member);
  if (value == seen.values.end()) return std::nullopt;
  const auto found = value->second.violated_at.find(expectation.text);
  return found != value->second.violated_at.end() && std::isfinite(found->second) ? std::optional(found->second) : std::nullopt;
}

}  // namespace

std::optional<double> failure_time(const Expectation& expectation, const Seen& seen) {
  const auto found = seen.record.poses.find(expectation.model);
  const auto& poses = found == seen.record.poses.end() ? Poses() : found->second;
  switch (expectation.kind) {
    case Kind::stay:
      return first_outside(expectation, poses);
    case Kind::reach:
      return expectation.within > 0 ? std::optional(expectation.within) : std::nullopt;
    case Kind::no_contact:
      return first_contact(expectation, seen.record.contacts);
    case Kind::path_length:
      return path_too_long(expectation, poses);
    case Kind::value:
      return first_violation(expectation, seen);
    default:
      return std::nullopt;
  }
}

std::string failed_object(const Expectation& expectation) {
  if (!expectation.model.empty()) return expectation.model;
  if (!expectation.component.empty()) return expectation.component;
  // "/host/A0.rtc:out", "A0:out" -> "A0".
  const auto path = expectation.port.substr(0, expectation.port.rfind(':'));
  const auto name = path.substr(path.rfind('/') + 1);
  return name.ends_with(".rtc") ? name.substr(0, name.size() - 4) : name;
}

}  // namespace tools
