#include "base/suggestion.h"

#include <gtest/gtest.h>

namespace base {
namespace {

const std::vector<std::string> verbs{"ls", "list", "cat", "con", "record", "recording", "velocity"};

TEST(Suggestion, a_slip_gives_the_name_that_was_meant) {
  EXPECT_EQ(nearest("lst", verbs), "ls");
  EXPECT_EQ(nearest("lits", verbs), "list");
  EXPECT_EQ(nearest("velocty", verbs), "velocity");
  EXPECT_EQ(nearest("RECORD", verbs), "record");
  EXPECT_EQ(nearest("recrod", verbs), "record");
  EXPECT_EQ(suggestion("recrod", verbs), "; did you mean record?");
}

TEST(Suggestion, the_last_part_of_a_name_is_enough) {
  const std::vector<std::string> ifaces{"pioneer2dx::laser", "pioneer2dx::sonar", "host/Camera0"};
  EXPECT_EQ(nearest("lasr", ifaces), "pioneer2dx::laser");
  EXPECT_EQ(nearest("Camera1", ifaces), "host/Camera0");
  EXPECT_EQ(nearest("pionner2dx::sonar", ifaces), "pioneer2dx::sonar");
}

TEST(Suggestion, nothing_is_suggested_for_a_name_that_is_like_none) {
  EXPECT_EQ(nearest("something", verbs), "");
  EXPECT_EQ(nearest("x", verbs), "");
  EXPECT_EQ(nearest("", verbs), "");
  EXPECT_EQ(nearest("list", {}), "");
  EXPECT_EQ(suggestion("something", verbs), "");
  EXPECT_EQ(nearest("nowhere.sdf", {"power.sdf", "empty.sdf", "worlds"}), "");
  EXPECT_EQ(nearest("farm.sdf", {"arm.sdf"}), "arm.sdf");
  EXPECT_EQ(nearest("must", {"list", "mast.yaml"}), "");
  EXPECT_EQ(nearest(std::string(100'000, 'l'), verbs), "");
}

}  // namespace
}  // namespace base
