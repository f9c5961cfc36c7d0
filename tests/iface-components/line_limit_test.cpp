// How often a component logs a failure that clients of the wire can cause.
#include "line_limit.h"

#include <gtest/gtest.h>

namespace iface {
namespace {

using std::chrono::milliseconds;

TEST(LineLimit, eight_lines_come_at_once_and_then_one_a_second_with_the_number_of_the_others) {
  LineLimit limit;
  const std::chrono::steady_clock::time_point start(std::chrono::hours(1));
  int said = 0;
  for (int i = 0; i < 1000; ++i) said += limit.next("no simulator", start) == "no simulator" ? 1 : 0;
  EXPECT_EQ(said, 8);
  EXPECT_EQ(limit.next("no simulator", start + milliseconds(999)), std::nullopt);
  EXPECT_EQ(limit.next("no simulator", start + milliseconds(1001)), "no simulator (993 more lines like this are not in the log)");
  EXPECT_EQ(limit.next("no simulator", start + milliseconds(1002)), std::nullopt);
  EXPECT_EQ(limit.next("no simulator", start + milliseconds(20000)), "no simulator (1 more lines like this are not in the log)");
}

}  // namespace
}  // namespace iface
