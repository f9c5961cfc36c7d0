#include "base/guarded.h"

#include <gtest/gtest.h>

#include <thread>

namespace base {
namespace {

TEST(Guarded, increments_from_several_threads_are_all_counted) {
  Guarded<int, Rank::component> counter(0);
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int n = 0; n < 1000; ++n) ++*counter.lock();
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(counter.snapshot(), 4000);
}

TEST(Guarded, a_wait_ends_when_the_predicate_holds) {
  Guarded<bool, Rank::component> ready(false);
  std::condition_variable changed;
  std::thread setter([&] {
    *ready.lock() = true;
    changed.notify_all();
  });
  auto lock = ready.lock();
  EXPECT_TRUE(lock.wait_for(changed, std::chrono::seconds(60), [&] { return *lock; }));
  setter.join();
}

TEST(Guarded, a_wait_for_nothing_times_out) {
  Guarded<bool, Rank::component> never(false);
  std::condition_variable changed;
  auto lock = never.lock();
  EXPECT_FALSE(lock.wait_for(changed, std::chrono::milliseconds(1), [&] { return *lock; }));
}

TEST(Guarded, a_thread_that_waits_for_work_ends_when_it_is_asked_to_stop) {
  Guarded<bool, Rank::component> work(false);
  std::condition_variable_any changed;
  std::jthread worker([&](const std::stop_token& stop) {
    auto lock = work.lock();
    EXPECT_FALSE(lock.wait(changed, stop, [&] { return *lock; }));
  });
  worker.request_stop();
  worker.join();
}

TEST(Turn, is_had_by_one_thread_at_a_time) {
  Turn<> turn;
  int counter = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int n = 0; n < 1000; ++n) {
        const auto mine = turn.take();
        ++counter;
      }
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(counter, 4000);
}

TEST(Turn, leaves_the_thread_free_to_call_others) {
  Turn<> turn;
  const auto mine = turn.take();
  expect_no_data_held();
}

TEST(UsersTurn, is_had_again_by_the_thread_that_has_it_and_by_nobody_else) {
  UsersTurn turn;
  const auto mine = turn.take(std::chrono::seconds(60));
  ASSERT_TRUE(mine);
  EXPECT_TRUE(turn.take(std::chrono::seconds(60)));
  std::thread([&] { EXPECT_FALSE(turn.take(std::chrono::milliseconds(1))); }).join();
}

TEST(UsersTurn, comes_to_the_next_thread_when_it_is_given_back) {
  UsersTurn turn;
  { const auto mine = turn.take(std::chrono::seconds(60)); }
  std::thread([&] { EXPECT_TRUE(turn.take(std::chrono::seconds(60))); }).join();
}

#ifndef NDEBUG
TEST(GuardedDeathTest, a_call_to_others_while_data_is_held_is_found) {
  Guarded<int, Rank::component> data(0);
  EXPECT_DEATH(
      {
        auto lock = data.lock();
        expect_no_data_held();
      },
      "data is held");
}

TEST(TurnDeathTest, a_turn_that_is_taken_while_data_is_held_is_found) {
  Guarded<int, Rank::component> data(0);
  Turn<> turn;
  EXPECT_DEATH(
      {
        auto lock = data.lock();
        auto mine = turn.take();
      },
      "ascending rank");
}

TEST(GuardedDeathTest, locks_taken_in_the_wrong_order_are_found) {
  Guarded<int, Rank::component> inner(0);
  Guarded<int, Rank::manager> outer(0);
  EXPECT_DEATH(
      {
        auto first = inner.lock();
        auto second = outer.lock();
      },
      "ascending rank");
}
#endif

}  // namespace
}  // namespace base
