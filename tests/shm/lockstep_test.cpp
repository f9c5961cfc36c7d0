#include "shm/lockstep.h"

#include <gtest/gtest.h>
#include <atomic>
#include <mutex>
#include <thread>

#include "shm/barrier_support.h"
#include "shm/participant_slots.h"

namespace shm::test {
namespace {

TEST(Barrier, without_participants_time_does_not_wait) {
  BarrierFixture f;
  EXPECT_TRUE(f.barrier->tick(0ms, 0));
  EXPECT_FALSE(f.barrier->next_due());
}

TEST(Barrier, a_participant_is_ticked_at_the_multiples_of_its_period_and_time_waits_for_it) {
  BarrierFixture f;
  std::vector<std::int64_t> ticks;  // unguarded on purpose: the barrier orders all accesses
  auto thread = run(f.join("a", 1, 10ms), [&](const Tick& tick) { ticks.push_back(tick.now.count() / 1'000'000); });
  for (int ms = 0; ms <= 35; ++ms) {
    ASSERT_TRUE(f.barrier->tick(std::chrono::milliseconds(ms), static_cast<std::uint64_t>(ms)));
    ASSERT_EQ(ticks.size(), static_cast<std::size_t>(ms / 10 + 1));
  }
  EXPECT_EQ(ticks, (std::vector<std::int64_t>{0, 10, 20, 30}));
  EXPECT_EQ(f.barrier->next_due(), 40ms);
  f.barrier.reset();
  thread.join();
}

TEST(Barrier, a_period_that_is_no_multiple_of_the_step_does_not_drift) {
  BarrierFixture f;
  std::vector<std::int64_t> ticks, dues;
  auto thread = run(f.join("a", 1, 2500us), [&](const Tick& tick) {
    ticks.push_back(tick.now.count() / 1'000'000);
    dues.push_back(tick.due.count() / 1000);
  });
  for (int ms = 0; ms <= 10; ++ms) f.barrier->tick(std::chrono::milliseconds(ms), 0);
  EXPECT_EQ(ticks, (std::vector<std::int64_t>{0, 3, 5, 8, 10}));
  EXPECT_EQ(dues, (std::vector<std::int64_t>{0, 2500, 5000, 7500, 10000}));
  f.barrier.reset();
  thread.join();
}

TEST(Barrier, a_participant_without_a_period_is_ticked_at_each_step) {
  BarrierFixture f;
  std::vector<std::int64_t> ticks;
  const std::chrono::nanoseconds step(simulation_info().step_ns);
  auto thread = run(f.join("a", 1, 0ms), [&](const Tick& tick) { ticks.push_back(tick.now / step); });
  for (int i = 0; i <= 5; ++i) f.barrier->tick(i * step, 0);
  EXPECT_EQ(ticks, (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5}));
  f.barrier.reset();
  thread.join();
}

TEST(Barrier, phases_run_in_order_and_the_members_of_one_phase_together) {
  BarrierFixture f;
  std::mutex mutex;
  std::vector<int> order;
  const auto note = [&](int phase) {
    return [&, phase](const Tick&) {
      const std::lock_guard lock(mutex);
      order.push_back(phase);
    };
  };
  std::vector<std::thread> threads;
  for (const int phase : {2, 0, 1, 1, 2, 0})
    threads.push_back(run(f.join("p" + std::to_string(phase), static_cast<std::uint32_t>(phase)), note(phase)));
  std::vector<int> expected;
  for (int n = 0; n < 100; ++n) {
    f.barrier->tick(n * 10ms, 0);
    for (const int phase : {0, 0, 1, 1, 2, 2}) expected.push_back(phase);
  }
  EXPECT_EQ(order, expected);
  f.barrier.reset();
  for (auto& thread : threads) thread.join();
}

TEST(Barrier, turns_of_a_phase_run_in_order_and_are_one_moment) {
  BarrierFixture f;
  std::mutex mutex;
  std::vector<std::pair<std::string, std::uint64_t>> order;
  std::vector<std::thread> threads;
  for (const auto& [name, phase, turn] :
       {std::tuple("c", 1U, 2U), std::tuple("d", 2U, 0U), std::tuple("b", 1U, 1U), std::tuple("a", 1U, 0U)}) {
    auto participant = Participant::join(f.id, {.name = name, .phase = phase, .period = 10ms, .turn = turn});
    ASSERT_TRUE(participant) << participant.error().message;
    threads.push_back(run(std::move(*participant), [&, name = std::string(name)](const Tick& tick) {
      const std::lock_guard lock(mutex);
      order.emplace_back(name, tick.phase_counter);
    }));
  }
  std::vector<std::pair<std::string, std::uint64_t>> expected;
  for (std::uint64_t n = 0; n < 50; ++n) {
    f.barrier->tick(std::chrono::milliseconds(10 * n), 0);
    for (const char* name : {"a", "b", "c"}) expected.emplace_back(name, 4 * n + 1);
    expected.emplace_back("d", 4 * n + 3);
  }
  EXPECT_EQ(order, expected);
  f.barrier.reset();
  for (auto& thread : threads) thread.join();
}

TEST(Barrier, who_joins_late_is_due_at_the_next_multiple) {
  BarrierFixture f;
  f.barrier->tick(95ms, 0);
  std::vector<std::int64_t> ticks;
  auto thread = run(f.join("late", 1, 10ms), [&](const Tick& tick) { ticks.push_back(tick.now.count() / 1'000'000); });
  for (int ms = 96; ms <= 111; ++ms) f.barrier->tick(std::chrono::milliseconds(ms), 0);
  EXPECT_EQ(ticks, (std::vector<std::int64_t>{100, 110}));
  f.barrier.reset();
  thread.join();
}

TEST(Barrier, who_leaves_is_no_longer_waited_for) {
  BarrierFixture f;
  {
    auto a = f.join("a");
    EXPECT_EQ(f.barrier->refresh(), 1U);
    EXPECT_TRUE(a.is_active());
  }
  EXPECT_TRUE(f.barrier->tick(0ms, 0));
  EXPECT_EQ(f.barrier->refresh(), 0U);
  EXPECT_EQ(f.count(BarrierEvent::Kind::left), 1);
}

TEST(Barrier, who_leaves_in_the_middle_of_a_tick_ends_it) {
  BarrierFixture f;
  std::thread thread([a = std::optional<Participant>(f.join("a"))]() mutable {
    Tick tick;
    while (a->wait(tick, 60s) != State::tick) {
    }
    a.reset();
  });
  EXPECT_TRUE(f.barrier->tick(0ms, 0));
  thread.join();
  EXPECT_EQ(f.barrier->refresh(), 0U);
}

TEST(Barrier, a_place_is_free_again_after_leaving_a_thousand_times) {
  BarrierFixture f;
  for (int n = 0; n < 1000; ++n) {
    auto a = f.join("a");
    if (n % 2 == 0) {
      ASSERT_EQ(f.barrier->refresh(), 1U);
    }
  }
  EXPECT_EQ(f.barrier->refresh(), 0U);
  EXPECT_TRUE(f.barrier->records().empty());
}

TEST(Barrier, more_participants_than_places_are_refused) {
  BarrierFixture f;
  std::vector<Participant> all;
  for (int n = 0; n < 16; ++n) all.push_back(f.join("p"));
  auto refused = Participant::join(f.id, {"one more", 1, 1ms});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "participant \"one more\": all 16 places on server " + std::to_string(f.id) + " are taken");
  EXPECT_EQ(f.barrier->refresh(), 16U);
}

