// Outlines on a map, and ways over it: round corners with room for the robot, out of what it is in, and why there is none.
#include "shm/map_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shm/map_lines.h"

namespace shm {
namespace {

// 4 x 4 m, all free.
WorldMap empty_map(double resolution = 0.05) {
  WorldMap map;
  map.area = {-2, -2, resolution, static_cast<int>(std::lround(4 / resolution)), static_cast<int>(std::lround(4 / resolution)), 0.05, 0.5};
  map.pixels.assign(static_cast<std::size_t>(map.area.width) * static_cast<std::size_t>(map.area.height), 254);
  return map;
}

void occupy(WorldMap& map, double x0, double y0, double x1, double y1) {
  const MapArea& area = map.area;
  for (int row = 0; row < area.height; ++row) {
    for (int column = 0; column < area.width; ++column) {
      const double x = area.x + (column + 0.5) * area.resolution, y = area.y + (row + 0.5) * area.resolution;
      if (x > x0 && x < x1 && y > y0 && y < y1) map.pixels[static_cast<std::size_t>((area.height - 1 - row) * area.width + column)] = 0;
    }
  }
}

// From a point to a rectangle.
double distance_to(double x, double y, double x0, double y0, double x1, double y1) {
  return std::hypot(std::max({x0 - x, 0.0, x - x1}), std::max({y0 - y, 0.0, y - y1}));
}

TEST(MapPath, goes_straight_where_nothing_is) {
  const auto way = plan_path(empty_map(), {-1.5, -1}, {1.2, 1.3}, 0.3);
  ASSERT_TRUE(way);
  EXPECT_EQ(*way, (std::vector<MapPlace>{{1.2, 1.3}}));
}

TEST(MapPath, keeps_its_distance_on_the_way_round_a_wall) {
  WorldMap map = empty_map();
  occupy(map, -0.1, -2, 0.1, 1);
  const auto way = plan_path(map, {-1, -1}, {1, -1}, 0.3);
  ASSERT_TRUE(way);
  ASSERT_GE(way->size(), 2U);
  EXPECT_LE(way->size(), 8U);
  EXPECT_EQ(way->back(), (MapPlace{1, -1}));
  MapPlace at{-1, -1};
  for (const MapPlace& next : *way) {
    for (int i = 0; i <= 100; ++i) {
      const double t = i / 100.0, x = at[0] + t * (next[0] - at[0]), y = at[1] + t * (next[1] - at[1]);
      EXPECT_GE(distance_to(x, y, -0.1, -2, 0.1, 1), 0.3 - 0.05) << x << " " << y;
    }
    at = next;
  }
}

TEST(MapPath, leaves_what_the_robot_is_too_near_to) {
  WorldMap map = empty_map();
  occupy(map, -0.1, -1, 0.1, 1);
  const auto way = plan_path(map, {-0.2, 0}, {-1.5, 0}, 0.3);
  ASSERT_TRUE(way) << way.error().message;
  EXPECT_EQ(way->back(), (MapPlace{-1.5, 0}));
}

TEST(MapPath, says_why_there_is_no_way) {
  WorldMap map = empty_map();
  occupy(map, -0.1, -2, 0.1, 2);
  EXPECT_EQ(plan_path(map, {-1, 0}, {1, 0}, 0.3).error().message, "no way leads from (-1, 0) to (1, 0)");
  EXPECT_EQ(plan_path(map, {-1, 0}, {-0.3, 0}, 0.3).error().message, "the goal (-0.3, 0) is nearer than 0.3 m to something");
}

TEST(MapPath, a_door_that_is_wide_enough_is_passed) {
  WorldMap map = empty_map();
  occupy(map, -0.1, -2, 0.1, -0.4);
  occupy(map, -0.1, 0.4, 0.1, 2);
  EXPECT_TRUE(plan_path(map, {-1, 1}, {1, -1}, 0.3));
  EXPECT_FALSE(plan_path(map, {-1, 1}, {1, -1}, 0.45));
}

TEST(MapLines, the_outline_of_a_box_is_four_lines) {
  const auto wall = [](MapPoint a, MapPoint b) {
    const MapPoint c{b[0], b[1], 1}, d{a[0], a[1], 1};
    return std::vector<MapPoint>{a, b, c, a, c, d};
  };
  std::vector<MapPoint> triangles;
  for (const auto& part : {wall({0, 0, 0}, {2, 0, 0}), wall({2, 0, 0}, {2, 1, 0}), wall({2, 1, 0}, {0, 1, 0}), wall({0, 1, 0}, {0, 0, 0})})
    triangles.insert(triangles.end(), part.begin(), part.end());
  std::vector<MapLine> lines;
  add_map_lines(triangles, 0.3, lines);
  ASSERT_EQ(lines.size(), 4U);
  double length = 0;
  for (const MapLine& line : lines) length += std::hypot(line.x1 - line.x0, line.y1 - line.y0);
  EXPECT_NEAR(length, 6, 1e-9);
  lines.clear();
  add_map_lines(triangles, 2, lines);
  EXPECT_TRUE(lines.empty());
}

}  // namespace
}  // namespace shm
