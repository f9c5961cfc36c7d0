// The thread that tells the gateway's loop of news, while a writer publishes at the worst moments.
#include <gtest/gtest.h>
#include <poll.h>

#include <random>

#include "common/alarm.h"
#include "shm/futex.h"
#include "shm/shm_support.h"

namespace gateway {
namespace {

SharedSegment opened(const shm::IfaceWriter& writer) {
  return std::make_shared<const shm::Segment>(shm::Segment::open(writer.segment().name()).value());
}

bool tells(const Alarm& alarm, int milliseconds) {
  pollfd one{alarm.descriptor(), POLLIN, 0};
  return ::poll(&one, 1, milliseconds) == 1;
}

// As soon as it is so; a thread that sleeps meanwhile comes too late for what is tested here.
bool tells_at_once(const Alarm& alarm) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (!tells(alarm, 0)) {
    if (std::chrono::steady_clock::now() > end) return false;
  }
  return true;
}

// A writer that is held up between the news and the bell: the alarm has told of the news already and waits for the next.
TEST(Alarm, hears_what_comes_after_a_bell_that_came_late) {
  shm::test::Fixture f;
  const auto writer = f.make(shm::iface_spec(shm::IfaceType::laser, "robot::laser", shm::test::laser_info()));
  const auto segment = opened(*writer);
  auto& header = segment->header();
  Alarm alarm;
  alarm.watch({segment});
  std::mt19937 random(5);
  for (std::uint32_t news = 1; news <= 20'000; ++news) {
    shm::store(header.wake_word, news, std::memory_order_seq_cst);
    const auto late = std::chrono::steady_clock::now() + std::chrono::nanoseconds(random() % 10'000);
    while (std::chrono::steady_clock::now() < late) {
    }
    shm::ring(header.wake_word, header.waiting);
    ASSERT_TRUE(tells_at_once(alarm)) << "after " << news;
    alarm.clear();
  }
}

TEST(Alarm, watches_more_than_it_can_sleep_on) {
  shm::test::Fixture f;
  std::vector<std::unique_ptr<shm::IfaceWriter>> writers;
  std::vector<SharedSegment> segments;
  for (int i = 0; i < 140; ++i) {
    writers.push_back(f.make(shm::iface_spec(shm::IfaceType::laser, "robot::laser" + std::to_string(i), shm::test::laser_info())));
    segments.push_back(opened(*writers.back()));
  }
  Alarm alarm;
  for (const std::size_t count : {std::size_t{140}, std::size_t{127}, std::size_t{128}, std::size_t{1}}) {
    alarm.watch({segments.begin(), segments.begin() + static_cast<std::ptrdiff_t>(count)});
    ASSERT_TRUE(tells(alarm, 5000));  // of all that are new, once
    alarm.clear();
    for (const std::size_t which : {std::size_t{0}, count / 2, count - 1}) {
      writers[which]->publish(std::chrono::milliseconds(1));
      ASSERT_TRUE(tells(alarm, 5000)) << which << " of " << count;
      alarm.clear();
    }
  }
}

}  // namespace
}  // namespace gateway
