// When steps are due by the clock on the wall, and what is said of the rate; the clock is moved by hand.
#include "server/pace.h"

#include <gtest/gtest.h>

#include "server/mode.h"

namespace sim {
namespace {

using namespace std::chrono_literals;

const Pace::Wall noon{std::chrono::hours(12)};

TEST(Pace, a_step_is_due_after_its_simulated_time_over_the_factor) {
  Pace pace(2);
  pace.start(noon, 10s);
  EXPECT_EQ(pace.due(noon, 11s), noon + 500ms);
}

TEST(Pace, no_step_is_due_while_it_goes_as_fast_as_possible) {
  Pace pace(0);
  pace.start(noon, 0s);
  EXPECT_FALSE(pace.due(noon, 1s));
  EXPECT_FALSE(pace.shortfall(noon + 1h, 1s));
}

TEST(Pace, what_is_lost_when_it_falls_far_behind_is_not_caught_up) {
  Pace pace(1);
  pace.start(noon, 0s);
  EXPECT_EQ(pace.due(noon + 1400ms, 1s), noon + 1s) << "a little is";
  EXPECT_FALSE(pace.due(noon + 1600ms, 1s));
  EXPECT_EQ(pace.due(noon + 1600ms, 2s), noon + 2600ms);
}

TEST(Pace, rate_and_load_are_those_of_the_last_second) {
  Pace pace(1);
  pace.start(noon, 0s);
  pace.add_sleep(250ms);
  EXPECT_FALSE(pace.measure(noon + 999ms, 500ms));
  EXPECT_TRUE(pace.measure(noon + 1s, 500ms));
  EXPECT_DOUBLE_EQ(pace.reached(), 0.5);
  EXPECT_DOUBLE_EQ(pace.load(), 0.75);
  EXPECT_TRUE(pace.measure(noon + 2s, 1500ms));
  EXPECT_DOUBLE_EQ(pace.reached(), 1);
  EXPECT_DOUBLE_EQ(pace.load(), 1);
}

TEST(Pace, a_jump_of_simulated_time_is_no_rate) {
  Pace pace(1);
  pace.start(noon, 100s);
  pace.restart_measurement(noon + 500ms, 0s);
  EXPECT_TRUE(pace.measure(noon + 1500ms, 1s));
  EXPECT_DOUBLE_EQ(pace.reached(), 1);
}

TEST(Pace, a_shortfall_is_told_once_for_each_ten_seconds_of_it) {
  Pace pace(1);
  pace.start(noon, 0s);
  EXPECT_FALSE(pace.shortfall(noon + 9s, 1s)) << "not yet";
  EXPECT_EQ(pace.shortfall(noon + 10s, 5s), 0.5);
  EXPECT_FALSE(pace.shortfall(noon + 11s, 5s));
  EXPECT_FALSE(pace.shortfall(noon + 20s, 15s)) << "as fast as wanted";
}

TEST(Pace, a_new_start_forgets_the_shortfall_before) {
  Pace pace(1);
  pace.start(noon, 0s);
  pace.start(noon + 9s, 1s);
  EXPECT_FALSE(pace.shortfall(noon + 10s, 2s));
}

TEST(Mode, stands_still_after_the_steps_that_were_asked_for) {
  Mode mode(true);
  EXPECT_TRUE(mode.stands_still());
  mode.make_steps(2, false);
  EXPECT_FALSE(mode.stands_still());
  EXPECT_TRUE(mode.hurries());
  EXPECT_FALSE(mode.count_step());
  EXPECT_TRUE(mode.count_step()) << "the last";
  EXPECT_TRUE(mode.stands_still());
  EXPECT_FALSE(mode.hurries());
}

TEST(Mode, steps_at_the_pace_of_the_wall_do_not_hurry) {
  Mode mode(false);
  mode.make_steps(1, true);
  EXPECT_FALSE(mode.hurries());
  EXPECT_FALSE(mode.stands_still());
}

TEST(Mode, runs_on_when_it_is_told_to_during_steps) {
  Mode mode(true);
  mode.make_steps(1, false);
  mode.run();
  EXPECT_TRUE(mode.count_step());
  EXPECT_FALSE(mode.stands_still());
  EXPECT_FALSE(mode.count_step()) << "nobody asked for the next one";
}

TEST(Mode, steps_that_are_ended_are_told) {
  Mode mode(true);
  mode.make_steps(5, false);
  EXPECT_FALSE(mode.count_step());
  EXPECT_EQ(mode.end_steps(), 4u);
  EXPECT_TRUE(mode.stands_still());
}

}  // namespace
}  // namespace sim
