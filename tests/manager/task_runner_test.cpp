#include "core/task_runner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <future>
#include <thread>

#include "core/signal_watcher.h"
#include "support/process.h"

namespace rt {
namespace {

using namespace std::chrono_literals;

TEST(TaskRunner, posted_tasks_run_in_order) {
  TaskRunner runner("test");
  std::vector<int> order;
  for (int i = 0; i < 10; ++i) runner.post([&order, i] { order.push_back(i); });
  runner.drain();
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(TaskRunner, a_periodic_task_runs_until_it_is_removed) {
  TaskRunner runner("test");
  std::promise<void> third;
  int runs = 0;
  const auto id = runner.add(
      [&] {
        if (++runs == 3) third.set_value();
      },
      1ms, 0ns);
  ASSERT_EQ(third.get_future().wait_for(support::watchdog), std::future_status::ready);
  EXPECT_TRUE(runner.remove(id));
  const int after = runs;
  runner.drain();
  EXPECT_EQ(runs, after);
  EXPECT_FALSE(runner.remove(id));
}

TEST(TaskRunner, a_task_runs_when_its_delay_has_passed_and_then_at_its_period) {
  ManualTime time;
  TaskRunner runner("test", time);
  std::promise<void> first, second;
  int runs = 0;
  runner.add([&] { ++runs == 1 ? first.set_value() : second.set_value(); }, 10s, 100s);
  time.advance(99s);
  runner.post([] {});
  runner.drain();
  EXPECT_EQ(runs, 0);
  time.advance(1s);
  ASSERT_EQ(first.get_future().wait_for(support::watchdog), std::future_status::ready);
  time.advance(10s);
  ASSERT_EQ(second.get_future().wait_for(support::watchdog), std::future_status::ready);
  runner.stop();
  EXPECT_EQ(runs, 2);
}

TEST(TaskRunner, runs_that_were_missed_are_skipped) {
  ManualTime time;
  TaskRunner runner("test", time);
  std::atomic<int> runs = 0;
  std::promise<void> first, next;
  runner.add(
      [&] {
        const int now = ++runs;
        if (now == 1) first.set_value();
        if (now == 2) next.set_value();
      },
      10s, 10s);
  time.advance(95s);  // nine are due at once
  ASSERT_EQ(first.get_future().wait_for(support::watchdog), std::future_status::ready);
  runner.post([] {});
  runner.drain();
  EXPECT_EQ(runs, 1);
  time.advance(5s);
  ASSERT_EQ(next.get_future().wait_for(support::watchdog), std::future_status::ready);
}

TEST(TaskRunner, a_task_may_remove_itself_and_throw) {
  TaskRunner runner("test");
  int runs = 0;
  std::promise<TaskRunner::TaskId> id;
  auto known = id.get_future().share();
  id.set_value(runner.add(
      [&, known] {
        ++runs;
        EXPECT_TRUE(runner.remove(known.get()));
        throw std::runtime_error("expected by the test");
      },
      1ms, 0ns));
  runner.post([] {});
  runner.drain();
  EXPECT_EQ(runs, 1);
}

TEST(TaskRunner, what_is_left_at_the_end_is_dropped_and_drain_does_not_hang) {
  TaskRunner runner("test");
  bool ran = false;
  runner.add([&] { ran = true; }, 0ns, 1h);
  runner.stop();
  runner.post([&] { ran = true; });
  runner.drain();
  EXPECT_FALSE(ran);
}

TEST(SignalWatcher, hands_a_signal_to_its_thread) {
  std::promise<int> got;
  SignalWatcher watcher({SIGUSR1}, [&](int number) { got.set_value(number); });
  raise(SIGUSR1);
  auto answer = got.get_future();
  ASSERT_EQ(answer.wait_for(support::watchdog), std::future_status::ready);
  EXPECT_EQ(answer.get(), SIGUSR1);
}

// As `timeout` does it. The first one is called for; the end of the watcher waits for the second.
TEST(SignalWatcher, takes_two_signals_that_come_together_for_one) {
  std::atomic<int> calls{0};
  {
    SignalWatcher watcher({SIGUSR1}, [&](int) { ++calls; });
    raise(SIGUSR1);
    raise(SIGUSR1);
  }
  EXPECT_EQ(calls, 1);
}

// Both while the first one is worked at, which may take as long as the end of a program.
TEST(SignalWatcher, reads_on_while_a_signal_is_worked_at) {
  std::promise<void> called, may_return;
  std::atomic<int> calls{0};
  {
    SignalWatcher watcher({SIGUSR1}, [&](int) {
      ++calls;
      called.set_value();
      may_return.get_future().wait_for(support::watchdog);
    });
    raise(SIGUSR1);
    ASSERT_EQ(called.get_future().wait_for(support::watchdog), std::future_status::ready);
    raise(SIGUSR1);  // within 50 ms
    struct sigaction present {};
    while (sigaction(SIGUSR1, nullptr, &present) == 0 && present.sa_handler != SIG_DFL) std::this_thread::yield();
    may_return.set_value();
  }
  EXPECT_EQ(calls, 1);
}

TEST(SignalWatcher, lets_a_later_signal_end_the_process) {
  EXPECT_EXIT(
      {
        std::promise<void> called;
        SignalWatcher watcher({SIGUSR1}, [&](int) {
          called.set_value();
          std::promise<void>().get_future().wait();
        });
        raise(SIGUSR1);
        called.get_future().wait();
        struct sigaction present {};
        while (sigaction(SIGUSR1, nullptr, &present) == 0 && present.sa_handler != SIG_DFL) std::this_thread::yield();
        raise(SIGUSR1);
      },
      testing::KilledBySignal(SIGUSR1), "");
}

TEST(SignalWatcher, leaves_handlers_of_the_program_alone) {
  static volatile std::sig_atomic_t handled = 0;
  signal(SIGUSR2, [](int) { handled = 1; });
  SignalWatcher watcher({SIGUSR2}, [](int) { FAIL(); });
  raise(SIGUSR2);
  EXPECT_EQ(handled, 1);
  signal(SIGUSR2, SIG_DFL);
}

}  // namespace
}  // namespace rt
