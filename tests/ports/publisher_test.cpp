#include "core/publisher.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <mutex>
#include <thread>

#include "support/quiet_publisher.h"

namespace rt::publishers {
namespace {

Sample sample(int number) {
  auto block = std::make_shared<Block>(sizeof number);
  block->set_size(sizeof number);
  *reinterpret_cast<int*>(block->data()) = number;
  Sample made;
  made.block = block;
  return made;
}
int number(const Sample& of) { return *reinterpret_cast<const int*>(of.block->data()); }

// What arrived, to wait for.
class Arrivals {
 public:
  void add(int value) {
    std::lock_guard lock(mutex_);
    values_.push_back(value);
    changed_.notify_all();
  }
  bool wait_for_last(int value) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(60), [&] { return !values_.empty() && values_.back() == value; });
  }
  std::vector<int> values() {
    std::lock_guard lock(mutex_);
    return values_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<int> values_;
};

TEST(Publisher, a_periodic_one_sends_when_its_period_has_passed_and_not_before) {
  ManualTime time;
  Arrivals arrivals;
  QuietPublisher publisher(Subscription::periodic, {PushPolicy::newest, 0, std::chrono::seconds(10)}, {},
                           {[&](const Sample& s) { return arrivals.add(number(s)), PortStatus::ok; }, {}, {}}, time);
  publisher.write(sample(1));
  time.advance(std::chrono::milliseconds(9999));
  publisher.write(sample(2));
  EXPECT_TRUE(arrivals.values().empty());
  time.advance(std::chrono::milliseconds(1));
  EXPECT_TRUE(arrivals.wait_for_last(2)) << "the newest";
  EXPECT_EQ(arrivals.values(), std::vector<int>{2});
}

TEST(Publisher, a_sample_that_the_receiver_had_no_room_for_is_sent_again_later_and_later) {
  ManualTime time;
  Arrivals arrivals;
  int attempts = 0;
  QuietPublisher publisher(Subscription::newest, {PushPolicy::all, 0, {}}, {},
                           {[&](const Sample&) {
                              arrivals.add(++attempts);
                              return attempts < 4 ? PortStatus::send_full : PortStatus::ok;
                            },
                            {},
                            {}},
                           time);
  publisher.write(sample(1));
  ASSERT_TRUE(arrivals.wait_for_last(1));
  for (const int wait_ms : {1, 2, 4}) {
    const int before = arrivals.values().back();
    // The deadline counts from when the sender is back at it, which nobody tells: time goes on until it has seen it.
    for (int i = 0; i < 60000 && arrivals.values().back() == before; ++i) {
      time.advance(std::chrono::milliseconds(wait_ms));
      std::this_thread::yield();
    }
    ASSERT_EQ(arrivals.values().back(), before + 1);
  }
  EXPECT_EQ(arrivals.values(), (std::vector<int>{1, 2, 3, 4}));
}

TEST(Publisher, the_last_of_1500_pairs_of_close_writes_always_arrives) {
  for (const auto policy : {PushPolicy::newest, PushPolicy::all, PushPolicy::fifo}) {
    Arrivals arrivals;
    QuietPublisher publisher(Subscription::newest, {policy, 0, {}}, {},
                             {[&](const Sample& s) { return arrivals.add(number(s)), PortStatus::ok; }, {}, {}});
    for (int i = 0; i < 1500; ++i) {
      publisher.write(sample(2 * i));
      for (int spin = 0; spin < i; ++spin) std::atomic_signal_fence(std::memory_order_seq_cst);  // 0 to some microseconds later
      publisher.write(sample(2 * i + 1));
      ASSERT_TRUE(arrivals.wait_for_last(2 * i + 1)) << i;
    }
    if (policy != PushPolicy::newest) {
      EXPECT_EQ(arrivals.values().size(), 3000u);
    }
  }
}

TEST(Publisher, a_full_receiver_gets_the_sample_later) {
  Arrivals arrivals;
  std::atomic<int> refusals{3};
  QuietPublisher publisher(Subscription::newest, {PushPolicy::all, 0, {}}, {},
                           {[&](const Sample& s) {
                              if (refusals-- > 0) return PortStatus::send_full;
                              arrivals.add(number(s));
                              return PortStatus::ok;
                            },
                            {},
                            {}});
  publisher.write(sample(1));
  EXPECT_TRUE(arrivals.wait_for_last(1));
}

TEST(Publisher, nothing_is_sent_after_a_loss) {
  std::promise<void> lost;
  QuietPublisher publisher(Subscription::newest, {PushPolicy::all, 0, {}}, {},
                           {[](const Sample&) { return PortStatus::connection_lost; }, {}, [&] { lost.set_value(); }});
  publisher.write(sample(1));
  ASSERT_EQ(lost.get_future().wait_for(std::chrono::seconds(60)), std::future_status::ready);
  EXPECT_EQ(publisher.write(sample(2)).status, PortStatus::connection_lost);
}

TEST(Publisher, one_that_hangs_in_a_send_can_be_destroyed) {
  auto entered = std::make_shared<std::promise<void>>();
  auto release = std::make_shared<std::promise<void>>();
  auto left = std::make_shared<std::promise<void>>();
  {
    Publisher publisher(Subscription::newest, {PushPolicy::all, 0, {}}, {},
                        {[=](const Sample&) {
                           entered->set_value();
                           release->get_future().wait();
                           left->set_value();
                           return PortStatus::ok;
                         },
                         {},
                         {}});
    publisher.write(sample(1));
    entered->get_future().wait();
  }
  release->set_value();
  EXPECT_EQ(left->get_future().wait_for(std::chrono::seconds(60)), std::future_status::ready);
}

TEST(Publisher, a_publisher_may_be_destroyed_by_its_own_loss) {
  const auto gone = std::make_shared<std::promise<void>>();
  std::unique_ptr<Publisher> publisher;
  std::promise<void> made;
  publisher = std::make_unique<Publisher>(Subscription::newest, PublisherSettings{PushPolicy::all, 0, {}}, BufferSettings{},
                                          Publisher::Hooks{[](const Sample&) { return PortStatus::connection_lost; },
                                                           {},
                                                           [&, gone] {
                                                             made.get_future().wait();
                                                             publisher.reset();
                                                             gone->set_value();
                                                           }});
  publisher->write(sample(1));
  made.set_value();
  EXPECT_EQ(gone->get_future().wait_for(std::chrono::seconds(60)), std::future_status::ready);
}

TEST(Publisher, a_periodic_one_sends_and_tells_when_there_is_nothing) {
  Arrivals arrivals;
  std::promise<void> starved;
  std::once_flag once;
  QuietPublisher publisher(Subscription::periodic, {PushPolicy::all, 0, std::chrono::milliseconds(1)}, {},
                           {[&](const Sample& s) { return arrivals.add(number(s)), PortStatus::ok; },
                            [&] { std::call_once(once, [&] { starved.set_value(); }); },
                            {}});
  publisher.write(sample(4));
  EXPECT_TRUE(arrivals.wait_for_last(4));
  EXPECT_EQ(starved.get_future().wait_for(std::chrono::seconds(60)), std::future_status::ready);
}

TEST(Publisher, a_waiting_writer_is_released_at_the_end) {
  std::promise<void> entered;
  std::promise<void> release;
  BufferSettings buffer{1, FullPolicy::block, EmptyPolicy::readback, std::chrono::seconds(60), std::chrono::seconds(60)};
  std::once_flag once;
  QuietPublisher publisher(Subscription::newest, {PushPolicy::all, 0, {}}, buffer,
                           {[&](const Sample&) {
                              std::call_once(once, [&] {
                                entered.set_value();
                                release.get_future().wait();
                              });
                              return PortStatus::ok;
                            },
                            {},
                            {}});
  publisher.write(sample(1));
  entered.get_future().wait();
  publisher.write(sample(2));
  std::thread stopper([&] { publisher.stop(); });
  EXPECT_EQ(publisher.write(sample(3)).status, PortStatus::precondition_not_met);
  stopper.join();
  release.set_value();
}

}  // namespace
}  // namespace rt::publishers
