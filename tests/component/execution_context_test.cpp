#include "core/execution_context.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <set>
#include <thread>

#include "base/log.h"
#include "support/context_fixture.h"
#include "support/memory_limit.h"

namespace rt {

using namespace std::chrono_literals;
using support::RecordingParticipant;
using Answer = RecordingParticipant::Answer;
using testing::ElementsAre;
using testing::IsEmpty;

namespace {

using ExecutionContextTest = support::ContextFixture;

struct Expectation {
  State state;
  Event event;
  ReturnCode code;
  State after;
};

// Every state with every request.
TEST_F(ExecutionContextTest, answers_each_request_as_the_table_says) {
  const auto no = ReturnCode::precondition_not_met;
  const Expectation table[] = {
      {State::inactive, Event::activate, ReturnCode::ok, State::active},
      {State::inactive, Event::deactivate, no, State::inactive},
      {State::inactive, Event::reset, no, State::inactive},
      {State::active, Event::activate, no, State::active},
      {State::active, Event::deactivate, ReturnCode::ok, State::inactive},
      {State::active, Event::reset, no, State::active},
      {State::error, Event::activate, no, State::error},
      {State::error, Event::deactivate, no, State::error},
      {State::error, Event::reset, ReturnCode::ok, State::inactive},
  };
  for (const Expectation& expected : table) {
    ExecutionContext fresh;
    auto member = std::make_shared<RecordingParticipant>();
    const MemberId who = fresh.add(member);
    fresh.start();
    if (expected.state != State::inactive) {
      fresh.request(who, Event::activate);
      fresh.step();
    }
    if (expected.state == State::error) {
      member->answers[Action::execute] = Answer::error;
      fresh.step();
      fresh.step();
    }
    ASSERT_EQ(fresh.state(who), expected.state);
    EXPECT_EQ(fresh.request(who, expected.event), expected.code) << to_text(expected.state) << " " << to_text(expected.event);
    EXPECT_EQ(fresh.state(who), expected.state) << "nothing changes before the next cycle";
    fresh.step();
    EXPECT_EQ(fresh.state(who), expected.after) << to_text(expected.state) << " " << to_text(expected.event);
  }
}

TEST_F(ExecutionContextTest, calls_startup_and_shutdown_once_each) {
  EXPECT_EQ(context.start(), ReturnCode::precondition_not_met);
  EXPECT_EQ(context.stop(), ReturnCode::ok);
  EXPECT_EQ(context.stop(), ReturnCode::precondition_not_met);
  EXPECT_EQ(context.start(), ReturnCode::ok);
  EXPECT_THAT(participant->take(), ElementsAre(Action::shutdown, Action::startup));
}

TEST_F(ExecutionContextTest, activates_and_executes_in_the_same_cycle) {
  ASSERT_EQ(context.request(id, Event::activate), ReturnCode::ok);
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::activated, Action::execute, Action::state_update));
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::execute, Action::state_update));
}

TEST_F(ExecutionContextTest, does_not_call_an_inactive_component) {
  context.step();
  EXPECT_THAT(participant->take(), IsEmpty());
}

TEST_F(ExecutionContextTest, deactivates_before_anything_is_executed) {
  activate();
  ASSERT_EQ(context.request(id, Event::deactivate), ReturnCode::ok);
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::deactivated));
  EXPECT_EQ(context.state(id), State::inactive);
}

TEST_F(ExecutionContextTest, failing_execute_leads_to_deactivated_aborting_and_error_in_each_cycle) {
  activate();
  participant->answers[Action::execute] = Answer::error;
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::execute)) << "no state update after a failure";
  EXPECT_EQ(context.state(id), State::active);
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::deactivated, Action::aborting, Action::error));
  EXPECT_EQ(context.state(id), State::error);
  context.step();
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::error, Action::error));
}

TEST_F(ExecutionContextTest, failing_state_update_leads_to_error) {
  activate();
  participant->answers[Action::state_update] = Answer::error;
  context.step();
  context.step();
  EXPECT_EQ(context.state(id), State::error);
}

TEST_F(ExecutionContextTest, failing_activation_leads_to_error_in_the_next_cycle) {
  participant->answers[Action::activated] = Answer::error;
  context.request(id, Event::activate);
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::activated));
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::deactivated, Action::aborting, Action::error));
  EXPECT_EQ(context.state(id), State::error);
  EXPECT_EQ(context.wait(id, Event::activate, 0s), ReturnCode::precondition_not_met);
}

TEST_F(ExecutionContextTest, failing_deactivation_leads_to_error_at_once) {
  activate();
  participant->answers[Action::deactivated] = Answer::error;
  context.request(id, Event::deactivate);
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::deactivated, Action::aborting, Action::error));
  EXPECT_EQ(context.state(id), State::error);
  EXPECT_EQ(context.wait(id, Event::deactivate, 0s), ReturnCode::precondition_not_met);
}

