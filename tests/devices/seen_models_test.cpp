// Logical cameras and detectors of marks, against frustums and walls that are easy to calculate.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;

std::string thing(const std::string& name, double x, double y, double z) {
  return "<model name='" + name + "'><static>true</static><pose>" + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) +
         " 0 0 0</pose><link name='l'/></model>";
}

std::string logical_robot(const std::string& pose = "0 0 0 0 0 0") {
  return "<gravity>0 0 0</gravity><model name='robot'><pose>" + pose +
         "</pose><link name='l'><sensor name='eye' type='logical_camera'><update_rate>10</update_rate>"
         "<logical_camera><near>0.55</near><far>5</far><horizontal_fov>1.04719755</horizontal_fov><aspect_ratio>1.778</aspect_ratio>"
         "</logical_camera></sensor></link></model>";
}

std::vector<std::string> seen_by_eye(SimulationFixture& f) {
  auto iface = f.open(shm::IfaceType::logical_camera, "robot::eye");
  f.run(0.1);
  if (!iface.read()) return {"nothing read"};
  const auto* models = reinterpret_cast<const shm::SeenModel*>(iface.sample_followers(0));
  std::vector<std::string> names;
  for (std::size_t i = 0; i < iface.filled(); ++i) names.emplace_back(models[i].name);
  return names;
}

// At 5 m the frustum is 2.887 m wide to each side and 1.624 m high.
TEST(LogicalCamera, sees_models_whose_origin_is_in_its_frustum) {
  SimulationFixture f(world_of_text(logical_robot() + thing("left", 4.999, 2.88, 0) + thing("too_far_left", 4.999, 2.9, 0) +
                                    thing("up", 4.999, 0, 1.62) + thing("too_high", 4.999, 0, 1.64) + thing("near", 0.56, 0, 0) +
                                    thing("too_near", 0.54, 0, 0) + thing("too_far", 5.01, 0, 0) + thing("behind", -2, 0, 0)));
  EXPECT_EQ(seen_by_eye(f), (std::vector<std::string>{"left", "up", "near"}));
}

TEST(LogicalCamera, sees_through_walls_and_says_where_models_are_in_its_own_frame) {
  const std::string wall =
      "<model name='wall'><static>true</static><pose>1 20 0 0 0 0</pose><link name='l'><collision name='c'><pose>0 -20 0 0 0 0</pose>"
      "<geometry><box><size>0.1 50 50</size></box></geometry></collision></link></model>";
  SimulationFixture f(world_of_text(logical_robot("1 2 0 0 0 1.57079632679") + thing("box", 0.5, 5, 0.25) + wall));
  auto iface = f.open(shm::IfaceType::logical_camera, "robot::eye");
  f.run(0.1);
  ASSERT_TRUE(iface.read());
  ASSERT_EQ(iface.filled(), 1U);
  const auto& box = *reinterpret_cast<const shm::SeenModel*>(iface.sample_followers(0));
  EXPECT_STREQ(box.name, "box");
  EXPECT_NEAR(box.pose.x, 3, 1e-9);
  EXPECT_NEAR(box.pose.y, 0.5, 1e-9);
  EXPECT_NEAR(box.pose.z, 0.25, 1e-9);
  EXPECT_NEAR(box.pose.qz, -std::sqrt(0.5), 1e-9);
}

TEST(LogicalCamera, gives_nested_models_their_scoped_names) {
  const std::string shelf =
      "<model name='shelf'><pose>2 0 0 0 0 0</pose><link name='l'/>"
      "<model name='cup'><pose>0 0.3 0 0 0 0</pose><link name='l'><pose>0.1 0 0 0 0 0</pose></link></model></model>";
  SimulationFixture f(world_of_text(logical_robot() + shelf));
  auto iface = f.open(shm::IfaceType::logical_camera, "robot::eye");
  f.run(0.1);
  ASSERT_TRUE(iface.read());
  ASSERT_EQ(iface.filled(), 2U);
  const auto* models = reinterpret_cast<const shm::SeenModel*>(iface.sample_followers(0));
  EXPECT_STREQ(models[0].name, "shelf");
  EXPECT_STREQ(models[1].name, "shelf::cup");
  EXPECT_NEAR(models[1].pose.x, 2, 1e-9);
  EXPECT_NEAR(models[1].pose.y, 0.3, 1e-9);
}

