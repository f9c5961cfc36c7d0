#include "run/pose_record.h"

#include <gtest/gtest.h>

namespace tools {
namespace {

TEST(PoseRecord, goes_on_when_the_last_moving_model_was_deleted) {
  PoseRecord record;
  record.add_pose("robot", {0.1, 1, 2, 3});
  record.add_still(0.2);
  EXPECT_EQ(record.last, 0.2);
  EXPECT_EQ(record.poses.at("robot").size(), 1U);
}

TEST(PoseRecord, ends_with_the_run) {
  PoseRecord record;
  record.set_end(2);
  record.add_pose("robot", {1, 1, 0, 0});
  record.add_pose("robot", {2, 3, 0, 0});
  record.add_contact({2.5, "robot", "box"});
  record.add_pose("robot", {3, 9, 0, 0});
  EXPECT_EQ(path_length(record.poses.at("robot")), 2);
  EXPECT_TRUE(record.contacts.empty());
}

TEST(PoseRecord, ends_with_a_reset_of_the_world) {
  PoseRecord record;
  record.add_pose("robot", {1, 1, 0, 0});
  record.add_pose("robot", {2, 3, 0, 0});
  record.add_pose("robot", {0.1, 0, 0, 0});
  record.add_contact({0.15, "robot", "box"});
  record.add_pose("robot", {3, 7, 0, 0});
  EXPECT_EQ(path_length(record.poses.at("robot")), 2);
  EXPECT_TRUE(record.contacts.empty());
  EXPECT_EQ(record.last, 2);
}

}  // namespace
}  // namespace tools