TEST_F(ExecutionContextTest, failures_on_the_way_to_error_change_nothing) {
  activate();
  for (const Action action : {Action::execute, Action::deactivated, Action::aborting, Action::error})
    participant->answers[action] = Answer::error;
  context.step();
  participant->take();
  context.step();
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::deactivated, Action::aborting, Action::error, Action::error));
  EXPECT_EQ(context.state(id), State::error);
}

TEST_F(ExecutionContextTest, reset_leads_to_inactive) {
  fail();
  ASSERT_EQ(context.request(id, Event::reset), ReturnCode::ok);
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::reset));
  EXPECT_EQ(context.state(id), State::inactive);
  EXPECT_EQ(context.wait(id, Event::reset, 0s), ReturnCode::ok);
}

TEST_F(ExecutionContextTest, failing_reset_stays_in_error_without_aborting_again) {
  fail();
  participant->answers[Action::reset] = Answer::error;
  context.request(id, Event::reset);
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::reset, Action::error));
  EXPECT_EQ(context.state(id), State::error);
  EXPECT_EQ(context.wait(id, Event::reset, 0s), ReturnCode::precondition_not_met);
}

TEST_F(ExecutionContextTest, turns_every_kind_of_exception_into_one_log_line_and_an_error) {
  for (const Answer answer : {Answer::std_exception, Answer::other_exception}) {
    std::vector<std::string> lines;
    base::set_log_sink([&](const base::LogRecord& record) { lines.emplace_back(record.message); });
    ExecutionContext fresh;
    auto thrower = std::make_shared<RecordingParticipant>();
    const MemberId who = fresh.add(thrower);
    fresh.start();
    fresh.request(who, Event::activate);
    fresh.step();
    thrower->answers[Action::execute] = answer;
    fresh.step();
    fresh.step();
    base::set_log_sink({});
    EXPECT_EQ(fresh.state(who), State::error);
    EXPECT_THAT(lines, ElementsAre(testing::HasSubstr("on_execute of recorder threw")));
  }
}

TEST_F(ExecutionContextTest, an_error_is_not_undone_by_a_request_of_the_same_cycle) {
  activate();
  participant->answers[Action::execute] = Answer::error;
  context.step();
  EXPECT_EQ(context.request(id, Event::deactivate), ReturnCode::precondition_not_met);
  context.step();
  EXPECT_EQ(context.state(id), State::error);
}

TEST_F(ExecutionContextTest, keeps_a_state_per_member) {
  auto other = std::make_shared<RecordingParticipant>();
  const MemberId second = context.add(other);
  activate();
  EXPECT_EQ(context.state(id), State::active);
  EXPECT_EQ(context.state(second), State::inactive);
  EXPECT_THAT(other->take(), IsEmpty());
}

TEST_F(ExecutionContextTest, one_that_fails_does_not_disturb_the_others) {
  auto other = std::make_shared<RecordingParticipant>();
  const MemberId second = context.add(other);
  activate();
  context.request(second, Event::activate);
  participant->answers[Action::execute] = Answer::std_exception;
  base::set_log_sink([](const base::LogRecord&) {});
  for (int i = 0; i < 3; ++i) context.step();
  base::set_log_sink({});
  EXPECT_EQ(other->count(Action::execute), 3u);
}

TEST_F(ExecutionContextTest, runs_the_phases_for_all_members_one_after_the_other) {
  std::vector<std::pair<int, Action>> order;
  auto other = std::make_shared<RecordingParticipant>();
  const MemberId second = context.add(other);
  participant->during = [&](Action action) { order.emplace_back(1, action); };
  other->during = [&](Action action) { order.emplace_back(2, action); };
  context.request(id, Event::activate);
  context.request(second, Event::activate);
  context.step();
  EXPECT_THAT(order, ElementsAre(std::pair(1, Action::activated), std::pair(2, Action::activated), std::pair(1, Action::execute),
                                 std::pair(2, Action::execute), std::pair(1, Action::state_update), std::pair(2, Action::state_update)));
}

// Members of so many processes, or of one that has so many addresses.
struct Elsewhere final : Participant {
  explicit Elsewhere(std::string where) : place_(std::move(where)) {}
  std::string name() const override { return place_; }
  std::string place() const override { return place_; }
  ReturnCode call(Action action) override {
    if (action != Action::execute) return ReturnCode::ok;
    ++calls;
    thread = std::this_thread::get_id();
    return ReturnCode::ok;
  }
  int calls = 0;
  std::thread::id thread{};

 private:
  std::string place_;
};

struct ManyElsewhere : ExecutionContextTest {
  void step_with(int count) {
    for (int i = 0; i < count; ++i) {
      members.push_back(std::make_shared<Elsewhere>("host:" + std::to_string(i)));
      ASSERT_EQ(context.request(context.add(members.back()), Event::activate), ReturnCode::ok);
    }
    context.step();
  }
  int called() const {
    return static_cast<int>(std::ranges::count_if(members, [](const auto& member) { return member->calls == 1; }));
  }
  std::vector<std::shared_ptr<Elsewhere>> members;
};

