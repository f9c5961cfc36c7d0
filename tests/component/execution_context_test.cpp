#include "core/execution_context.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <future>
#include <latch>
#include <limits>
#include <thread>

#include "base/guarded.h"
#include "base/log.h"
#include "base/waiting.h"
#include "core/workers.h"
#include "support/recording_participant.h"

namespace rt {

using namespace std::chrono_literals;
using support::RecordingParticipant;
using Answer = RecordingParticipant::Answer;
using testing::ElementsAre;
using testing::IsEmpty;

std::ostream& operator<<(std::ostream& out, Action action) { return out << to_text(action); }
std::ostream& operator<<(std::ostream& out, State state) { return out << to_text(state); }
std::ostream& operator<<(std::ostream& out, ReturnCode code) { return out << to_text(code); }

namespace {

struct Fixture : testing::Test {
  Fixture() : id(context.add(participant)) { context.start(), participant->take(); }

  void activate() {
    ASSERT_EQ(context.request(id, Event::activate), ReturnCode::ok);
    context.step();
    participant->take();
  }
  void fail() {
    activate();
    participant->answers[Action::execute] = Answer::error;
    context.step();
    context.step();
    participant->answers[Action::execute] = Answer::ok;
    participant->take();
    ASSERT_EQ(context.state(id), State::error);
  }

  std::shared_ptr<RecordingParticipant> participant = std::make_shared<RecordingParticipant>();
  ExecutionContext context;
  MemberId id;
};

using ExecutionContextTest = Fixture;

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

// --- with threads

struct PlainSteps final : Steps {
  explicit PlainSteps(ExecutionContext& stepped) : context(stepped) {}
  void transit() override { context.transit(); }
  void execute_and_update() override {
    context.execute();
    context.update();
  }
  ExecutionContext& context;
};

template <class Worker>
struct Running {
  template <class... Time>
  explicit Running(ExecutionContext& context, const Time&... time) : steps(context), worker(context, steps, time...) {
    context.on_wake([this] { worker.wake(); });
    thread = std::thread([this] { worker.run(); });
  }
  ~Running() {
    worker.stop();
    thread.join();
  }
  PlainSteps steps;
  Worker worker;
  std::thread thread;
};

// A component that waits for data in onExecute.
TEST_F(ExecutionContextTest, time_in_which_a_member_waits_is_no_work_and_makes_no_cycle_late) {
  activate();
  std::promise<void> enough;
  participant->during = [&, count = 0](Action action) mutable {
    if (action != Action::execute || count > 5) return;
    if (++count == 5) enough.set_value();
    const base::ScopedWait waiting;
    std::this_thread::sleep_for(30ms);
  };
  ASSERT_EQ(context.set_rate(1000), ReturnCode::ok);
  {
    Running<PeriodicWorker> running(context);
    enough.get_future().wait();
  }
  const ContextStatistics statistics = context.statistics();
  EXPECT_EQ(statistics.missed_cycles, 0u);
  EXPECT_GE(statistics.total_waiting, 4 * 30ms);
  EXPECT_LT(statistics.total_execution, statistics.total_waiting);
}

TEST_F(ExecutionContextTest, a_periodic_worker_answers_requests_at_once_at_any_rate) {
  context.set_rate(0.001);
  Running<PeriodicWorker> running(context);
  ASSERT_EQ(context.request(id, Event::activate), ReturnCode::ok);
  EXPECT_EQ(context.wait(id, Event::activate, 60s), ReturnCode::ok);
  ASSERT_EQ(context.request(id, Event::deactivate), ReturnCode::ok);
  EXPECT_EQ(context.wait(id, Event::deactivate, 60s), ReturnCode::ok);
}

TEST_F(ExecutionContextTest, a_periodic_worker_makes_a_cycle_for_each_period_that_passes) {
  ManualTime time;
  context.set_rate(0.1);
  Running<PeriodicWorker> running(context, time);
  context.request(id, Event::activate);
  ASSERT_EQ(context.wait(id, Event::activate, 60s), ReturnCode::ok);
  const auto cycles_are = [&](std::uint64_t count) {
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (context.statistics().cycles < count && std::chrono::steady_clock::now() < end) std::this_thread::yield();
    return context.statistics().cycles == count;
  };
  EXPECT_TRUE(cycles_are(1)) << "the first with the activation";
  for (std::uint64_t cycle = 2; cycle <= 5; ++cycle) {
    time.advance(10s);
    EXPECT_TRUE(cycles_are(cycle)) << cycle;
  }
  EXPECT_EQ(context.statistics().missed_cycles, 0u);
}

TEST_F(ExecutionContextTest, a_periodic_worker_gives_up_what_is_more_than_ten_periods_late) {
  ManualTime time;
  context.set_rate(0.1);
  Running<PeriodicWorker> running(context, time);
  context.request(id, Event::activate);
  ASSERT_EQ(context.wait(id, Event::activate, 60s), ReturnCode::ok);
  const auto missed_are = [&](std::uint64_t count) {
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (context.statistics().missed_cycles < count && std::chrono::steady_clock::now() < end) std::this_thread::yield();
    return context.statistics().missed_cycles == count;
  };
  time.advance(210s);  // 21 periods, of which one is the next
  EXPECT_TRUE(missed_are(20)) << context.statistics().missed_cycles;
}

TEST_F(ExecutionContextTest, removing_a_member_waits_for_the_call_in_progress) {
  std::mutex mutex;
  std::condition_variable condition;
  bool entered = false, leaving = false, left = false;
  participant->during = [&](Action action) {
    if (action != Action::execute) return;
    std::unique_lock lock(mutex);
    entered = true;
    condition.notify_all();
    condition.wait(lock, [&] { return leaving; });
    left = true;
  };
  Running<PeriodicWorker> running(context);
  context.request(id, Event::activate);
  {
    std::unique_lock lock(mutex);
    condition.wait(lock, [&] { return entered; });
  }
  EXPECT_FALSE(context.wait_until_quiet(1ms));
  {
    std::lock_guard lock(mutex);
    leaving = true;
  }
  condition.notify_all();
  EXPECT_EQ(context.remove(id), ExecutionContext::Removal::left_alone);
  std::lock_guard lock(mutex);
  EXPECT_TRUE(left);
}

TEST_F(ExecutionContextTest, every_tick_is_a_cycle_also_those_that_come_while_one_runs) {
  std::mutex mutex;
  std::condition_variable condition;
  int executed = 0;
  bool go = false;
  participant->during = [&](Action action) {
    if (action != Action::execute) return;
    std::unique_lock lock(mutex);
    condition.wait(lock, [&] { return go; });
    ++executed;
    condition.notify_all();
  };
  Running<TriggeredWorker> running(context);
  context.request(id, Event::activate);
  ASSERT_EQ(context.wait(id, Event::activate, 60s), ReturnCode::ok) << "without a tick";
  for (int i = 0; i < 1000; ++i) running.worker.tick();
  std::unique_lock lock(mutex);
  go = true;
  condition.notify_all();
  EXPECT_TRUE(condition.wait_for(lock, 60s, [&] { return executed == 1000; })) << executed;
}

TEST(Turns, a_thread_does_not_get_a_second_turn_inside_its_first) {
  Turns turns;
  int inner = 0;
  EXPECT_TRUE(turns.take([&] { EXPECT_FALSE(turns.take([&] { ++inner; })); }));
  EXPECT_EQ(inner, 0);
}

// A participant of another place; everybody writes into one list whom it has heard of and when it had done.
struct Elsewhere final : Participant {
  Elsewhere(std::string own_name, std::string own_place, std::function<void(Action)> work)
      : name_(std::move(own_name)), place_(std::move(own_place)), work_(std::move(work)) {}
  std::string name() const override { return name_; }
  std::string place() const override { return place_; }
  ReturnCode call(Action action) override { return work_(action), ReturnCode::ok; }

