#include "shm/spinning.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>

namespace shm::test {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

void took(SpinLimit& limit, nanoseconds wait, int times) {
  for (int i = 0; i < times; ++i) limit.took(wait);
}

TEST(SpinLimit, looks_longer_than_the_news_usually_take) {
  SpinLimit limit;
  EXPECT_GT(limit.next(), 0ns);
  took(limit, 80us, 100);
  EXPECT_GT(limit.next(), 80us);
  EXPECT_LE(limit.next(), SpinLimit::longest);
}

TEST(SpinLimit, does_not_look_at_all_while_the_news_take_long_and_looks_again_when_they_do_not) {
  SpinLimit limit;
  took(limit, 5ms, 100);
  EXPECT_EQ(limit.next(), 0ns);
  took(limit, 30us, 100);
  EXPECT_GT(limit.next(), 30us);
}

TEST(SpinLimit, one_that_took_for_ever_is_soon_forgotten) {
  SpinLimit limit;
  took(limit, 50us, 100);
  limit.took(10s);
  took(limit, 50us, 16);
  EXPECT_GT(limit.next(), 50us);
}

TEST(WakeAhead, wakes_earlier_until_the_sleeper_is_there_and_then_not_much_earlier_than_needed) {
  WakeAhead ahead;
  constexpr auto step = 7us, needed = 60us;
  for (int tick = 0; tick < 500; ++tick) ahead.began(ahead.steps() * step, ahead.steps() * step > needed);
  EXPECT_GE(ahead.steps(), 8);
  EXPECT_LE(ahead.steps(), 11);
}

TEST(WakeAhead, steps_that_last_long_are_not_woken_before_but_now_and_then) {
  WakeAhead ahead;
  ahead.began(1ms, false);
  EXPECT_EQ(ahead.steps(), 0);
  int tried = 0;
  for (int tick = 0; tick < 640; ++tick) {
    if (ahead.steps() == 0) {
      ahead.began();
    } else {
      ++tried;
      ahead.began(1ms, false);
    }
  }
  EXPECT_GT(tried, 0);
  EXPECT_LE(tried, 10);
}

// As the kernel writes it.
struct LoadFile {
  std::string path = testing::TempDir() + "rtmsim-load-" + std::to_string(getpid());
  ~LoadFile() { unlink(path.c_str()); }
  void write(int running) const { std::ofstream(path) << "0.01 0.02 0.03 " << running << "/345 6789\n"; }
};

TEST(FreeProcessors, are_there_when_nobody_else_wants_to_run) {
  const LoadFile file;
  file.write(1);
  FreeProcessors free(file.path.c_str(), 2);
  auto now = std::chrono::steady_clock::now();
  const auto look = [&](int times) {
    for (int i = 0; i < times; ++i) free.look(now += FreeProcessors::pause);
  };
  EXPECT_FALSE(free.are_there_for(1)) << "nobody has looked yet";
  look(20);
  EXPECT_TRUE(free.are_there_for(1));
  EXPECT_FALSE(free.are_there_for(2));
  file.write(2);
  look(20);
  EXPECT_FALSE(free.are_there_for(1));
  file.write(1);
  look(20);
  EXPECT_TRUE(free.are_there_for(1));
}

TEST(FreeProcessors, are_not_there_when_the_kernel_does_not_say) {
  FreeProcessors free("/proc/nowhere", 2);
  free.look(std::chrono::steady_clock::now());
  EXPECT_FALSE(free.are_there_for(1));
}

// One look at each call, so that it does not matter how fast this machine is.
bool finds_it_over(TurnWait& wait, int looks_before_the_end) {
  return wait.look([&] { return looks_before_the_end-- == 0; }, std::chrono::steady_clock::now() + 1h);
}

TEST(TurnWait, looks_where_the_other_runs_too_and_does_not_where_a_third_wants_to) {
  const LoadFile file;
  file.write(2);
  TurnWait wait(1h, file.path.c_str(), 2);
  const auto settle = [&] {
    for (int i = 0; i < 20; ++i) {
      finds_it_over(wait, 0);
      usleep(static_cast<useconds_t>(FreeProcessors::pause / 1us));
    }
  };
  EXPECT_FALSE(finds_it_over(wait, 0)) << "nobody has looked yet";
  settle();
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(wait.look([] { return false; }, std::chrono::steady_clock::now())) << "the deadline has passed";
    usleep(50'000);
    wait.slept();
  }
  EXPECT_TRUE(finds_it_over(wait, 3)) << "within 70 ms";
  file.write(3);
  settle();
  EXPECT_FALSE(finds_it_over(wait, 0));
}

TEST(TurnWait, ends_at_its_deadline_and_sleeps_while_the_other_is_slow) {
  const LoadFile file;
  file.write(1);
  TurnWait wait(10ms, file.path.c_str(), 2);
  const auto never = [] { return false; };
  const auto now = [] { return std::chrono::steady_clock::now(); };
  bool is_free = false;
  for (int i = 0; i < 5000 && !is_free; ++i) usleep(1000), is_free = finds_it_over(wait, 0);
  ASSERT_TRUE(is_free);
  int looks = 0;
  const auto counted = [&] { return ++looks < 0; };
  for (int i = 0; i < 30; ++i) {
    wait.look(never, now());
    usleep(20'000);
    wait.slept();
  }
  EXPECT_FALSE(wait.look(counted, now() + 1h));
  EXPECT_EQ(looks, 1) << "it is not worth a look";
}

}  // namespace
}  // namespace shm::test
