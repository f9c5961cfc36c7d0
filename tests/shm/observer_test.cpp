// Participants that only look.
#include <gtest/gtest.h>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "shm/barrier_support.h"

namespace shm::test {
namespace {

// Of one that only looks.
Participant join_observer(const BarrierFixture& f, std::chrono::nanoseconds period = 10ms) {
  auto participant = Participant::join(f.id, {.name = "observer", .period = period, .observes = true});
  if (!participant) throw std::runtime_error(participant.error().message);
  return std::move(*participant);
}

TEST(Observer, comes_last_and_is_waited_for_when_samples_are_to_be_written) {
  BarrierFixture f;
  std::vector<std::string> order;  // unguarded on purpose, as everything below
  auto client = run(f.join("client", 15, 10ms), [&](const Tick&) { order.emplace_back("client"); });
  auto observer = run(join_observer(f), [&](const Tick& tick) {
    EXPECT_EQ(tick.phase_counter % 2, 0U);
    order.emplace_back("observer");
  });
  std::vector<std::string> expected;
  for (int ms = 0; ms < 500; ++ms) {
    ASSERT_TRUE(f.barrier->tick(std::chrono::milliseconds(ms), 0));
    ASSERT_TRUE(f.barrier->settle());
    if (ms % 10 == 0) expected.insert(expected.end(), {"client", "observer"});
    ASSERT_EQ(order, expected) << ms;
  }
  f.barrier.reset();
  client.join();
  observer.join();
}

TEST(Observer, no_tool_that_looks_on_has_a_turn_whether_it_is_waited_for_or_not) {
  BarrierFixture f;
  std::atomic<int> ticks = 0;
  auto tool = Participant::join(f.id, {.name = "tool", .period = 10ms, .is_tool = true});
  ASSERT_TRUE(tool);
  auto thread = run(std::move(*tool), [&](const Tick&) { ++ticks; });
  const auto observer = join_observer(f, 1h);
  EXPECT_FALSE(f.barrier->has_turn(0ms));
  ASSERT_TRUE(f.barrier->tick(0ms, 0));
  EXPECT_EQ(ticks, 1);
  EXPECT_FALSE(f.barrier->has_turn(10ms));
  const auto client = f.join("client", 1, 20ms);
  EXPECT_EQ(f.barrier->has_turn(10ms), std::optional(false));
  EXPECT_EQ(f.barrier->has_turn(20ms), std::optional(true));
  f.barrier.reset();
  thread.join();
}

TEST(Observer, time_goes_on_while_it_looks_until_it_is_due_again) {
  BarrierFixture f;
  auto a = join_observer(f);
  for (int ms = 0; ms < 10; ++ms) ASSERT_TRUE(f.barrier->tick(std::chrono::milliseconds(ms), 0));
  EXPECT_TRUE(f.barrier->records().at(0).is_late);
  Tick tick;
  ASSERT_EQ(a.wait(tick, 60s), State::tick);
  EXPECT_EQ(tick.now, 0ms);
  auto thread = run(std::move(a), [](const Tick&) {});  // its first wait() ends the tick
  ASSERT_TRUE(f.barrier->tick(10ms, 0));
  ASSERT_TRUE(f.barrier->settle());
  EXPECT_FALSE(f.barrier->records().at(0).is_late);
  f.barrier.reset();
  thread.join();
}

TEST(Observer, nobody_has_a_tick_while_it_looks) {
  BarrierFixture f;
  std::atomic<bool> is_looking{false};
  auto observer = run(join_observer(f, 10ms), [&](const Tick&) {
    is_looking = true;
    for (int i = 0; i < 100; ++i) std::this_thread::yield();
    is_looking = false;
  });
  int ticks = 0;
  auto client = run(f.join("client", 1, 1ms), [&](const Tick&) {
    EXPECT_FALSE(is_looking);
    ++ticks;
  });
  for (int ms = 0; ms < 200; ++ms) ASSERT_TRUE(f.barrier->tick(std::chrono::milliseconds(ms), 0));
  EXPECT_EQ(ticks, 200);
  f.barrier.reset();
  client.join();
  observer.join();
}

TEST(Observer, that_leaves_hangs_or_is_dropped_while_it_looks_is_not_waited_for) {
  BarrierOptions options;
  options.hang_warning = 10ms;
  options.participant_timeout = 30ms;
  BarrierFixture f(options);
  {
    auto a = join_observer(f);
    ASSERT_TRUE(f.barrier->tick(0ms, 0));
    Tick tick;
    ASSERT_EQ(a.wait(tick, 60s), State::tick);
  }
  EXPECT_TRUE(f.barrier->settle());
  EXPECT_EQ(f.barrier->refresh(), 0U);

  auto b = join_observer(f);
  ASSERT_TRUE(f.barrier->tick(10ms, 0));
  EXPECT_TRUE(f.barrier->drop("observer"));
  EXPECT_TRUE(f.barrier->settle());
  EXPECT_EQ(f.barrier->refresh(), 0U);
  Tick tick;
  EXPECT_EQ(b.wait(tick, 60s), State::dropped);

  auto c = join_observer(f);
  ASSERT_TRUE(f.barrier->tick(20ms, 0));
  EXPECT_TRUE(f.barrier->settle());
  EXPECT_EQ(f.count(BarrierEvent::Kind::hangs), 1);
  EXPECT_EQ(f.count(BarrierEvent::Kind::dropped), 2);
  EXPECT_EQ(f.barrier->refresh(), 0U);
}

TEST(Observer, the_server_can_give_up_waiting) {
  BarrierOptions options;
  int calls = 0;
  options.on_waiting = [&] { return ++calls < 3; };
  BarrierFixture f(options);
  auto a = join_observer(f);
  EXPECT_TRUE(f.barrier->tick(0ms, 0));
  EXPECT_FALSE(f.barrier->settle());
  EXPECT_EQ(calls, 3);
}

TEST(Observer, to_observe_or_not_counts_from_the_next_tick_on) {
  BarrierFixture f;
  auto a = join_observer(f);
  ASSERT_TRUE(f.barrier->tick(0ms, 0));
  a.set_observing(false);  // and still this tick is one of an observer
  Tick tick;
  ASSERT_EQ(a.wait(tick, 60s), State::tick);
  EXPECT_EQ(tick.phase_counter % 2, 0U);
  std::vector<std::uint64_t> moments;  // unguarded on purpose
  auto thread = run(std::move(a), [&](const Tick& one) { moments.push_back(one.phase_counter % 2); });
  ASSERT_TRUE(f.barrier->tick(10ms, 0));
  EXPECT_EQ(moments, std::vector<std::uint64_t>{1});
  f.barrier.reset();
  thread.join();
}

TEST(Observer, in_free_running_mode_it_is_as_all_others) {
  BarrierOptions options;
  options.is_lockstep = false;
  BarrierFixture f(options);
  auto a = join_observer(f, 1ms);
  for (int ms = 0; ms < 10; ++ms) ASSERT_TRUE(f.barrier->tick(std::chrono::milliseconds(ms), 0));
  EXPECT_TRUE(f.barrier->settle());
  EXPECT_EQ(f.barrier->records().at(0).missed, 9U);
}

TEST(Observer, its_place_is_no_observers_when_it_is_taken_again) {
  BarrierFixture f;
  {
    auto a = join_observer(f);
    f.barrier->refresh();
  }
  f.barrier->refresh();
  int ticks = 0;  // unguarded on purpose
  auto thread = run(f.join("client"), [&](const Tick&) { ++ticks; });
  ASSERT_TRUE(f.barrier->tick(0ms, 0));
  EXPECT_EQ(ticks, 1);
  f.barrier.reset();
  thread.join();
}

}  // namespace
}  // namespace shm::test