  const std::string name_, place_;
  const std::function<void(Action)> work_;
};

TEST(ExecutionContextPlaces, members_side_by_side_of_different_places_are_called_at_the_same_time_and_others_in_their_order) {
  ExecutionContext context;
  base::Guarded<std::vector<std::string>, base::Rank::buffer> heard;
  std::latch both{2};
  const auto add = [&](const std::string& name, const std::string& place, bool meets) {
    const auto work = [&, name, meets](Action action) {
      if (action != Action::execute) return;
      if (meets) both.arrive_and_wait();
      heard.lock()->push_back(name);
    };
    context.request(context.add(std::make_shared<Elsewhere>(name, place, work)), Event::activate);
  };
  add("here", "", false);
  add("first of a", "a", false);
  add("of b", "b", true);
  add("second of a", "a", true);
  add("here again", "", false);
  add("late of b", "b", false);
  context.start();
  context.step();
  const auto all = heard.snapshot();
  ASSERT_EQ(all.size(), 6U);
  EXPECT_EQ(all.front(), "here");
  EXPECT_EQ(all[1], "first of a");
  EXPECT_THAT(std::vector(all.begin() + 2, all.begin() + 4), testing::UnorderedElementsAre("of b", "second of a"));
  EXPECT_THAT(std::vector(all.begin() + 4, all.end()), ElementsAre("here again", "late of b"));
}

TEST(ExecutionContextPlaces, members_come_and_go_while_others_of_other_places_are_called) {
  ExecutionContext context;
  std::atomic<int> calls{0};
  std::vector<MemberId> members;
  const auto add = [&](const std::string& place) {
    const auto work = [&](Action action) {
      if (action == Action::execute) ++calls, calls.notify_all();
    };
    members.push_back(context.add(std::make_shared<Elsewhere>("one", place, work)));
    context.request(members.back(), Event::activate);
  };
  add("a");
  add("b");
  context.start();
  std::jthread stepping([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) context.step();
  });
  for (int n = 0; n < 100; ++n) {
    add(n % 2 ? "a" : "c");
    EXPECT_EQ(context.remove(members[static_cast<std::size_t>(n)]), ExecutionContext::Removal::left_alone);
  }
  calls.wait(0);
  stepping.request_stop();
  stepping.join();
  EXPECT_EQ(context.members().size(), 2U);
}

}  // namespace
}  // namespace rt
