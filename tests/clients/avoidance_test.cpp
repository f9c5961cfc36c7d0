// The oracles are measured answers of Player's example to the same clearances.
#include "avoidance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace avoidance {
namespace {

constexpr double degree = std::numbers::pi / 180;

// 181 beams, all at 4 m but the nearest of each side.
Velocity answer(double right, double left) {
  std::vector<double> ranges(181, 4);
  ranges[30] = right;
  ranges[150] = left;
  return avoid(ranges, 8, {});
}

void expect(const Velocity& velocity, double forward, double turn_degrees) {
  EXPECT_NEAR(velocity.forward, forward, 1e-12);
  EXPECT_NEAR(velocity.turn, turn_degrees * degree, 1e-12);
}

TEST(Avoidance, drives_straight_at_full_speed_where_there_is_room) { expect(answer(1, 1), 0.2, 0); }
TEST(Avoidance, turns_left_when_the_right_is_nearer) { expect(answer(0.75, 1), 0.15, 40); }
TEST(Avoidance, backs_up_when_both_sides_are_near) { expect(answer(0.4, 0.4), -0.04, 0); }
TEST(Avoidance, turns_right_when_the_left_is_nearer) { expect(answer(0.9, 0.8), 0.14, -20); }
TEST(Avoidance, stands_in_a_symmetric_dead_end) { expect(answer(0.5, 0.5), 0, 0); }

TEST(Avoidance, the_middle_beam_belongs_to_the_right) {
  std::vector<double> ranges(181, 4);
  ranges[90] = 0.9;
  EXPECT_GT(avoid(ranges, 8, {}).turn, 0);
  ranges[90] = 4;
  ranges[91] = 0.9;
  EXPECT_LT(avoid(ranges, 8, {}).turn, 0);
}

TEST(Avoidance, clearance_never_exceeds_the_scanners_range) { expect(avoid(std::vector<double>(5, 100), 0.75, {}), 0.1, 0); }

TEST(Avoidance, no_beams_and_no_numbers_are_no_reason_to_move_wildly) {
  expect(avoid({}, 8, {}), 0, 0);
  const std::vector<double> wild = {NAN, -1, INFINITY, NAN, NAN};
  expect(avoid(wild, 8, {}), 0.2, 0);
}

}  // namespace
}  // namespace avoidance
