// Execution contexts on threads of their own.
#include "core/workers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <latch>
#include <thread>

#include "base/guarded.h"
#include "base/log.h"
#include "base/waiting.h"
#include "support/context_fixture.h"

namespace rt::workers {

using namespace std::chrono_literals;
using support::RecordingParticipant;
using testing::ElementsAre;
using testing::IsEmpty;

namespace {

using ExecutionContextTest = support::ContextFixture;

struct PlainSteps final : Steppable {
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

TEST_F(ExecutionContextTest, who_waits_for_longer_than_its_period_misses_no_cycle_on_a_busy_machine) {
  ManualTime time;
  activate();
  ASSERT_EQ(context.set_rate(1000), ReturnCode::ok);
  std::promise<void> enough;
  participant->during = [&, count = 0](Action action) mutable {
    if (action != Action::execute || count > 3) return;
    {
      const base::ScopedWait waiting;
      std::this_thread::sleep_for(2ms);
    }
    time.advance(10s);  // its thread gets no processor
    if (++count == 3) enough.set_value();
  };
  {
    Running<PeriodicWorker> running(context, time);
    enough.get_future().wait();
  }
  EXPECT_EQ(context.statistics().missed_cycles, 0u);
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
  CallSerializer turns;
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
  base::Guarded<std::vector<std::string>, base::Rank::queue> heard;
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
}  // namespace rt::workers