TEST_F(ManyElsewhere, are_called_on_a_limited_number_of_threads) {
  step_with(300);
  std::set<std::thread::id> threads;
  for (const auto& member : members) threads.insert(member->thread);
  EXPECT_EQ(threads.size(), 64u);
  EXPECT_EQ(called(), 300);
}

TEST_F(ManyElsewhere, are_called_one_after_another_when_there_is_no_thread_left) {
  if (!sim::test::MemoryLimit::is_kept) GTEST_SKIP() << "sanitizers need the memory";
  const sim::test::MemoryLimit limit(std::size_t{64} << 20);  // for a few stacks
  step_with(60);
  EXPECT_EQ(called(), 60);
}

TEST_F(ExecutionContextTest, knows_nothing_of_those_who_are_no_members) {
  EXPECT_EQ(context.state(99), State::created);
  EXPECT_EQ(context.request(99, Event::activate), ReturnCode::bad_parameter);
  EXPECT_EQ(context.wait(99, Event::activate, 0s), ReturnCode::bad_parameter);
  EXPECT_EQ(context.remove(99), ExecutionContext::Removal::no_member);
  EXPECT_THAT(context.participants(), ElementsAre(participant));
}

TEST_F(ExecutionContextTest, a_member_may_leave_inside_its_own_callback) {
  activate();
  participant->during = [&](Action action) {
    if (action == Action::execute) {
      EXPECT_EQ(context.remove(id), ExecutionContext::Removal::left_alone);
    }
  };
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::execute));
  context.step();
  EXPECT_THAT(participant->take(), IsEmpty());
  EXPECT_EQ(context.state(id), State::created);
}

TEST_F(ExecutionContextTest, does_nothing_while_it_is_stopped) {
  activate();
  context.stop();
  participant->take();
  context.step();
  EXPECT_THAT(participant->take(), IsEmpty());
  context.start();
  context.step();
  EXPECT_THAT(participant->take(), ElementsAre(Action::startup, Action::execute, Action::state_update));
}

TEST_F(ExecutionContextTest, refuses_rates_that_are_none) {
  for (const double rate : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e308, 1e-300})
    EXPECT_EQ(context.set_rate(rate), ReturnCode::bad_parameter) << rate;
  EXPECT_EQ(context.rate(), 1000.0);
  EXPECT_THAT(participant->take(), IsEmpty());
  EXPECT_EQ(context.set_rate(50), ReturnCode::ok);
  EXPECT_EQ(context.period(), 20ms);
  EXPECT_THAT(participant->take(), ElementsAre(Action::rate_changed));
}

TEST_F(ExecutionContextTest, does_not_wait_on_the_stepping_thread) {
  activate();
  participant->during = [&](Action action) {
    if (action != Action::execute) return;
    EXPECT_EQ(context.request(id, Event::deactivate), ReturnCode::ok);
    EXPECT_EQ(context.wait(id, Event::deactivate, 1h), ReturnCode::ok);
  };
  context.step();
  context.step();
  EXPECT_EQ(context.state(id), State::inactive);
}

TEST_F(ExecutionContextTest, a_wait_ends_with_an_error_when_the_time_is_over) {
  context.request(id, Event::activate);
  EXPECT_EQ(context.wait(id, Event::activate, 1ms), ReturnCode::error);
}

TEST_F(ExecutionContextTest, a_wait_for_a_running_context_ends_when_it_stops) {
  ASSERT_EQ(context.request(id, Event::activate), ReturnCode::ok);
  auto stopped = std::async(std::launch::async, [this] { return context.wait_while_running(id, Event::activate, 60s); });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(context.stop(), ReturnCode::ok);
  EXPECT_EQ(stopped.get(), ReturnCode::error);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 30s) << "not the whole time-out";
}

TEST_F(ExecutionContextTest, is_idle_while_nobody_is_active_or_about_to_be) {
  EXPECT_TRUE(context.is_idle());
  context.request(id, Event::activate);
  EXPECT_FALSE(context.is_idle());
  context.step();
  EXPECT_FALSE(context.is_idle());
  context.request(id, Event::deactivate);
  context.step();
  EXPECT_TRUE(context.is_idle());
}

TEST_F(ExecutionContextTest, counts_cycles_and_their_time) {
  activate();
  for (int i = 0; i < 9; ++i) context.step();
  context.count_missed(3);
  const ContextStatistics statistics = context.statistics();
  EXPECT_EQ(statistics.cycles, 10u);
  EXPECT_EQ(statistics.missed_cycles, 3u);
  EXPECT_GT(statistics.mean_execution(), 0ns);
  EXPECT_GE(statistics.max_execution, statistics.mean_execution());
}

}  // namespace
}  // namespace rt