TEST(Barrier, a_hundred_robots_with_several_contexts_each_take_part) {
  BarrierFixture f({}, max_participants);
  std::vector<Participant> all;
  for (std::uint32_t i = 0; i < max_participants; ++i) all.push_back(f.join("p" + std::to_string(i), i * 3 / max_participants));
  EXPECT_FALSE(Participant::join(f.id, {"one more", 1, 1ms}));
  ASSERT_EQ(f.barrier->refresh(), max_participants);
  // One after the other, in the order of their phases.
  std::vector<std::uint64_t> ticks(all.size());
  std::thread thread([&] {
    for (int round = 0; round < 3; ++round) {
      for (std::size_t i = 0; i < all.size(); ++i) {
        Tick tick;
        if (all[i].wait(tick, 60s) != State::tick) return;
        ++ticks[i];
        all[i].finish();
      }
    }
  });
  for (int ms = 0; ms <= 20; ms += 10) EXPECT_TRUE(f.barrier->tick(std::chrono::milliseconds(ms), static_cast<std::uint64_t>(ms)));
  f.barrier.reset();
  thread.join();
  EXPECT_EQ(ticks, std::vector<std::uint64_t>(all.size(), 3));
}

// Who is woken wakes those on the same bit of the same word.
TEST(Participant, places_on_one_bit_are_of_such_as_have_their_ticks_together) {
  BarrierFixture f({}, max_participants);
  std::vector<Participant> all;
  constexpr std::size_t bits = 32 * RTMSIM_TICK_WORDS, count = 4 * bits;
  static_assert(count <= max_participants);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t kind = i % 6;  // phases, and periods of one phase
    all.push_back(f.join("p", kind < 4 ? kind : 4, kind < 5 ? 10ms : 20ms));
  }
  const Segment& segment = f.simulation->segment();
  for (std::size_t i = bits; i < max_participants; ++i) {
    const auto& slot = slot_at(segment, i);
    if (load(slot.owner) == 0) continue;
    const auto& same_bit = slot_at(segment, i % bits);
    EXPECT_EQ(std::pair(slot.phase, slot.period_ns), std::pair(same_bit.phase, same_bit.period_ns)) << i;
  }
}

