#include "shm/pose_log.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace shm {
namespace {

struct Lines final : PoseLogSink {
  std::vector<std::string> lines;
  void pose(double time, const std::string& model, const Pose& pose) override {
    lines.push_back(std::to_string(time) + " " + model + " " + std::to_string(pose.x) + " " + std::to_string(pose.qw));
  }
  void contact(double time, const std::string& model, const std::string& other) override {
    lines.push_back(std::to_string(time) + " " + model + " touches " + other);
  }
  void still(double time) override { lines.push_back(std::to_string(time) + " still"); }
  void joint(double time, const std::string& model, const std::string& joint, double position) override {
    lines.push_back(std::to_string(time) + " " + model + "::" + joint + " " + std::to_string(position));
  }
};

const std::vector<std::string> expected = {
    "0.100000 my robot 1.500000 1.000000", "0.105000 my robot touches box", "0.200000 still",
    "0.300000 other 2.500000 1.000000",    "0.300000 other::hip -0.250000", "0.400000 other::knee 0.125000"};

void write(PoseLogWriter& writer) {
  writer.pose(0.1, 7, "my robot", {1.5, 0, 0, 1, 0, 0, 0});
  writer.contact(0.105, 7, "my robot", 8, "box");
  writer.still(0.2);
  writer.pose(0.3, 7, "other", {2.5, 0, 0, 1, 0, 0, 0});  // the number was given to another model
  writer.joint(0.3, 7, "other", 3, "hip", -0.25);
  writer.joint(0.4, 7, "other", 3, "knee", 0.125);  // and so was that of its joint
}

TEST(PoseLog, is_read_as_it_was_written_however_it_is_cut) {
  for (const std::size_t size : {std::size_t{1}, std::size_t{7}, std::size_t{24}, std::size_t{100}, std::size_t{10'000}}) {
    PoseLogWriter writer;
    write(writer);
    PoseLogReader reader;
    Lines seen;
    const auto all = writer.take(0);
    ASSERT_TRUE(all);
    for (std::size_t at = 0; at < all->size(); at += size) ASSERT_TRUE(reader.read(all->substr(at, size), seen));
    EXPECT_EQ(seen.lines, expected) << size;
  }
}

TEST(PoseLog, what_was_read_is_forgotten) {
  PoseLogWriter writer;
  write(writer);
  const auto end = writer.end();
  EXPECT_EQ(writer.take(end)->size(), 0U);
  writer.still(0.4);
  EXPECT_EQ(writer.end(), end + 24);
  const auto again = writer.take(0);
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().message.find("asked for 0"), std::string::npos);
  EXPECT_FALSE(writer.take(writer.end() + 1));
  EXPECT_EQ(writer.take(end)->size(), 24U);
}

TEST(PoseLog, other_bytes_are_refused) {
  Lines seen;
  EXPECT_FALSE(PoseLogReader().read(std::string(100, '\xff'), seen)) << "too long an entry";
  PoseLogWriter writer;
  write(writer);
  auto bytes = *writer.take(0);
  EXPECT_FALSE(PoseLogReader().read(bytes.substr(24 + 8), seen)) << "a pose of a model without a name";
}

}  // namespace
}  // namespace shm
