// The group that ticks the contexts of a process, with the server's side of the lock step in the same process.
#include "tick_group.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "shm/barrier_support.h"

namespace shm::test {
namespace {

using iface::TickGroup;

// A context: joins, takes its place on a thread of its own as SimTimeContext does, and notes its ticks.
class TickedContext final : public TickGroup::Ticked {
 public:
  TickedContext(BarrierFixture& f, const std::string& name, std::chrono::milliseconds period = 10ms)
      : participant_(std::make_shared<Participant>(f.join(name, 1, period))),
        place_(std::make_unique<TickGroup::Place>(TickGroup::Key{static_cast<int>(f.id), 1, period}, participant_, *this)) {
    participant_.reset();
  }
  void run_tick(const Tick& tick) override {
    if (at_tick) at_tick();
    const std::lock_guard lock(mutex_);
    ticks.push_back(std::chrono::duration_cast<std::chrono::milliseconds>(tick.now).count());
    threads.push_back(std::this_thread::get_id());
  }
  void run_requests() override {
    const std::lock_guard lock(mutex_);
    ++requests_;
    changed_.notify_all();
  }
  void report_long_call() override {
    const std::lock_guard lock(mutex_);
    ++reports_;
    changed_.notify_all();
  }
  // That a call of it has not returned while its place is to end.
  bool await_report() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 60s, [&] { return reports_ > 0; });
  }
  int reports() {
    const std::lock_guard lock(mutex_);
    return reports_;
  }
  bool await_requests(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 60s, [&] { return requests_ >= count; });
  }
  TickGroup::Place& place() { return *place_; }
  void end() { place_.reset(); }

  std::function<void()> at_tick;
  std::vector<std::int64_t> ticks;
  std::vector<std::thread::id> threads;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int requests_ = 0, reports_ = 0;
  std::shared_ptr<Participant> participant_;
  std::unique_ptr<TickGroup::Place> place_;
};

void tick_until(BarrierFixture& f, int last_ms) {
  for (int ms = 0; ms <= last_ms; ms += 5) ASSERT_TRUE(f.barrier->tick(std::chrono::milliseconds(ms), static_cast<std::uint64_t>(ms)));
}

TEST(TickGroup, contexts_of_one_phase_and_period_are_all_called_in_each_tick_by_one_thread) {
  BarrierFixture f;
  std::vector<std::unique_ptr<TickedContext>> all;
  for (int i = 0; i < 10; ++i) all.push_back(std::make_unique<TickedContext>(f, "c" + std::to_string(i)));
  ASSERT_EQ(f.barrier->refresh(), 10U);
  tick_until(f, 30);
  for (const auto& one : all) {
    EXPECT_EQ(one->ticks, (std::vector<std::int64_t>{0, 10, 20, 30}));
    EXPECT_EQ(one->threads, std::vector<std::thread::id>(4, all.front()->threads.front()));
  }
}

TEST(TickGroup, contexts_with_other_periods_are_called_at_their_own_times) {
  BarrierFixture f;
  TickedContext fast(f, "fast", 5ms), slow(f, "slow", 15ms);
  tick_until(f, 30);
  EXPECT_EQ(fast.ticks, (std::vector<std::int64_t>{0, 5, 10, 15, 20, 25, 30}));
  EXPECT_EQ(slow.ticks, (std::vector<std::int64_t>{0, 15, 30}));
}

TEST(TickGroup, a_context_that_waits_for_another_one_of_its_group_does_not_stop_the_tick) {
  BarrierFixture f;
  std::atomic<int> reached{0};
  TickedContext first(f, "first"), second(f, "second"), third(f, "third");
  // Each returns when all three have been called: on one thread that would never be.
  for (auto* one : {&first, &second, &third}) {
    one->at_tick = [&, wanted = 3] {
      const int round = reached++ / wanted;
      while (reached < (round + 1) * wanted) std::this_thread::yield();
    };
  }
  tick_until(f, 20);
  for (const auto* one : {&first, &second, &third}) EXPECT_EQ(one->ticks, (std::vector<std::int64_t>{0, 10, 20}));
}

