#include "bounds.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "ros/from_iface.h"

namespace ros2 {
namespace {

using Json = nlohmann::json;
using Numbers = std::array<double, 3>;
using ros::Bounds;
using ros::SimulationResult;

constexpr double infinite = std::numeric_limits<double>::infinity();

Numbers numbers_of(const ros::Vector3& v) { return {v.x, v.y, v.z}; }

// The end of an infinite side, where two boxes are compared.
double within_reach(double value) { return std::clamp(value, -1e9, 1e9); }

bool overlaps_ball(const EntityBox& box, const Numbers& center, double radius) {
  const auto local = ros::product(ros::inverse(box.pose), {center[0], center[1], center[2], 1, 0, 0, 0});
  const Numbers p = {local.x, local.y, local.z};
  double square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double away = p[i] - std::clamp(p[i], box.low[i], box.high[i]);
    square += away * away;
  }
  return square <= radius * radius;
}

// No axis parts them: those of the two boxes, and those across one of each.
bool overlaps_box(const EntityBox& box, const Numbers& low, const Numbers& high) {
  Numbers middle{}, half{}, other_half{}, way{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double from = within_reach(box.low[i]), to = within_reach(box.high[i]);
    middle[i] = (from + to) / 2;
    half[i] = (to - from) / 2;
    other_half[i] = (high[i] - low[i]) / 2;
  }
  const auto place = ros::product(box.pose, {middle[0], middle[1], middle[2], 1, 0, 0, 0});
  way = {place.x - (low[0] + high[0]) / 2, place.y - (low[1] + high[1]) / 2, place.z - (low[2] + high[2]) / 2};
  double turn[3][3];  // columns: the axes of the entity in the world
  for (std::size_t j = 0; j < 3; ++j) {
    const shm::Pose unit{j == 0 ? 1.0 : 0.0, j == 1 ? 1.0 : 0.0, j == 2 ? 1.0 : 0.0, 1, 0, 0, 0};
    const auto axis = ros::product({0, 0, 0, box.pose.qw, box.pose.qx, box.pose.qy, box.pose.qz}, unit);
    turn[0][j] = axis.x, turn[1][j] = axis.y, turn[2][j] = axis.z;
  }
  const auto parts = [&](const Numbers& axis) {
    double distance = 0, reach = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      distance += axis[i] * way[i];
      reach += std::abs(axis[i]) * other_half[i] + std::abs(axis[0] * turn[0][i] + axis[1] * turn[1][i] + axis[2] * turn[2][i]) * half[i];
    }
    return std::abs(distance) > reach;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    Numbers of_world{};
    of_world[i] = 1;
    if (parts(of_world) || parts({turn[0][i], turn[1][i], turn[2][i]})) return false;
    for (std::size_t j = 0; j < 3; ++j) {
      Numbers across{};
      across[(i + 1) % 3] = -turn[(i + 2) % 3][j];
      across[(i + 2) % 3] = turn[(i + 1) % 3][j];
      if (parts(across)) return false;
    }
  }
  return true;
}

}  // namespace

std::map<std::string, EntityBox> boxes_in(const std::string& tree) {
  std::map<std::string, EntityBox> boxes;
  const auto json = Json::parse(tree, nullptr, false);
  if (!json.is_object()) return boxes;
  for (const auto& model : json.value("models", Json::array())) {
    const auto pose = model.value("pose", std::vector<double>());
    const auto sides = model.value("bounds", Json::array());
    if (pose.size() != 7) continue;
    EntityBox box{.pose = {pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], pose[6]}};
    for (std::size_t i = 0; i < 3 && sides.size() == 6; ++i) {
      box.low[i] = sides[i].is_number() ? sides[i].get<double>() : -infinite;
      box.high[i] = sides[i + 3].is_number() ? sides[i + 3].get<double>() : infinite;
    }
    boxes[model.value("name", "")] = box;
  }
  return boxes;
}

Bounds bounds_of(const EntityBox& box) {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (!std::ranges::all_of(box.low, is_finite) || !std::ranges::all_of(box.high, is_finite)) return {};
  return {Bounds::box, {{box.high[0], box.high[1], box.high[2]}, {box.low[0], box.low[1], box.low[2]}}};
}

std::optional<SimulationResult> problem_of(const Bounds& bounds) {
  const auto bad = [](const char* why) { return SimulationResult{SimulationResult::failed, why}; };
  if (bounds.type == Bounds::empty) return std::nullopt;
  if (bounds.type != Bounds::box && bounds.type != Bounds::sphere)
    return SimulationResult{SimulationResult::unsupported,
                            "bounds.type must be 0 (empty), 1 (box) or 3 (sphere), got " + std::to_string(bounds.type)};
  if (bounds.points.size() != 2) return bad("bounds must have 2 points");
  const Numbers first = numbers_of(bounds.points[0]), second = numbers_of(bounds.points[1]);
  constexpr double most = 1e12;  // of the simulator
  const auto is_good = [](double value) { return std::abs(value) < most; };
  if (!std::ranges::all_of(first, is_good)) return bad("bounds must have finite points below 1e12 m");
  if (bounds.type == Bounds::sphere)
    return second[0] >= 0 && is_good(second[0]) ? std::nullopt
                                                : std::optional(bad("bounds of a sphere must have a radius from 0 to 1e12 m"));
  if (!std::ranges::all_of(second, is_good)) return bad("bounds must have finite points below 1e12 m");
  for (std::size_t i = 0; i < 3; ++i)
    if (first[i] < second[i]) return bad("bounds of a box must begin with the upper corner");
  return std::nullopt;
}

bool overlaps(const EntityBox& box, const Bounds& bounds) {
  if (bounds.type == Bounds::empty) return true;
  const Numbers first = numbers_of(bounds.points[0]), second = numbers_of(bounds.points[1]);
  return bounds.type == Bounds::sphere ? overlaps_ball(box, first, second[0]) : overlaps_box(box, second, first);
}

}  // namespace ros2
