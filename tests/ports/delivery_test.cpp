// Delivery by the clock: what is written in a phase of a tick is read in later ones, whoever of the phase came first.
#include <gtest/gtest.h>

#include "base/tick.h"
#include "core/mailbox.h"
#include "core/publisher.h"

namespace rt {
namespace {

using std::chrono::milliseconds;

Sample sample(int number, std::uint64_t phase_counter = 0) {
  auto block = std::make_shared<Block>(1);
  block->set_size(1);
  *block->data() = static_cast<std::byte>(number);
  Sample made;
  made.block = block;
  made.phase_counter = phase_counter;
  return made;
}
int number(const Sample& of) { return of.block ? static_cast<int>(*of.block->data()) : -1; }

BufferSettings buffer(FullPolicy full, EmptyPolicy empty = EmptyPolicy::do_nothing, std::size_t length = 2) {
  return {length, full, empty, milliseconds(1), std::chrono::hours(1)};
}

constexpr std::uint64_t phase_1 = 3, after_1 = 4, phase_2 = 5, next_tick = 7;

TEST(Delivery, what_is_written_in_a_phase_is_read_in_the_next_ones_and_not_in_it) {
  Mailbox box;
  const auto channel = box.open(buffer(FullPolicy::overwrite));
  box.write(channel, sample(1, phase_1));
  EXPECT_EQ(box.unread(Channel::any, phase_1), 0U);
  EXPECT_EQ(box.read(Channel::any, phase_1).status, PortStatus::buffer_empty);
  EXPECT_EQ(box.unread(Channel::any, phase_2), 1U);
  EXPECT_EQ(number(box.read(Channel::any, phase_2).sample), 1);
}

TEST(Delivery, what_comes_between_ticks_or_without_lock_step_is_read_at_once) {
  Mailbox box;
  const auto channel = box.open(buffer(FullPolicy::overwrite));
  box.write(channel, sample(1, after_1));
  EXPECT_EQ(number(box.read(Channel::any, phase_2).sample), 1);
  box.write(channel, sample(2, 0));
  EXPECT_EQ(number(box.read(Channel::any, phase_2).sample), 2);
  box.write(channel, sample(3, phase_2));
  EXPECT_EQ(number(box.read(Channel::any, 0).sample), 3) << "a thread outside of all ticks";
}

TEST(Delivery, a_full_ring_loses_the_same_whether_the_reader_of_the_phase_came_before_the_writer_or_after_it) {
  for (const bool reader_is_first : {true, false}) {
    Mailbox box;
    const auto channel = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::do_nothing, 1));
    box.write(channel, sample(1, phase_1));
    ReadResult read;
    WriteResult written;
    if (reader_is_first) read = box.read(Channel::any, phase_2);
    written = box.write(channel, sample(2, phase_2));
    if (!reader_is_first) read = box.read(Channel::any, phase_2);
    EXPECT_EQ(number(read.sample), 1);
    EXPECT_TRUE(written.overwrote) << "as far as the writer can know";
    EXPECT_EQ(number(box.read(Channel::any, next_tick).sample), 2);
  }
}

TEST(Delivery, a_ring_that_refuses_answers_the_same_whether_the_reader_came_before_the_writer_or_after_it) {
  for (const bool reader_is_first : {true, false}) {
    Mailbox box;
    const auto channel = box.open(buffer(FullPolicy::do_nothing, EmptyPolicy::do_nothing, 1));
    box.write(channel, sample(1, phase_1));
    if (reader_is_first) box.read(Channel::any, phase_2);
    EXPECT_EQ(box.write(channel, sample(2, phase_2)).status, PortStatus::buffer_full);
    if (!reader_is_first) box.read(Channel::any, phase_2);
    EXPECT_EQ(box.write(channel, sample(3, next_tick)).status, PortStatus::ok);
  }
}

TEST(Delivery, samples_of_one_phase_are_read_by_the_names_of_their_connections) {
  Mailbox box;
  const auto second = box.open(buffer(FullPolicy::overwrite), "b"), first = box.open(buffer(FullPolicy::overwrite), "a");
  box.write(second, sample(2, phase_1));
  box.write(first, sample(1, phase_1));
  EXPECT_EQ(number(box.read(Channel::any, phase_2).sample), 1);
  EXPECT_EQ(number(box.read(Channel::any, phase_2).sample), 2);
}

TEST(Delivery, a_reader_in_a_phase_does_not_wait_for_what_nobody_can_bring_it) {
  Mailbox box;
  const auto channel = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::block));
  box.write(channel, sample(1, phase_1));
  EXPECT_EQ(box.read(Channel::any, phase_1).status, PortStatus::buffer_timeout);
}

TEST(Delivery, a_reader_in_a_phase_reads_back_what_it_had_before) {
  Mailbox box;
  const auto channel = box.open(buffer(FullPolicy::overwrite, EmptyPolicy::readback));
  box.write(channel, sample(1, phase_1));
  box.read(Channel::any, phase_2);
  box.write(channel, sample(2, phase_2));
  EXPECT_EQ(number(box.read(Channel::any, phase_2).sample), 1);
  EXPECT_EQ(number(box.read(Channel::any, next_tick).sample), 2);
}

