#include "base/guarded.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/beneath.h"
#include "base/child_process.h"
#include "base/content_hash.h"
#include "base/hash_log.h"
#include "base/peer_account.h"
#include "base/plain_file.h"
#include "base/whole_file.h"

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

// Operations that may wait for a disk, another process or the kernel's tables.
const std::vector<std::pair<std::string, std::function<void()>>>& slow_operations() {
  const std::string none = "/nowhere/none";
  static const std::vector<std::pair<std::string, std::function<void()>>> all = {
      {"write_whole_file", [=] { static_cast<void>(write_whole_file(none, "")); }},
      {"read_plain_file", [=] { static_cast<void>(read_plain_file(none, 1)); }},
      {"is_plain_file", [=] { static_cast<void>(is_plain_file(none)); }},
      {"read_beneath", [=] { static_cast<void>(read_beneath("/nowhere", "none", 1)); }},
      {"check_regular_file", [=] { static_cast<void>(check_regular_file(none)); }},
      {"ContentHash::add_file", [=] { static_cast<void>(ContentHash().add_file(none)); }},
      {"HashLogWriter::create", [=] { static_cast<void>(HashLogWriter::create(none)); }},
      {"HashLogReader::open", [=] { static_cast<void>(HashLogReader::open(none)); }},
      {"account_of",
       [] {
         static_cast<void>(account_of(TcpEnd{"127.0.0.1", 1}, TcpEnd{"127.0.0.1", 2}));
       }},
      {"ChildProcess::start",
       [=] {
         static_cast<void>(base::ChildProcess::start({{none}, {}}));
       }},
  };
  return all;
}

TEST(GuardedDeathTest, a_file_or_a_process_that_is_used_while_data_is_held_is_found) {
  Guarded<int, Rank::component> data(0);
  for (const auto& [name, operation] : slow_operations()) {
    EXPECT_DEATH(
        {
          auto lock = data.lock();
          operation();
        },
        "data is held")
        << name;
  }
}

TEST(Turn, leaves_the_thread_free_to_use_files) {
  Turn<> turn;
  const auto mine = turn.take();
  EXPECT_FALSE(read_plain_file("/nowhere/none", 1));
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
