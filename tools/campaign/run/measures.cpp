#include "campaign/run/measures.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text.h"

namespace campaign {
namespace {

Eigen::Isometry3d isometry(const tools::RecordedPose& recorded) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(recorded.x, recorded.y, recorded.z);
  pose.linear() = Eigen::Quaterniond(recorded.qw, recorded.qx, recorded.qy, recorded.qz).normalized().toRotationMatrix();
  return pose;
}

// Calls visit(poses of all moving models) for each moment of a record. A model that was deleted keeps its last pose.
template <class Visit>
void for_moments(const tools::PoseRecord& record, Visit visit) {
  std::map<double, std::vector<std::pair<std::string, const tools::RecordedPose*>>> moments;
  for (const auto& [model, poses] : record.poses) {
    for (const auto& pose : poses) moments[pose.time].emplace_back(model, &pose);
  }
  std::map<std::string, Eigen::Isometry3d> poses;
  for (const auto& [time, moved] : moments) {
    for (const auto& [model, pose] : moved) poses[model] = isometry(*pose);
    visit(poses);
  }
}

std::optional<double> clearance(const Measure& measure, const std::map<std::string, SurveyedModel>& models,
                                const tools::PoseRecord& record) {
  const auto mine = models.find(measure.model);
  if (mine == models.end() || mine->second.outline.parts.empty()) return std::nullopt;
  std::vector<std::pair<std::string, std::vector<Polygon>>> standing;
  for (const auto& [name, model] : models) {
    const bool is_meant = measure.to.empty() ? name != measure.model : std::ranges::find(measure.to, name) != measure.to.end();
    if (is_meant && !model.outline.parts.empty()) standing.emplace_back(name, footprint(model.outline, model.pose));
  }
  double least = std::numeric_limits<double>::infinity();
  for_moments(record, [&](const std::map<std::string, Eigen::Isometry3d>& poses) {
    const auto at = poses.find(measure.model);
    const auto shape = footprint(mine->second.outline, at == poses.end() ? mine->second.pose : at->second);
    for (const auto& [name, polygons] : standing) {
      const auto moved = poses.find(name);
      least = std::min(least, distance(shape, moved == poses.end() ? polygons : footprint(models.at(name).outline, moved->second)));
    }
  });
  return std::isfinite(least) ? std::optional(least) : std::nullopt;
}

std::optional<double> time_to(const Measure& measure, const tools::Seen& seen) {
  const auto poses = seen.record.poses.find(measure.model);
  if (poses == seen.record.poses.end()) return std::nullopt;
  const auto in =
      std::ranges::find_if(poses->second, [&](const auto& pose) { return measure.reached.holds(tools::values_at(pose)).value(); });
  return in == poses->second.end() ? std::nullopt : std::optional(in->time);
}

std::optional<double> number_of(const tools::SeenValue& seen, Measure::Take take) {
  if (!seen.mean()) return std::nullopt;
  switch (take) {
    case Measure::Take::min:
      return seen.lowest;
    case Measure::Take::max:
      return seen.highest;
    case Measure::Take::mean:
      return seen.mean();
    default:
      return seen.last;
  }
}

std::optional<double> value(const Measure& measure, const tools::Seen& seen) {
  const auto found = seen.values.find(measure.port + " " + measure.member);
  if (measure.take == Measure::Take::count) return found == seen.values.end() ? 0.0 : static_cast<double>(found->second.samples);
  return found == seen.values.end() ? std::nullopt : number_of(found->second, measure.take);
}

std::optional<double> joint(const Measure& measure, const tools::PoseRecord& record) {
  const auto found = record.joints.find(measure.model + "::" + measure.joint);
  if (found == record.joints.end() || found->second.empty()) return std::nullopt;
  tools::SeenValue seen;
  for (const auto& one : found->second) seen.take(one.position);
  return number_of(seen, measure.take);
}

std::optional<double> holds(const Measure& measure, const tools::Seen& seen) {
  const auto found = seen.grips.find(tools::grip_name(measure.gripper, measure.model));
  return found == seen.grips.end() ? std::nullopt : std::optional(found->second.empty() ? 1.0 : 0.0);
}

double contacts(const Measure& measure, const tools::Seen& seen) {
  return static_cast<double>(std::ranges::count_if(seen.record.contacts, [&](const auto& contact) {
    return (contact.model == measure.model && contact.other != tools::usually_touched) ||
           (contact.other == measure.model && contact.model != tools::usually_touched);
  }));
}

}  // namespace

std::vector<tools::Expectation> watched_values(const std::vector<Measure>& measures) {
  std::vector<tools::Expectation> watched;
  for (const auto& measure : measures) {
    using Kind = tools::Expectation::Kind;
    const bool is_value = measure.kind == Measure::Kind::value, is_joint = measure.kind == Measure::Kind::joint;
    if (!is_value && !is_joint && measure.kind != Measure::Kind::holds) continue;
    tools::Expectation expectation;
    expectation.kind = is_value ? Kind::value : is_joint ? Kind::joint : Kind::holds;
    expectation.model = measure.model;
    expectation.joint = measure.joint;
    expectation.gripper = measure.gripper;
    expectation.text = measure.name;
    expectation.port = measure.port;
    expectation.member = measure.member;
    watched.push_back(std::move(expectation));
  }
  return watched;
}

std::map<std::string, double> take_measures(const std::vector<Measure>& measures, const tools::Seen& seen,
                                            const std::map<std::string, SurveyedModel>& models, double wall_s) {
  std::map<std::string, double> numbers;
  for (const auto& measure : measures) {
    std::optional<double> number;
    const auto poses = seen.record.poses.find(measure.model);
    switch (measure.kind) {
      case Measure::Kind::path_length:
        if (poses != seen.record.poses.end()) number = tools::path_length(poses->second);
        break;
      case Measure::Kind::time_to:
        number = time_to(measure, seen);
        break;
      case Measure::Kind::clearance:
        number = clearance(measure, models, seen.record);
        break;
      case Measure::Kind::contacts:
        number = contacts(measure, seen);
        break;
      case Measure::Kind::value:
        number = value(measure, seen);
        break;
      case Measure::Kind::joint:
        number = joint(measure, seen.record);
        break;
      case Measure::Kind::holds:
        number = holds(measure, seen);
        break;
      case Measure::Kind::wall_time:
        number = wall_s;
        break;
    }
    if (number && std::isfinite(*number)) numbers[measure.name] = *number;
  }
  return numbers;
}

}  // namespace campaign