// A detector in the origin that looks along x.
std::string detector(const std::string& more = "") {
  return "<gravity>0 0 0</gravity><model name='robot'><link name='l'><collision name='c'><geometry><box><size>0.2 0.2 0.2</size></box>"
         "</geometry></collision><sensor name='marks' type='fiducial'><update_rate>10</update_rate><fiducial><range><max>6</max></range>"
         "<horizontal_fov>1.2</horizontal_fov>" +
         more + "</fiducial></sensor></link></model>";
}

// A board of 0.3 m whose mark looks back along x.
std::string board(int id, double x, double y, double yaw = 3.14159265358979) {
  return "<model name='board_" + std::to_string(id) + "'><static>true</static><pose>" + std::to_string(x) + " " + std::to_string(y) +
         " 0 0 0 " + std::to_string(yaw) +
         "</pose><link name='l'><collision name='c'><pose>-0.01 0 0 0 0 0</pose><geometry><box><size>0.02 0.3 0.3</size></box></geometry>"
         "</collision></link><plugin filename='rtmsim-fiducial' name='rtmsim::Fiducial'><id>" +
         std::to_string(id) + "</id><size>0.3</size></plugin></model>";
}

std::string wall(double y, double width) {
  return "<model name='wall'><static>true</static><pose>1 " + std::to_string(y) +
         " 0 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>0.1 " + std::to_string(width) +
         " 2</size></box></geometry></collision></link></model>";
}

std::vector<shm::Mark> marks_in(const std::string& world) {
  SimulationFixture f(world_of_text(world));
  auto iface = f.open(shm::IfaceType::fiducial, "robot::marks");
  f.run(0.1);
  if (!iface.read()) throw std::runtime_error("no sample");
  const auto* marks = reinterpret_cast<const shm::Mark*>(iface.sample_followers(0));
  return {marks, marks + iface.filled()};
}

TEST(Fiducial, is_seen_where_it_is) {
  const auto marks = marks_in(detector() + board(12, 3, 0.5));
  ASSERT_EQ(marks.size(), 1U);
  EXPECT_EQ(marks[0].id, 12U);
  EXPECT_STREQ(marks[0].model, "board_12");
  EXPECT_NEAR(marks[0].pose.x, 3, 1e-9);
  EXPECT_NEAR(marks[0].pose.y, 0.5, 1e-9);
  EXPECT_NEAR(std::abs(marks[0].pose.qz), 1, 1e-6);
  EXPECT_EQ(marks[0].size[1], 0.3);
}

TEST(Fiducial, behind_a_wall_is_unseen) { EXPECT_TRUE(marks_in(detector() + board(1, 3, 0) + wall(0, 2)).empty()); }

// The wall hides what is left of y = 0.01 at its distance, a third of the way: two of the five rays.
TEST(Fiducial, that_is_half_covered_is_seen_by_three_of_five_rays) {
  EXPECT_EQ(marks_in(detector() + board(1, 3, 0) + wall(0.51, 1)).size(), 1U);
  EXPECT_TRUE(marks_in(detector() + board(1, 3, 0) + wall(0.49, 1)).empty());
}

TEST(Fiducial, out_of_range_or_view_or_turned_away_is_unseen) {
  EXPECT_TRUE(marks_in(detector() + board(1, 6.1, 0)).empty());
  EXPECT_TRUE(marks_in(detector() + board(1, 2, 1.4)).empty());
  EXPECT_EQ(marks_in(detector() + board(1, 2, 1.3)).size(), 1U);
  EXPECT_TRUE(marks_in(detector() + board(1, 3, 0, 0)).empty());
  EXPECT_TRUE(marks_in(detector() + board(1, 3, 0, 3.14159 - 1.42)).empty());
  EXPECT_EQ(marks_in(detector() + board(1, 3, 0, 3.14159 - 1.36)).size(), 1U);
}

TEST(Fiducial, noise_moves_what_is_reported_and_an_empty_view_is_reported_too) {
  const std::string noise = "<position><noise type='gaussian'><stddev>0.05</stddev></noise></position>";
  const auto marks = marks_in(detector(noise) + board(1, 3, 0));
  ASSERT_EQ(marks.size(), 1U);
  EXPECT_NE(marks[0].pose.x, 3);
  EXPECT_NEAR(marks[0].pose.x, 3, 0.4);
  EXPECT_TRUE(marks_in(detector()).empty());
}

}  // namespace
}  // namespace sim