TEST(Delivery, a_lock_step_that_counts_anew_after_a_restart_keeps_the_rule) {
  Mailbox box;
  const auto channel = box.open(buffer(FullPolicy::overwrite));
  box.write(channel, sample(1, 1001));
  box.drop_other_epochs(1);
  auto fresh = sample(2, phase_1);
  fresh.epoch = 1;
  box.write(channel, fresh);
  EXPECT_EQ(box.read(Channel::any, phase_1).status, PortStatus::buffer_empty);
  EXPECT_EQ(number(box.read(Channel::any, phase_2).sample), 2);
}

class FakeTick final : public base::Tick {
 public:
  std::chrono::nanoseconds time() const override { return now; }
  std::uint64_t phase_counter() const override { return 1; }
  void at_end(std::function<void(Tick&)> work) override { work_.push_back(std::move(work)); }
  bool keeps_data() const override { return false; }
  void passed(const base::Passage&) override {}
  bool passed_again(const base::Passage&, std::uint64_t) override { return false; }
  void end() {
    for (auto& work : std::exchange(work_, {})) work(*this);
  }
  std::chrono::nanoseconds now{0};

 private:
  std::vector<std::function<void(Tick&)>> work_;
};

struct Sent {
  std::vector<int> numbers;
  int starved = 0;
  PortStatus answer = PortStatus::ok;
  Publisher::Hooks hooks() {
    return {[this](const Sample& s) {
              if (answer == PortStatus::ok) numbers.push_back(number(s));
              return answer;
            },
            [this] { ++starved; },
            {}};
  }
};

TEST(Delivery, a_publisher_of_new_data_sends_by_its_policy_when_the_tick_ends) {
  for (const auto& [policy, expected] : {std::pair(PushPolicy::all, std::vector{1, 2, 3}), std::pair(PushPolicy::newest, std::vector{3}),
                                         std::pair(PushPolicy::fifo, std::vector{1, 2, 3})}) {
    Sent sent;
    FakeTick tick;
    Publisher publisher(Subscription::newest, {policy, 0, {}}, {}, sent.hooks());
    for (int i = 1; i <= 3; ++i) publisher.write(sample(i), &tick);
    EXPECT_TRUE(sent.numbers.empty()) << "not before";
    tick.end();
    EXPECT_EQ(sent.numbers, expected);
  }
}

TEST(Delivery, a_queue_that_is_full_in_a_tick_is_sent_before_more_is_written) {
  Sent sent;
  FakeTick tick;
  Publisher publisher(Subscription::newest, {PushPolicy::all, 0, {}}, buffer(FullPolicy::do_nothing), sent.hooks());
  for (int i = 1; i <= 5; ++i) EXPECT_EQ(publisher.write(sample(i), &tick).status, PortStatus::ok);
  tick.end();
  EXPECT_EQ(sent.numbers, (std::vector{1, 2, 3, 4, 5}));
}

TEST(Delivery, a_receiver_that_is_full_is_tried_again_at_the_end_of_the_next_tick) {
  Sent sent;
  FakeTick tick;
  Publisher publisher(Subscription::newest, {PushPolicy::all, 0, {}}, {}, sent.hooks());
  sent.answer = PortStatus::send_full;
  publisher.write(sample(1), &tick);
  tick.end();
  sent.answer = PortStatus::ok;
  EXPECT_TRUE(sent.numbers.empty());
  tick.end();
  EXPECT_EQ(sent.numbers, std::vector{1});
}

TEST(Delivery, a_periodic_publisher_sends_by_simulated_time) {
  Sent sent;
  FakeTick tick;
  ManualTime wall;
  Publisher publisher(Subscription::periodic, {PushPolicy::fifo, 0, milliseconds(20)}, {}, sent.hooks(), wall);
  std::vector<std::size_t> counts;
  for (int i = 0; i < 5; ++i) {
    tick.now = milliseconds(10 + 10 * i);  // 10, 20, 30, 40, 50
    publisher.write(sample(i), &tick);
    wall.advance(std::chrono::hours(1));
    tick.end();
    counts.push_back(sent.numbers.size());
  }
  EXPECT_EQ(counts, (std::vector<std::size_t>{0, 1, 1, 2, 2}));
  EXPECT_EQ(sent.numbers, (std::vector{0, 1}));
  EXPECT_EQ(sent.starved, 0);
}

TEST(Delivery, a_periodic_publisher_with_nothing_to_send_says_so_in_each_period_of_simulated_time) {
  Sent sent;
  FakeTick tick;
  const ManualTime wall;
  Publisher publisher(Subscription::periodic, {PushPolicy::all, 0, milliseconds(10)}, {}, sent.hooks(), wall);
  publisher.write(sample(1), &tick);
  for (int i = 0; i < 4; ++i) {
    tick.now = milliseconds(10 * i);
    tick.end();
  }
  EXPECT_EQ(sent.numbers, std::vector{1});
  EXPECT_EQ(sent.starved, 3);
}

}  // namespace
}  // namespace rt
