#include "core/mailbox.h"

#include <gtest/gtest.h>

#include <thread>

#include "core/ring.h"
#include "core/send_queue.h"

namespace rt::mailboxes {
namespace {

Sample sample(int number) {
  auto block = std::make_shared<Block>(1);
  block->set_size(1);
  *block->data() = static_cast<std::byte>(number);
  Sample made;
  made.block = block;
  return made;
}
int number(const Sample& of) { return of.block ? static_cast<int>(*of.block->data()) : -1; }
std::vector<int> numbers(const std::vector<Sample>& samples) {
  std::vector<int> result;
  for (const auto& one : samples) result.push_back(number(one));
  return result;
}

BufferSettings buffer(FullPolicy full, EmptyPolicy empty, std::size_t length = 2) {
  return {length, full, empty, std::chrono::milliseconds(1), std::chrono::milliseconds(1)};
}

TEST(Mailbox, a_full_ring_overwrites_the_oldest) {
  Mailbox box;
  const auto channel = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::do_nothing));
  for (int i = 1; i <= 2; ++i) EXPECT_FALSE(box.write(channel, sample(i)).overwrote);
  EXPECT_TRUE(box.write(channel, sample(3)).overwrote);
  EXPECT_EQ(number(box.read().sample), 2);
  EXPECT_EQ(number(box.read().sample), 3);
  EXPECT_EQ(box.read().status, PortStatus::buffer_empty);
}

TEST(Mailbox, a_reader_that_waits_wakes_when_a_sample_comes_and_not_without) {
  Mailbox box;
  EXPECT_FALSE(box.wait_unread(std::chrono::milliseconds(1))) << "no channel";
  const auto channel = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::do_nothing));
  EXPECT_FALSE(box.wait_unread(std::chrono::milliseconds(1))) << "nothing came";
  std::jthread writer([&] { box.write(channel, sample(7)); });
  EXPECT_TRUE(box.wait_unread(std::chrono::minutes(1)));
  EXPECT_EQ(number(box.read().sample), 7);
  EXPECT_FALSE(box.wait_unread(std::chrono::milliseconds(1))) << "it was read";
}

TEST(Mailbox, a_full_ring_refuses_or_times_out) {
  Mailbox box;
  const auto refuses = box.open(buffer(FullPolicy::do_nothing, EmptyPolicy::do_nothing, 1));
  const auto waits = box.open(buffer(FullPolicy::block, EmptyPolicy::do_nothing, 1));
  box.write(refuses, sample(1));
  box.write(waits, sample(2));
  EXPECT_EQ(box.write(refuses, sample(3)).status, PortStatus::buffer_full);
  EXPECT_EQ(box.write(waits, sample(3)).status, PortStatus::buffer_timeout);
  EXPECT_EQ(box.unread(), 2u);
}

TEST(Mailbox, what_is_of_another_era_is_thrown_away_also_what_was_read_last) {
  Mailbox box;
  const auto channel = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::readback, 8));
  const auto of_epoch = [](int number, std::uint64_t epoch) {
    auto made = sample(number);
    made.epoch = epoch;
    return made;
  };
  for (const int i : {1, 2, 3}) box.write(channel, of_epoch(i, 4));
  EXPECT_EQ(number(box.read().sample), 1);
  box.drop_other_epochs(4);
  EXPECT_EQ(box.unread(), 2u);
  box.write(channel, of_epoch(4, 5));
  box.drop_other_epochs(5);
  EXPECT_EQ(box.unread(), 1u);
  EXPECT_EQ(number(box.read().sample), 4);
  box.drop_other_epochs(6);
  EXPECT_EQ(box.read().status, PortStatus::buffer_empty);
}

TEST(Mailbox, the_last_value_is_read_again_with_readback) {
  Mailbox box;
  const auto channel = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::readback));
  EXPECT_EQ(box.read().status, PortStatus::buffer_empty);
  box.write(channel, sample(7));
  EXPECT_TRUE(box.read().is_fresh);
  const auto again = box.read();
  EXPECT_EQ(number(again.sample), 7);
  EXPECT_FALSE(again.is_fresh);
  box.forget_last(channel);
  EXPECT_EQ(box.read().status, PortStatus::buffer_empty);
}