TEST(Participant, options_that_make_no_sense_are_refused) {
  BarrierFixture f;
  EXPECT_FALSE(Participant::join(f.id, {"", 1, 1ms}));
  EXPECT_FALSE(Participant::join(f.id, {"a", 16, 1ms}));
  EXPECT_FALSE(Participant::join(f.id, {"a", 1, -1ms}));
}

TEST(Barrier, a_hanging_participant_is_named_once_and_dropped_after_its_time) {
  BarrierOptions options;
  options.hang_warning = 20ms;
  options.participant_timeout = 60ms;
  BarrierFixture f(options);
  auto a = f.join("sleepy", 2);
  EXPECT_TRUE(f.barrier->tick(0ms, 0));
  EXPECT_EQ(f.count(BarrierEvent::Kind::hangs), 1);
  EXPECT_EQ(f.count(BarrierEvent::Kind::dropped), 1);
  EXPECT_EQ(f.events.back().name, "sleepy");
  EXPECT_EQ(f.barrier->refresh(), 0U);
  Tick tick;
  EXPECT_EQ(a.wait(tick, 60s), State::dropped);
  a = f.join("sleepy", 2);
  EXPECT_EQ(f.barrier->refresh(), 1U);
}

TEST(Barrier, the_server_can_give_up_waiting) {
  BarrierOptions options;
  int calls = 0;
  options.on_waiting = [&] { return ++calls < 3; };
  BarrierFixture f(options);
  auto a = f.join("stuck");
  EXPECT_FALSE(f.barrier->tick(0ms, 0));
  EXPECT_EQ(calls, 3);
}

TEST(Barrier, in_free_running_mode_nobody_is_waited_for_and_missed_ticks_are_counted) {
  BarrierOptions options;
  options.is_lockstep = false;
  BarrierFixture f(options);
  auto a = f.join("slow", 1, 1ms);
  for (int ms = 0; ms < 10; ++ms) ASSERT_TRUE(f.barrier->tick(std::chrono::milliseconds(ms), 0));
  Tick tick;
  ASSERT_EQ(a.wait(tick, 60s), State::tick);
  EXPECT_EQ(tick.now, 0ms);
  EXPECT_EQ(f.barrier->records()[0].missed, 9U);
  a.finish();
  f.barrier->tick(10ms, 0);
  ASSERT_EQ(a.wait(tick, 60s), State::tick);
  EXPECT_EQ(tick.now, 10ms);
}

TEST(Barrier, after_a_reset_ticks_start_again_at_zero) {
  BarrierFixture f;
  std::vector<std::pair<std::int64_t, std::uint32_t>> ticks;
  auto thread = run(f.join("a", 1, 10ms), [&](const Tick& tick) { ticks.emplace_back(tick.now.count() / 1'000'000, tick.resets); });
  for (int ms = 0; ms < 15; ++ms) f.barrier->tick(std::chrono::milliseconds(ms), 0);
  f.barrier->rewind(0ms, 1);
  for (int ms = 0; ms < 15; ++ms) f.barrier->tick(std::chrono::milliseconds(ms), 0);
  const std::vector<std::pair<std::int64_t, std::uint32_t>> expected{{0, 0}, {10, 0}, {0, 1}, {10, 1}};
  EXPECT_EQ(ticks, expected);
  f.barrier.reset();
  thread.join();
}

