// Bounds of entities, and which of them overlap.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bounds.h"
#include "ros/from_iface.h"

namespace {

using namespace ros2;
using Point = std::array<double, 3>;

Point moved(const shm::Pose& by, const Point& p) {
  const auto at = ros::product(by, {p[0], p[1], p[2], 1, 0, 0, 0});
  return {at.x, at.y, at.z};
}
// The nearest point of a box.
Point nearest(const EntityBox& box, const Point& p) {
  Point q = moved(ros::inverse(box.pose), p);
  for (std::size_t i = 0; i < 3; ++i) q[i] = std::clamp(q[i], box.low[i], box.high[i]);
  return moved(box.pose, q);
}
double distance(const Point& a, const Point& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

// Going to the nearest point of one convex body and of the other in turn ends where they are nearest.
TEST(Ros2Bounds, boxes_and_spheres_overlap_as_their_nearest_points_say) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> side(0.1, 2), place(-2, 2), turn(-1, 1);
  int met = 0, apart = 0;
  for (int run = 0; run < 3000; ++run) {
    double q[4] = {turn(random), turn(random), turn(random), turn(random)};
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const EntityBox entity{{place(random), place(random), place(random), q[0] / length, q[1] / length, q[2] / length, q[3] / length},
                           {-side(random), -side(random), -side(random)},
                           {side(random), side(random), side(random)}};
    EntityBox bounds;
    for (std::size_t i = 0; i < 3; ++i) bounds.low[i] = place(random), bounds.high[i] = bounds.low[i] + side(random);
    Point on_bounds = bounds.low, on_entity = nearest(entity, on_bounds);
    for (int i = 0; i < 400; ++i) on_bounds = nearest(bounds, on_entity), on_entity = nearest(entity, on_bounds);
    const double gap = distance(on_bounds, on_entity);
    if (gap > 1e-6 && gap < 1e-2) continue;  // not there yet
    (gap > 1e-3 ? apart : met) += 1;
    const ros::Bounds box{ros::Bounds::box,
                          {{bounds.high[0], bounds.high[1], bounds.high[2]}, {bounds.low[0], bounds.low[1], bounds.low[2]}}};
    EXPECT_EQ(overlaps(entity, box), gap < 1e-3) << "run " << run << ", gap " << gap;
    const Point center = bounds.low;
    const double away = distance(center, nearest(entity, center));
    for (const double radius : {away * 0.999 - 1e-9, away * 1.001 + 1e-9}) {
      if (radius < 0) continue;
      EXPECT_EQ(overlaps(entity, {ros::Bounds::sphere, {{center[0], center[1], center[2]}, {radius, 0, 0}}}), away <= radius) << run;
    }
  }
  EXPECT_GT(met, 500);
  EXPECT_GT(apart, 500);
}

TEST(Ros2Bounds, sides_without_an_end_are_read_and_compared) {
  const auto boxes = boxes_in(R"({"models": [{"name": "ground", "pose": [0,0,1,1,0,0,0], "bounds": [null,null,null,null,null,0]},)"
                              R"({"name": "bare", "pose": [1,2,3,1,0,0,0], "bounds": []}, {"name": "broken", "pose": []}]})");
  ASSERT_EQ(boxes.size(), 2U);
  const auto above = [](double z) { return ros::Bounds{ros::Bounds::box, {{5e5, 1, z + 1}, {4e5, 0, z}}}; };
  EXPECT_TRUE(overlaps(boxes.at("ground"), above(0.9)));
  EXPECT_FALSE(overlaps(boxes.at("ground"), above(1.1)));
  EXPECT_EQ(bounds_of(boxes.at("ground")).type, ros::Bounds::empty);
  EXPECT_EQ(bounds_of(boxes.at("bare")).points.size(), 2U);
  EXPECT_TRUE(overlaps(boxes.at("bare"), {ros::Bounds::sphere, {{1, 2, 4}, {1, 0, 0}}}));
  EXPECT_TRUE(boxes_in("nonsense").empty());
}

}  // namespace