TEST(Mailbox, samples_of_several_connections_are_read_in_order_of_arrival) {
  Mailbox box;
  const auto a = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::readback, 4));
  const auto b = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::readback, 4));
  box.write(a, sample(1));
  box.write(b, sample(2));
  box.write(a, sample(3));
  EXPECT_EQ(number(box.read(b).sample), 2);
  EXPECT_EQ(number(box.read().sample), 1);
  EXPECT_EQ(number(box.read().sample), 3);
  EXPECT_EQ(number(box.read(b).sample), 2) << "the last of that connection";
}

TEST(Mailbox, a_reader_that_waits_is_woken_by_a_sample_and_by_the_end) {
  Mailbox box;
  auto settings = buffer(FullPolicy::overwrite, EmptyPolicy::block);
  settings.read_timeout = std::chrono::seconds(60);
  const auto channel = box.open(settings);
  std::thread writer([&] { box.write(channel, sample(5)); });
  EXPECT_EQ(number(box.read().sample), 5);
  writer.join();
  std::thread closer([&] { box.close(channel); });
  EXPECT_NE(box.read().status, PortStatus::ok);
  closer.join();
}

TEST(Mailbox, a_writer_that_waits_is_released_when_the_connection_ends) {
  Mailbox box;
  auto settings = buffer(FullPolicy::block, EmptyPolicy::do_nothing, 1);
  settings.write_timeout = std::chrono::seconds(60);
  const auto channel = box.open(settings);
  box.write(channel, sample(1));
  std::thread closer([&] { box.close(channel); });
  EXPECT_EQ(box.write(channel, sample(2)).status, PortStatus::precondition_not_met);
  closer.join();
}

TEST(Mailbox, a_finished_channel_is_read_to_its_end_and_not_written) {
  Mailbox box;
  const auto ended = box.open(buffer(FullPolicy::block, EmptyPolicy::readback, 2));
  const auto open = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::do_nothing));
  box.write(ended, sample(1));
  box.write(open, sample(2));
  box.write(ended, sample(3));
  box.finish(ended);
  EXPECT_EQ(box.write(ended, sample(4)).status, PortStatus::precondition_not_met);
  for (const int expected : {1, 2, 3}) EXPECT_EQ(number(box.read().sample), expected);
  EXPECT_EQ(box.read().status, PortStatus::buffer_empty) << "nothing of it is read again";
  EXPECT_EQ(box.read(ended).status, PortStatus::precondition_not_met);
  box.finish(open);
  EXPECT_EQ(box.read().status, PortStatus::precondition_not_met) << "nothing was unread";
}

constexpr std::size_t small = 10'000;  // [octets] for the memory of a mailbox, in these tests

Sample long_sample(int number, std::size_t octets) {
  Sample made = sample(number);
  auto block = std::make_shared<Block>(octets);
  block->set_size(1);
  *block->data() = static_cast<std::byte>(number);
  made.block = block;
  return made;
}

TEST(Mailbox, long_samples_fill_a_ring_before_its_places_do) {
  Mailbox box(small);
  const auto overwrites = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::do_nothing, 1000));
  for (int i = 1; i <= 3; ++i) EXPECT_FALSE(box.write(overwrites, long_sample(i, 3000)).overwrote);
  EXPECT_TRUE(box.write(overwrites, long_sample(4, 3000)).overwrote);
  EXPECT_EQ(box.unread(), 3u);
  const auto refuses = box.open(buffer(FullPolicy::do_nothing, EmptyPolicy::do_nothing, 1000));
  EXPECT_EQ(box.write(refuses, long_sample(5, 3000)).status, PortStatus::ok) << "the first of another connection";
  EXPECT_EQ(box.write(refuses, long_sample(6, 3000)).status, PortStatus::buffer_full);
  const auto waits = box.open(buffer(FullPolicy::block, EmptyPolicy::do_nothing, 1000));
  EXPECT_EQ(box.write(waits, sample(7)).status, PortStatus::ok);
  EXPECT_EQ(box.write(waits, sample(8)).status, PortStatus::buffer_timeout);
  for (const int expected : {2, 3, 4, 5, 7}) EXPECT_EQ(number(box.read().sample), expected);
  EXPECT_EQ(box.write(waits, sample(9)).status, PortStatus::ok);
}