TEST(Barrier, a_changed_period_counts_from_the_next_tick_on) {
  BarrierFixture f;
  std::vector<std::int64_t> ticks;
  auto a = f.join("a", 1, 10ms);
  a.set_period(4ms);
  auto thread = run(std::move(a), [&](const Tick& tick) { ticks.push_back(tick.now.count() / 1'000'000); });
  for (int ms = 0; ms <= 9; ++ms) f.barrier->tick(std::chrono::milliseconds(ms), 0);
  EXPECT_EQ(ticks, (std::vector<std::int64_t>{0, 4, 8}));
  f.barrier.reset();
  thread.join();
}

TEST(Barrier, dropping_by_name_tells_the_participant) {
  BarrierFixture f;
  auto a = f.join("a");
  f.barrier->refresh();
  EXPECT_FALSE(f.barrier->drop("b"));
  EXPECT_TRUE(f.barrier->drop("a"));
  Tick tick;
  EXPECT_EQ(a.wait(tick, 60s), State::dropped);
}

TEST(Barrier, its_end_closes_the_participants) {
  BarrierFixture f;
  auto a = f.join("a");
  f.barrier->refresh();
  f.barrier.reset();
  Tick tick;
  EXPECT_EQ(a.wait(tick, 60s), State::closed);
}

TEST(Participant, a_wait_is_interrupted_from_another_thread) {
  BarrierFixture f;
  auto a = f.join("a");
  std::thread thread([&] { a.interrupt(); });
  Tick tick;
  EXPECT_EQ(a.wait(tick, 60s), State::timed_out);
  thread.join();
}

TEST(Barrier, records_show_rate_phase_and_times) {
  BarrierFixture f;
  auto thread = run(f.join("worker", 1, 5ms), [](const Tick&) {});
  for (int ms = 0; ms < 20; ++ms) f.barrier->tick(std::chrono::milliseconds(ms), 0);
  const auto records = read_participants(f.open(IfaceType::simulation, "world"));
  ASSERT_TRUE(records);
  ASSERT_EQ(records->size(), 1U);
  const ParticipantRecord& record = records->front();
  EXPECT_EQ(record.name, "worker");
  EXPECT_EQ(record.pid, getpid());
  EXPECT_EQ(record.period_ns, 5'000'000);
  EXPECT_EQ(record.ticks, 4U);
  EXPECT_TRUE(record.is_active);
  EXPECT_FALSE(record.is_late);
  EXPECT_GE(record.max_ns, record.mean_ns);
  f.barrier.reset();
  thread.join();
}

TEST(Barrier, many_threads_that_join_tick_and_leave_at_random_never_stop_it) {
  BarrierFixture f;
  std::atomic<bool> is_over{false};
  std::atomic<int> ticks{0};
  std::vector<std::thread> threads;
  for (unsigned n = 0; n < 4; ++n) {
    threads.emplace_back([&, n] {
      for (unsigned round = 0; !is_over; ++round) {
        auto participant =
            Participant::join(f.id, {.name = "p", .phase = n % 3, .period = std::chrono::milliseconds(1 + n), .observes = n == 3});
        if (!participant) continue;
        Tick tick;
        for (unsigned i = 0; i < 5 + round % 7 && !is_over; ++i) {
          if (participant->wait(tick, 100ms) == State::tick) ++ticks;
          if (n == 2) participant->set_observing(i % 2 == 0);
        }
      }
    });
  }
  for (int ms = 0; ms < 2000 || ticks < 2000; ++ms) ASSERT_TRUE(f.barrier->tick(std::chrono::milliseconds(ms), 0));
  is_over = true;
  for (int ms = 0; ms < 100; ++ms) f.barrier->refresh();
  std::atomic<bool> are_joined{false};
  std::thread ticker([&] {
    for (int ms = 100'000'000; !are_joined; ++ms) f.barrier->tick(std::chrono::milliseconds(ms), 0);
  });
  for (auto& thread : threads) thread.join();
  are_joined = true;
  ticker.join();
}

}  // namespace
}  // namespace shm::test
