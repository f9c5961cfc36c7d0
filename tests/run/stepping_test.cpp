#include "run/stepping.h"

#include <gtest/gtest.h>

#include "run/fake_simulator.h"

namespace tools {
namespace {

using test::FakeSimulator;

TEST(Stepping, steps_are_made_and_their_progress_is_reported) {
  FakeSimulator simulator;
  simulator.looks_until_done = 3;
  std::vector<double> times;
  int looks = 0;
  const auto alive = [&] {
    ++looks;
    return base::Result<void>();
  };
  const auto made = make_steps(simulator, 10, {.alive = alive, .passed = [&](double time) { times.push_back(time); }});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(simulator.steps_done, 13);
  EXPECT_EQ(times, (std::vector<double>{0.001, 0.002, 0.003}));
  EXPECT_EQ(looks, 4);
}

TEST(Stepping, the_end_of_a_process_ends_the_wait) {
  FakeSimulator simulator;
  simulator.is_stuck = true;
  const auto made = make_steps(simulator, 10, {.alive = [] { return base::Result<void>(base::Error{"rtcd has exited"}); }});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().message, "rtcd has exited");
}

TEST(Stepping, a_simulator_that_has_exited_is_named_by_the_reason_of_its_end) {
  FakeSimulator simulator;
  simulator.broken = base::Error{"server 42 has ended"};
  const auto unknown = make_steps(simulator, 10, {});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().message, "server 42 has ended");
  simulator.broken.reset();
  simulator.looks_until_done = 1;
  int looks = 0;
  const auto alive = [&] {
    simulator.broken = base::Error{"server 42 has ended"};
    return ++looks < 4 ? base::Result<void>() : base::Result<void>(base::Error{"sim-server was killed by signal 9"});
  };
  const auto made = make_steps(simulator, 10, {.alive = alive});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().message, "sim-server was killed by signal 9");
}

TEST(Stepping, a_tick_that_does_not_end_is_given_up_and_its_participant_is_named) {
  FakeSimulator simulator;
  simulator.is_stuck = true;
  simulator.there = {{"Fast0", 1, std::chrono::milliseconds(10), false}, {"Slow0", 1, std::chrono::milliseconds(10), true}};
  const auto made = make_steps(simulator, 10, {.hang_timeout_s = 0.02});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().message, "Slow0: did not finish its tick at 0 s after 0.02 s (--hang-timeout)");
  simulator.there.clear();
  const auto alone = make_steps(simulator, 10, {.hang_timeout_s = 0.02});
  EXPECT_EQ(alone.error().message, "the simulator did not finish the step at 0 s after 0.02 s (--hang-timeout)");
}

}  // namespace
}  // namespace tools
