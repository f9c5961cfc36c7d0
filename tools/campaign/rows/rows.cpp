#include "campaign/rows/rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "base/text.h"
#include "campaign/rows/model_files.h"
#include "campaign/rows/samples.h"

namespace campaign {
namespace {

// 12 digits are more than any parameter needs, and can be read.
std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", value);
  return base::format_number(base::parse_number(text).value_or(value));
}

// x y z roll pitch yaw
std::vector<double> six_numbers(const Eigen::Isometry3d& pose) {
  const auto& r = pose.linear();
  return {pose.translation().x(),
          pose.translation().y(),
          pose.translation().z(),
          std::atan2(r(2, 1), r(2, 2)),
          std::asin(std::clamp(-r(2, 0), -1.0, 1.0)),
          std::atan2(r(1, 0), r(0, 0))};
}

}  // namespace

std::map<std::string, SurveyedModel> placed_models(const Row& row, std::map<std::string, SurveyedModel> models) {
  for (const auto& [path, value] : row.values) {
    const auto words = base::split_list(path, '/');
    if (words.size() < 3 || words[0] != "model" || words[2] != "pose" || !models.contains(words[1])) continue;
    auto& pose = models.at(words[1]).pose;
    auto numbers = six_numbers(pose);
    const auto given = numbers_in(value);
    if (words.size() == 3 && given.size() == 3) numbers = {given[0], given[1], numbers[2], 0, 0, given[2]};
    if (words.size() == 3 && given.size() == 6) numbers = given;
    const auto part = words.size() == 4 ? std::ranges::find(pose_parts, words[3]) : pose_parts.end();
    if (part != pose_parts.end() && !given.empty()) numbers[static_cast<std::size_t>(part - pose_parts.begin())] = given.front();
    pose = to_pose(numbers);
  }
  return models;
}

Result<RowMaker> RowMaker::make(const Plan& plan, const std::map<std::string, SurveyedModel>& models) {
  RowMaker maker(plan);
  double rows = static_cast<double>(plan.repeat);
  std::size_t ranges = 0;
  for (const auto& axis : plan.axes) {
    if (axis.range) ++ranges;
    if (!axis.range) rows *= static_cast<double>(axis.values.size());
  }
  if (ranges > 0) {
    maker.samples_ = plan.samples;
    rows *= static_cast<double>(plan.samples);
  }
  if (rows > static_cast<double>(max_rows))
    return Error{"plan " + base::in_quotes(plan.file) + ": has " + base::format_number(rows) + " rows, expected at most " +
                 std::to_string(max_rows)};
  maker.count_ = static_cast<std::size_t>(rows);
  if (ranges > 0) {
    auto points = unit_samples(plan.sampling, plan.samples, ranges, plan.sampling_seed);
    if (!points) return points.error();
    maker.points_ = std::move(*points);
  }
  if (plan.scatters.empty()) return maker;
  maker.models_ = models;
  for (const auto& scatter : plan.scatters) {
    for (const auto& name : scatter.models) {
      if (!maker.models_.contains(name))
        return Error{"plan " + base::in_quotes(plan.file) + ": scatter: the world has no model " + base::in_quotes(name)};
    }
  }
  return maker;
}

Result<Row> RowMaker::row(std::size_t number) const {
  Row row;
  row.number = number;
  auto place = number - 1;
  const auto digit = [&](std::size_t base) {
    const auto value = place % base;
    place /= base;
    return value;
  };
  row.seed = plan_->seed + digit(plan_->repeat);
  const auto sample = digit(samples_);
  std::vector<std::size_t> chosen(plan_->axes.size());
  // The last axis turns fastest.
  for (std::size_t i = plan_->axes.size(); i-- > 0;) chosen[i] = plan_->axes[i].range ? 0 : digit(plan_->axes[i].values.size());
  std::size_t dimension = 0;
  for (std::size_t i = 0; i < plan_->axes.size(); ++i) {
    const auto& axis = plan_->axes[i];
    auto value = axis.range ? short_number(in_range(*axis.range, points_[sample][dimension++])) : axis.values[chosen[i]];
    if (axis.path != "seed") {
      row.values.emplace_back(axis.path, std::move(value));
      continue;
    }
    const auto seed = base::parse_number(value);
    if (!seed || *seed < 0 || *seed > 1e18) return Error{"seed: must be a whole number from 0 to 1e18, got " + base::in_quotes(value)};
    row.seed = static_cast<std::uint64_t>(std::llround(*seed));
  }
  if (!plan_->scatters.empty()) {
    if (const auto done = scatter(row, sample); !done) return done.error();
  }
  return row;
}

Result<void> RowMaker::scatter(Row& row, std::size_t sample) const {
  constexpr int tries = 2000;
  base::Random random(plan_->sampling_seed, "scatter " + std::to_string(row.seed) + " " + std::to_string(sample));
  auto models = placed_models(row, models_);
  std::map<std::string, std::vector<Polygon>> standing;
  for (const auto& [name, model] : models) standing[name] = footprint(model.outline, model.pose);
  for (const auto& scatter : plan_->scatters) {
    for (const auto& name : scatter.models) standing.erase(name);
  }
  for (const auto& scatter : plan_->scatters) {
    for (const auto& name : scatter.models) {
      bool is_placed = false;
      for (int i = 0; i < tries && !is_placed; ++i) {
        auto pose = models.at(name).pose;
        pose.translation().x() = scatter.region.x1 + random.uniform() * (scatter.region.x2 - scatter.region.x1);
        pose.translation().y() = scatter.region.y1 + random.uniform() * (scatter.region.y2 - scatter.region.y1);
        const double yaw = scatter.turns ? random.uniform() * 2 * std::numbers::pi - std::numbers::pi : 0;
        if (scatter.turns) pose.linear() = to_pose({0, 0, 0, 0, 0, yaw}).linear();
        const auto mine = footprint(models.at(name).outline, pose);
        is_placed = std::ranges::none_of(standing, [&](const auto& other) { return distance(mine, other.second) <= scatter.clearance; });
        if (!is_placed) continue;
        standing[name] = mine;
        row.values.emplace_back("model/" + name + "/pose/x", short_number(pose.translation().x()));
        row.values.emplace_back("model/" + name + "/pose/y", short_number(pose.translation().y()));
        if (scatter.turns) row.values.emplace_back("model/" + name + "/pose/yaw", short_number(yaw));
      }
      if (!is_placed)
        return Error{"scatter: model " + name + " finds no place in its region with a clearance of " +
                     base::format_number(scatter.clearance) + " m; expected a larger region, or fewer models"};
    }
  }
  return {};
}

}  // namespace campaign
