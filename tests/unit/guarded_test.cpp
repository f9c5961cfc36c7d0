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

#ifndef NDEBUG
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
