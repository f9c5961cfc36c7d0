// The rule by which Porter drives.
#include "delivery_rule.h"

#include <gtest/gtest.h>

#include <vector>

namespace warehouse {
namespace {

const Settings settings{.distance = 6, .speed = 0.4, .stop_distance = 1, .lane_width = 0.5, .start_time = 2};

TEST(Porter, it_waits_brings_returns_and_is_done) {
  EXPECT_EQ(next_stage(Stage::waiting, {}, 1.9, settings), Stage::waiting);
  EXPECT_EQ(next_stage(Stage::waiting, {}, 2, settings), Stage::bringing);
  EXPECT_EQ(next_stage(Stage::bringing, {5.9, 0, 0}, 10, settings), Stage::bringing);
  EXPECT_EQ(next_stage(Stage::bringing, {5.99, 0, 0}, 10, settings), Stage::returning);
  EXPECT_EQ(next_stage(Stage::returning, {0.5, 0, 0}, 20, settings), Stage::returning);
  EXPECT_EQ(next_stage(Stage::returning, {0.01, 0, 0}, 20, settings), Stage::done);
}

TEST(Porter, it_turns_back_to_its_line_in_both_directions) {
  for (const auto stage : {Stage::bringing, Stage::returning}) {
    Place place{3, 0.2, 0.1};
    for (int i = 0; i < 120; ++i) {  // 12 s
      const auto velocity = drive(stage, place, {.distance = 100, .speed = 0.4});
      place.heading += velocity.turn * 0.1;
      place.y += velocity.forward * place.heading * 0.1;
    }
    EXPECT_NEAR(place.y, 0, 0.02);
    EXPECT_NEAR(place.heading, 0, 0.02);
  }
}

TEST(Porter, it_drives_no_faster_than_told_slows_down_before_the_end_and_stands_when_it_is_done) {
  EXPECT_DOUBLE_EQ(drive(Stage::bringing, {3, 0, 0}, settings).forward, 0.4);
  EXPECT_DOUBLE_EQ(drive(Stage::returning, {3, 0, 0}, settings).forward, -0.4);
  EXPECT_LT(drive(Stage::bringing, {5.95, 0, 0}, settings).forward, 0.25);
  EXPECT_GT(drive(Stage::bringing, {6, 0, 0}, settings).forward, 0);
  for (const auto stage : {Stage::waiting, Stage::done}) EXPECT_EQ(drive(stage, {3, 1, 1}, settings).forward, 0);
}

TEST(Porter, only_what_is_near_and_in_the_lane_blocks_it) {
  const auto is_blocked_by = [](double range, double angle) {
    return is_blocked(std::vector{8.0, range, 8.0}, angle - 0.1, 0.1, settings);
  };
  EXPECT_TRUE(is_blocked_by(0.9, 0));
  EXPECT_FALSE(is_blocked_by(1.1, 0));
  EXPECT_FALSE(is_blocked_by(0.9, 0.5));  // beside the lane
  EXPECT_FALSE(is_blocked_by(0.9, 3));    // behind
  EXPECT_FALSE(is_blocked_by(0.05, 0));   // the robot itself
  EXPECT_FALSE(is_blocked({}, 0, 0.1, settings));
}

}  // namespace
}  // namespace warehouse
