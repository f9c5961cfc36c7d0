// Which calls of other processes are taken, and what the log says of the others; over the wire: component_process_test.
#include "component/outside_calls.h"

#include <gtest/gtest.h>

#include "core/log_rate_limiter.h"

namespace {

using namespace std::chrono_literals;

TEST(OutsideCalls, all_callbacks_and_what_ends_a_component_are_looked_at) {
  for (const char* name :
       {"on_execute", "on_initialize", "on_rate_changed", "initialize", "finalize", "exit", "attach_context", "detach_context"})
    EXPECT_TRUE(RTC::is_watched_operation(name)) << name;
  for (const char* name : {"get_ports", "is_alive", "_is_a", "get_component_profile", "", "on"})
    EXPECT_FALSE(RTC::is_watched_operation(name)) << name;
}

TEST(OutsideCalls, a_handle_of_nobody_allows_nothing) {
  for (const auto action : {rt::Action::startup, rt::Action::shutdown, rt::Action::activated, rt::Action::deactivated, rt::Action::aborting,
                            rt::Action::error, rt::Action::reset, rt::Action::execute, rt::Action::state_update, rt::Action::rate_changed})
    EXPECT_TRUE(RTC::why_not(action, std::nullopt)) << rt::to_text(action);
}

// Every order in which this runtime calls a member: the table of core/lifecycle.h.
TEST(OutsideCalls, the_life_cycle_of_a_context_is_allowed_whatever_fails) {
  for (const rt::Transition& transition : rt::transitions) {
    bool active = transition.from == rt::State::active;
    const auto call = [&](rt::Action action) {
      EXPECT_FALSE(RTC::why_not(action, active)) << rt::to_text(transition.event) << ": " << rt::to_text(action);
      active = RTC::is_active_after(action, active);
    };
    const rt::StateActions& before = rt::actions_of(transition.from);
    if (before.execute) call(*before.execute);
    if (before.state_update) call(*before.state_update);
    if (transition.leave) call(*transition.leave);
    for (const rt::State to : {transition.to, transition.if_leave_fails}) {
      const bool was_active = active;
      const rt::StateActions& after = rt::actions_of(to);
      if (to != transition.from) {
        if (after.enter) call(*after.enter);
        if (after.execute) call(*after.execute);
        if (after.state_update) call(*after.state_update);
      }
      active = was_active;
    }
  }
}

TEST(OutsideCalls, the_log_has_one_line_a_second_and_counts_the_others) {
  rt::LogRateLimiter log;
  const std::chrono::steady_clock::time_point start{};
  EXPECT_EQ(log.next(start), 0u);
  for (int i = 0; i < 1999; ++i) EXPECT_EQ(log.next(start + 100us * i), std::nullopt);
  EXPECT_EQ(log.next(start + 1s), 1999u);
  EXPECT_EQ(log.next(start + 2s), 0u);
}

TEST(OutsideCalls, a_log_with_a_burst_has_so_many_lines_at_once_and_again_after_so_many_quiet_seconds) {
  rt::LogRateLimiter log(3);
  const std::chrono::steady_clock::time_point start{};
  const auto lines = [&](std::chrono::seconds at) {
    int count = 0;
    for (int i = 0; i < 100; ++i) count += log.next(start + at) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(lines(0s), 3);
  EXPECT_EQ(lines(1s), 1);
  EXPECT_EQ(lines(3s), 2);
  EXPECT_EQ(log.next(start + 100s), 98u);
  EXPECT_EQ(lines(100s), 2);
}

TEST(OutsideCalls, each_object_has_lines_about_refusals_of_its_own) {
  int lines = 0;
  for (int i = 0; i < 1000; ++i) lines += rt::rejection_line_end("a.port") ? 1 : 0;
  EXPECT_GE(lines, 10);
  EXPECT_LT(lines, 500) << "ten, and one per second";
  EXPECT_EQ(rt::rejection_line_end("another.port"), "");
}

}  // namespace
