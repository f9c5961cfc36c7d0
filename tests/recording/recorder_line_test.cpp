#include "recording/recorder_line.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <utility>

namespace recorder {
namespace {

using namespace std::chrono_literals;

std::pair<RecorderLine, RecorderLine> ends() {
  auto line = RecorderLine::make();
  return {std::move(line->first), RecorderLine(std::move(line->second))};
}

TEST(RecorderLine, messages_come_one_by_one_in_their_order) {
  auto [run, recorder] = ends();
  ASSERT_TRUE(run.send(RecorderMessage::look_again));
  ASSERT_TRUE(run.send(RecorderMessage::stop));
  EXPECT_EQ(*recorder.receive(60s), RecorderMessage::look_again);
  EXPECT_EQ(*recorder.receive(60s), RecorderMessage::stop);
  EXPECT_EQ(*recorder.receive(0ms), std::nullopt);
  ASSERT_TRUE(recorder.send(RecorderMessage::stopped));
  EXPECT_EQ(*run.receive(60s), RecorderMessage::stopped);
}

TEST(RecorderLine, a_side_that_has_exited_is_an_error_for_the_other) {
  auto [run, recorder] = ends();
  { const auto gone = std::move(recorder); }
  EXPECT_FALSE(run.receive(60s));
  EXPECT_FALSE(run.send(RecorderMessage::stop));
}

TEST(RecorderLine, what_is_no_message_is_refused) {
  auto [run, recorder] = ends();
  for (const unsigned char octet : {0, 200}) {
    ASSERT_EQ(::send(run.descriptor(), &octet, 1, 0), 1);
    EXPECT_FALSE(recorder.receive(60s));
  }
}

TEST(RecorderLine, a_reader_that_hangs_holds_up_nobody) {
  auto [run, recorder] = ends();
  bool is_full = false;
  for (int i = 0; i < 100'000 && !is_full; ++i) is_full = !run.send(RecorderMessage::look_again);
  EXPECT_TRUE(is_full);
}

}  // namespace
}  // namespace recorder