TEST(Mailbox, what_all_connections_bring_takes_a_bounded_memory) {
  Mailbox box(small);
  int taken = 0;
  for (int i = 0; i < 100; ++i)
    taken += box.write(box.open(buffer(FullPolicy::overwrite, EmptyPolicy::do_nothing)), long_sample(i, 3000)).status == PortStatus::ok;
  EXPECT_EQ(taken, 6);
  EXPECT_EQ(box.unread(), 6u);
}

TEST(Mailbox, a_sample_longer_than_the_memory_that_is_meant_to_be_is_still_taken_alone) {
  Mailbox box(small);
  const auto channel = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::do_nothing));
  for (const int i : {1, 2}) EXPECT_EQ(box.write(channel, long_sample(i, 15'000)).status, PortStatus::ok);
  EXPECT_EQ(number(box.read().sample), 2);
}

TEST(Ring, is_full_of_octets) {
  Ring ring(1000, small);
  for (int i = 1; i <= 4; ++i) EXPECT_FALSE(ring.push(long_sample(i, 3000)));
  EXPECT_TRUE(ring.is_full());
  EXPECT_TRUE(ring.push(long_sample(5, 3000)));
  EXPECT_EQ(number(ring.pop()), 2);
  EXPECT_FALSE(ring.is_full());
}

TEST(Mailbox, with_a_rendezvous_a_write_returns_when_it_was_read) {
  Mailbox box;
  auto settings = buffer(FullPolicy::overwrite, EmptyPolicy::readback);
  settings.write_timeout = settings.read_timeout = std::chrono::seconds(60);
  const auto channel = box.open(settings);
  box.set_rendezvous(channel, true);
  std::atomic<int> read{0};
  std::thread reader([&] { read = number(box.read().sample); });
  EXPECT_EQ(box.write(channel, sample(9)).status, PortStatus::ok);
  reader.join();
  EXPECT_EQ(read, 9);
}

TEST(SendQueue, policies_choose_what_is_sent) {
  const auto fill = [](PushPolicy policy, std::size_t skip = 0) {
    SendQueue queue(8, {policy, skip, {}});
    for (int i = 1; i <= 5; ++i) queue.push(sample(i));
    return queue;
  };
  EXPECT_EQ(numbers(fill(PushPolicy::all).next_batch()), (std::vector<int>{1, 2, 3, 4, 5}));
  EXPECT_EQ(numbers(fill(PushPolicy::fifo).next_batch()), (std::vector<int>{1}));
  EXPECT_EQ(numbers(fill(PushPolicy::newest).next_batch()), (std::vector<int>{5}));
  auto skipping = fill(PushPolicy::skip, 1);
  EXPECT_EQ(numbers(skipping.next_batch()), (std::vector<int>{2, 4}));
  for (int i = 6; i <= 7; ++i) skipping.push(sample(i));
  EXPECT_EQ(numbers(skipping.next_batch()), (std::vector<int>{6})) << "the count goes on from batch to batch";
}

TEST(SendQueue, what_could_not_be_sent_comes_first_again) {
  SendQueue queue(3, {PushPolicy::all, 0, {}});
  queue.push(sample(3));
  queue.put_back({sample(0), sample(1), sample(2)});
  EXPECT_EQ(numbers(queue.next_batch()), (std::vector<int>{1, 2, 3})) << "the oldest has no room";
  SendQueue newest(3, {PushPolicy::newest, 0, {}});
  newest.push(sample(3));
  newest.put_back({sample(2)});
  EXPECT_EQ(numbers(newest.next_batch()), (std::vector<int>{3}));
}

TEST(BlockPool, blocks_come_back) {
  const auto pool = BlockPool::make();
  const void* first = pool->take(1000)->data();
  EXPECT_EQ(pool->take(900)->data(), first);
}

}  // namespace
}  // namespace rt::mailboxes