TEST(TickGroup, a_context_that_hangs_keeps_no_other_one_from_its_tick) {
  BarrierFixture f;
  std::atomic<bool> may_go_on{false};
  TickedContext hanging(f, "hanging"), other(f, "other");
  hanging.at_tick = [&] {
    while (!may_go_on) std::this_thread::yield();
  };
  std::atomic<int> called{0};
  other.at_tick = [&] { ++called; };
  std::thread server([&] { f.barrier->tick(0ms, 0); });
  while (called == 0) std::this_thread::yield();
  may_go_on = true;
  server.join();
  EXPECT_EQ(hanging.ticks, std::vector<std::int64_t>{0});
}

TEST(TickGroup, a_context_whose_call_hangs_while_its_place_ends_reports_that_once_and_the_place_ends_when_the_call_returns) {
  BarrierFixture f;
  std::atomic<bool> may_go_on{false}, is_called{false}, has_ended{false};
  TickedContext hanging(f, "hanging");
  hanging.at_tick = [&] {
    is_called = true;
    while (!may_go_on) std::this_thread::yield();
  };
  std::thread server([&] { f.barrier->tick(0ms, 0); });
  while (!is_called) std::this_thread::yield();
  std::thread ender([&] {
    hanging.end();
    has_ended = true;
  });
  EXPECT_TRUE(hanging.await_report());
  EXPECT_FALSE(has_ended);
  may_go_on = true;
  ender.join();
  server.join();
  EXPECT_EQ(hanging.reports(), 1);
}

TEST(TickGroup, one_that_leaves_is_no_longer_waited_for_and_the_others_go_on) {
  BarrierFixture f;
  auto first = std::make_unique<TickedContext>(f, "first");
  TickedContext second(f, "second");
  tick_until(f, 0);
  first.reset();
  for (int ms = 10; ms <= 20; ms += 10) f.barrier->tick(std::chrono::milliseconds(ms), 0);
  EXPECT_EQ(second.ticks, (std::vector<std::int64_t>{0, 10, 20}));
  EXPECT_EQ(f.barrier->refresh(), 1U);
}

TEST(TickGroup, one_that_joins_later_is_called_from_the_next_tick_on) {
  BarrierFixture f;
  TickedContext first(f, "first");
  tick_until(f, 5);
  TickedContext second(f, "second");
  for (int ms = 10; ms <= 30; ms += 10) f.barrier->tick(std::chrono::milliseconds(ms), 0);
  EXPECT_EQ(first.ticks, (std::vector<std::int64_t>{0, 10, 20, 30}));
  EXPECT_EQ(second.ticks, (std::vector<std::int64_t>{10, 20, 30}));
}

TEST(TickGroup, requests_are_seen_to_while_no_tick_comes) {
  BarrierFixture f;
  TickedContext first(f, "first"), second(f, "second");
  ASSERT_TRUE(first.await_requests(1));
  for (int n = 2; n < 20; ++n) {
    first.place().wake();
    second.place().wake();
    ASSERT_TRUE(first.await_requests(n) && second.await_requests(n));
  }
}

TEST(TickGroup, wait_reports_that_the_context_leaves_was_dropped_or_that_the_simulator_has_exited) {
  BarrierFixture f;
  TickedContext leaves(f, "leaves"), dropped(f, "dropped"), closed(f, "closed");
  tick_until(f, 0);
  leaves.place().leave();
  EXPECT_EQ(leaves.place().wait(), State::timed_out);
  ASSERT_TRUE(f.barrier->drop("dropped"));
  EXPECT_EQ(dropped.place().wait(), State::dropped);
  TickedContext alone(f, "alone", 30ms);
  f.barrier->refresh();
  ASSERT_TRUE(f.barrier->drop("alone"));
  EXPECT_EQ(alone.place().wait(), State::dropped);
  f.barrier.reset();
  EXPECT_EQ(closed.place().wait(), State::closed);
}

TEST(TickGroup, contexts_come_and_go_while_ticks_run) {
  BarrierFixture f({}, 64);
  std::atomic<bool> is_over{false};
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      for (int n = 0; !is_over; ++n) {
        TickedContext a(f, "a" + std::to_string(i)), b(f, "b" + std::to_string(i), n % 2 == 0 ? 10ms : 20ms);
        a.place().wake();
        std::this_thread::yield();
      }
    });
  }
  for (int n = 0; n < 300; ++n) ASSERT_TRUE(f.barrier->tick(n * 10ms, 0));
  is_over = true;
  std::thread server([&] {
    for (int n = 300; f.barrier->refresh() > 0; ++n) f.barrier->tick(n * 10ms, 0);
  });
  for (auto& thread : threads) thread.join();
  server.join();
}

}  // namespace
}  // namespace shm::test
