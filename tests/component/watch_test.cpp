// Those who look on while calls go in and out: what of a call in lock step depends on chance, and that looking costs nothing.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <string>
#include <thread>

#include "corba/members/member_watch.h"
#include "corba/orb/call_watch.h"

namespace {

using namespace std::chrono_literals;
using corba::nondeterminism_of_call;

constexpr std::uint64_t between = 8, in_phase = 9;

TEST(CallWatch, changes_from_outside_are_told_in_and_between_phases) {
  for (const std::uint64_t phase_counter : {between, in_phase}) {
    EXPECT_EQ(nondeterminism_of_call("set_configuration_set_values", phase_counter),
              "had its parameters changed by another process (set_configuration_set_values)");
    EXPECT_EQ(nondeterminism_of_call("activate_component", phase_counter),
              "had its state or a context changed by another process (activate_component)");
    EXPECT_EQ(nondeterminism_of_call("notify_disconnect", phase_counter),
              "had a connection made or ended by another process (notify_disconnect)");
  }
}

TEST(CallWatch, a_service_is_told_while_a_phase_runs) {
  EXPECT_EQ(nondeterminism_of_call("grasp", in_phase), "had a service called while a phase ran by another process (grasp)");
  EXPECT_EQ(nondeterminism_of_call("grasp", between), "");
  EXPECT_NE(nondeterminism_of_call("grasp", in_phase, in_phase - 2), "");  // of a tick that is over: somebody else's word
}

TEST(CallWatch, a_service_that_a_tick_of_the_phase_calls_is_not_told) {
  EXPECT_EQ(nondeterminism_of_call("grasp", in_phase, in_phase), "");
  EXPECT_NE(nondeterminism_of_call("set_configuration_set_values", in_phase, in_phase), "");
}

TEST(CallWatch, samples_callbacks_and_questions_are_not_told) {
  for (const char* operation :
       {"put", "push", "get", "on_execute", "on_state_update", "get_profile", "is_alive", "_is_a", "tick", "update_status"}) {
    EXPECT_EQ(nondeterminism_of_call(operation, in_phase), "") << operation;
    EXPECT_EQ(nondeterminism_of_call(operation, between), "") << operation;
  }
}

TEST(CallWatch, nothing_is_told_where_nothing_runs_in_lock_step) {
  for (const char* operation : {"set_configuration_set_values", "activate_component", "notify_connect", "grasp"})
    EXPECT_EQ(nondeterminism_of_call(operation, 0), "") << operation;
}

std::chrono::nanoseconds processor_time() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  const auto of = [](const timeval& time) { return std::chrono::seconds(time.tv_sec) + std::chrono::microseconds(time.tv_usec); };
  return of(use.ru_utime) + of(use.ru_stime);
}

// A watch that looked without a pause would take as much of a processor as it gets.
TEST(MemberWatch, a_call_that_lasts_costs_no_processor) {
  corba::MemberWatch watch;
  const std::string name = "Arm0";
  const auto before = processor_time();
  {
    const corba::MemberWatch::Call call(watch, name, "onExecute");
    std::this_thread::sleep_for(800ms);
  }
  EXPECT_LT(processor_time() - before, 30ms);
}

}  // namespace
