#include "rays/body_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace sim {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity(), not_a_number = std::numeric_limits<double>::quiet_NaN();

std::vector<std::uint32_t> found(const BodyGrid& grid, double x, double y, double reach) {
  std::vector<std::uint32_t> ids;
  grid.find(x, y, reach, ids);
  return ids;
}

TEST(BodyGrid, finds_all_that_reach_into_the_circle_and_not_the_whole_world) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-100, 100), size(0, 3);
  std::vector<BodyGrid::Entry> entries;
  for (std::uint32_t id = 0; id < 1000; ++id) entries.push_back({id, any(random), any(random), size(random)});
  BodyGrid grid;
  grid.build(entries);
  std::size_t all = 0;
  for (int i = 0; i < 200; ++i) {
    const double x = 1.2 * any(random), y = 1.2 * any(random), reach = 4 * size(random);
    const auto ids = found(grid, x, y, reach);
    ASSERT_TRUE(std::ranges::is_sorted(ids));
    for (const auto& entry : entries) {
      if (std::hypot(entry.x - x, entry.y - y) > reach + entry.radius) continue;
      ASSERT_TRUE(std::ranges::binary_search(ids, entry.id)) << entry.id << " from " << x << ' ' << y << " within " << reach;
    }
    all += ids.size();
  }
  EXPECT_LT(all, 200 * 40) << "25 lie in the square of the mean reach";
  EXPECT_EQ(found(grid, 0, 0, infinity).size(), 1000);
}

TEST(BodyGrid, places_that_are_no_numbers_or_far_away_lose_nothing) {
  BodyGrid grid;
  grid.build(std::vector<BodyGrid::Entry>{{7, not_a_number, 0, 1}, {3, 1e300, -1e300, 1}, {5, 1, 1, 1}, {4, 0, infinity, 1}});
  EXPECT_EQ(found(grid, 0, 0, 2), (std::vector<std::uint32_t>{4, 5, 7}));
  EXPECT_EQ(found(grid, 0, 0, infinity), (std::vector<std::uint32_t>{3, 4, 5, 7}));
  EXPECT_EQ(found(grid, not_a_number, 0, 2), (std::vector<std::uint32_t>{4, 7}));
  grid.build({});
  EXPECT_TRUE(found(grid, 0, 0, infinity).empty());
}

}  // namespace
}  // namespace sim
