// Way points against closed forms: places, headings and times of straight ways, rounded corners, turns on the spot and rounds.
#include "devices/drives/path.h"

#include <gtest/gtest.h>

#include <numbers>

#include "devices/device.h"

namespace {

constexpr double pi = std::numbers::pi;

sim::ParameterNode node(const std::string& name, const std::string& text = "") { return {name, text, {}, {}}; }

sim::PluginDef plugin(std::vector<std::string> waypoints, std::vector<sim::ParameterNode> more = {}) {
  sim::PluginDef def;
  def.name = "walk";
  def.source = "test.sdf:7";
  sim::ParameterNode list = node("waypoints");
  for (auto& text : waypoints) list.children.push_back(node("waypoint", text));
  if (!waypoints.empty()) def.parameters.children.push_back(std::move(list));
  for (auto& child : more) def.parameters.children.push_back(std::move(child));
  return def;
}

Eigen::Isometry3d start(double x, double y, double yaw, double z = 0) {
  return Eigen::Translation3d(x, y, z) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
}

void expect_at(const sim::Path& path, double t, Eigen::Vector3d place, double yaw) {
  const Eigen::Isometry3d pose = path.at(t);
  EXPECT_LT((pose.translation() - place).norm(), 1e-9) << "at " << t << ": " << pose.translation().transpose();
  EXPECT_NEAR(std::remainder(sim::yaw_of(pose) - yaw, 2 * pi), 0, 1e-9) << "at " << t;
}

TEST(Path, straight_way_ends_at_the_last_point) {
  const auto path = sim::Path::of(plugin({"4 0", "4 0 3"}, {node("speed", "2")}), start(0, 0, 0));
  ASSERT_TRUE(path) << path.error().message;
  expect_at(*path, 0, {0, 0, 0}, 0);
  expect_at(*path, 1, {2, 0, 0}, 0);
  expect_at(*path, 2.5, {4, 0, 1}, 0);
  expect_at(*path, 100, {4, 0, 3}, 0);
  EXPECT_EQ(path->lap(), 0);
}

TEST(Path, turns_on_the_spot_at_sharp_corners) {
  const auto path = sim::Path::of(plugin({"1 0", "1 1"}, {node("turn_rate", "1")}), start(0, 0, pi / 2));
  ASSERT_TRUE(path);
  expect_at(*path, pi / 4, {0, 0, 0}, pi / 4);
  expect_at(*path, pi / 2 + 0.5, {0.5, 0, 0}, 0);
  expect_at(*path, pi / 2 + 1 + pi / 4, {1, 0, 0}, pi / 4);
  expect_at(*path, pi + 1.5, {1, 0.5, 0}, pi / 2);
}

TEST(Path, round_square_has_closed_form_and_repeats) {
  const auto path = sim::Path::of(plugin({"0 0", "4 0", "4 4", "0 4"}, {node("loop", "true"), node("corner_radius", "1")}), start(0, 0, 0));
  ASSERT_TRUE(path);
  const double lap = 4 * 2 + 2 * pi;
  EXPECT_NEAR(path->lap(), lap, 1e-9);
  expect_at(*path, 0.5, {0.5, 0, 0}, 0);
  expect_at(*path, 3, {3, 0, 0}, 0);
  const double a = pi / 4;  // the middle of the first corner
  expect_at(*path, 3 + a, {3 + std::sin(a), 1 - std::cos(a), 0}, a);
  expect_at(*path, 3 + pi / 2 + 1, {4, 2, 0}, pi / 2);
  for (double t : {1.1, 2.0, 7.3, 13.9}) {
    const Eigen::Isometry3d once = path->at(t);
    for (int round : {1, 2, 1000}) {
      EXPECT_LT((path->at(t + round * lap).translation() - once.translation()).norm(), 1e-8);
      EXPECT_NEAR(std::remainder(sim::yaw_of(path->at(t + round * lap)) - sim::yaw_of(once), 2 * pi), 0, 1e-8);
    }
  }
}

TEST(Path, speed_is_the_same_everywhere_on_the_round) {
  const auto path = sim::Path::of(plugin({"-4.5 -2.5 2", "2 -3 2.5", "3 1 2", "0.5 3.2 3", "-4.5 2.5 2"},
                                         {node("loop", "true"), node("corner_radius", "1.5"), node("speed", "0.8")}),
                                  start(-4.5, -2.5, -0.0767, 2));
  ASSERT_TRUE(path);
  const double dt = 1e-4;
  for (double t = 0.2; t < 2 * path->lap(); t += 0.05) {
    const double v = (path->at(t + dt).translation() - path->at(t).translation()).norm() / dt;
    ASSERT_NEAR(v, 0.8, 0.01) << "at " << t;  // on a slope the corner itself climbs less
  }
}

TEST(Path, corners_never_take_more_than_half_a_side) {
  const auto path = sim::Path::of(plugin({"0 0", "1 0", "1 1", "0 1"}, {node("loop", "1"), node("corner_radius", "50")}), start(0, 0, 0));
  ASSERT_TRUE(path);
  EXPECT_NEAR(path->lap(), pi, 1e-9);  // a circle of radius 0.5
}

TEST(Path, line_goes_there_and_back) {
  sim::ParameterNode line = node("line");
  line.children.push_back(node("length", "3"));
  const auto path = sim::Path::of(plugin({}, {line, node("turn_rate", "2")}), start(1, 1, pi / 2));
  ASSERT_TRUE(path);
  expect_at(*path, 3, {1, 4, 0}, pi / 2);
  expect_at(*path, 3 + pi / 2 + 1, {1, 3, 0}, -pi / 2);
  EXPECT_NEAR(path->lap(), 6 + pi, 1e-9);
}

TEST(Path, circle_is_round_the_start) {
  sim::ParameterNode circle = node("circle");
  circle.children.push_back(node("radius", "2"));
  const auto path = sim::Path::of(plugin({}, {circle}), start(5, 0, 0));
  ASSERT_TRUE(path);
  const double at_rim = 2 + (pi / 2) / 1.57;
  expect_at(*path, at_rim + pi, {5, 2, 0}, pi);  // a quarter
}

TEST(Path, waits_for_its_start) {
  const auto path = sim::Path::of(plugin({"1 0"}, {node("delay_start", "2")}), start(0, 0, 0));
  ASSERT_TRUE(path);
  expect_at(*path, 2, {0, 0, 0}, 0);
  expect_at(*path, 2.5, {0.5, 0, 0}, 0);
}

TEST(Path, bad_values_are_named) {
  const auto why = [](const sim::PluginDef& def) {
    const auto path = sim::Path::of(def, Eigen::Isometry3d::Identity());
    return path ? std::string("accepted") : path.error().message;
  };
  for (const char* text : {"", "1", "1 x", "1 2 3 4", "nan 0", "1e300 0"}) {
    const std::string line = why(plugin({text}));
    EXPECT_NE(line.find("test.sdf:7: plugin walk: waypoint"), std::string::npos) << text << ": " << line;
  }
  EXPECT_NE(why(plugin({"1 0"}, {node("speed", "0")})).find("speed 0: expected"), std::string::npos);
  EXPECT_NE(why(plugin({"1 0"}, {node("turn_rate", "-1")})).find("turn_rate -1: expected"), std::string::npos);
  EXPECT_NE(why(plugin({"1 0"}, {node("delay_start", "-1")})).find("delay_start -1: expected"), std::string::npos);
  EXPECT_NE(why(plugin({}, {node("circle")})).find("radius"), std::string::npos);
  EXPECT_NE(why(plugin({}, {node("line")})).find("length"), std::string::npos);
  EXPECT_NE(why(plugin({})).find("expected <waypoints>"), std::string::npos);
  EXPECT_NE(why(plugin({}, {node("waypoints")})).find("one <waypoint>"), std::string::npos);
}

}  // namespace
