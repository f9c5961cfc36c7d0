// Messages of ROS 2: their definitions, their octets, and what is read back of both.
#include "channels/ros_schema.h"
#include "ros/messages.h"

#include <gtest/gtest.h>

#include "recording/ros_text.h"

namespace {

TEST(RosMessages, a_definition_brings_what_it_needs_once_and_in_order) {
  const auto schema = channels::schema_of<ros::TFMessage>();
  EXPECT_EQ(schema.name, "tf2_msgs/msg/TFMessage");
  EXPECT_EQ(schema.encoding, "ros2msg");
  const std::string line = std::string(80, '=') + "\n";
  EXPECT_EQ(schema.text, "geometry_msgs/TransformStamped[] transforms\n" + line +
                             "MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform "
                             "transform\n" +
                             line + "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + line +
                             "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n" + line +
                             "MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n" + line +
                             "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n" + line +
                             "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
}

TEST(RosMessages, octets_are_aligned_behind_the_head) {
  using namespace std::string_literals;
  const auto octets = ros::encode(ros::NavSatStatus{.status = -1, .service = 0x0102});
  EXPECT_EQ(std::string(octets.begin(), octets.end()), "\0\1\0\0\xff\0\2\1"s);
  const auto log = ros::encode(ros::Log{.stamp = {1, 2}, .level = 30, .logger = "a", .msg = "", .line = 7});
  EXPECT_EQ(std::string(log.begin(), log.end()),
            "\0\1\0\0"
            "\1\0\0\0\2\0\0\0\x1e\0\0\0"
            "\2\0\0\0a\0\0\0"
            "\1\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0\7\0\0\0"s);
}

TEST(RosMessages, what_is_written_is_read_back) {
  const std::uint8_t pixels[] = {1, 2, 3, 4};
  const ros::Image image{
      .header = {{5, 6}, "camera"}, .height = 2, .width = 2, .encoding = "mono8", .is_bigendian = 0, .step = 2, .data = pixels};
  const auto definition = recorder::RosDefinition::parse(channels::schema_of<ros::Image>().text);
  ASSERT_TRUE(definition) << definition.error().message;
  const auto octets = ros::encode(image);
  const auto json = definition->decode({octets.data(), octets.size()});
  ASSERT_TRUE(json) << json.error().message;
  EXPECT_EQ(json->dump(),
            R"({"header":{"stamp":{"sec":5,"nanosec":6},"frame_id":"camera"},"height":2,"width":2,"encoding":"mono8","is_bigendian":0,)"
            R"("step":2,"data":"AQIDBA=="})");
}

TEST(RosMessages, samples_that_are_cut_anywhere_are_refused) {
  const auto definition = recorder::RosDefinition::parse(channels::schema_of<ros::DiagnosticArray>().text);
  ASSERT_TRUE(definition) << definition.error().message;
  const auto octets = ros::encode(ros::DiagnosticArray{{{1, 2}, "f"}, {{ros::Byte{1}, "laser", "late", "", {{"age", "2 s"}}}}});
  ASSERT_TRUE(definition->decode({octets.data(), octets.size()}));
  for (std::size_t size = 0; size < octets.size(); ++size) {
    const auto json = definition->decode({octets.data(), size});
    ASSERT_FALSE(json) << size;
    EXPECT_TRUE(json.error().message.starts_with("ros2msg: ")) << json.error().message;
  }
}

TEST(RosMessages, definitions_of_others_are_understood) {
  const auto definition = recorder::RosDefinition::parse(
      "# a comment\nint32 LIMIT=3   # no member\nstring<=5 name \"unnamed\"\nuint8[<=4] few\nint16[2] pair\nPart[] parts\n"
      "====\nMSG: my_pkg/msg/Part\nbool is_on\nchar letter\n");
  ASSERT_TRUE(definition) << definition.error().message;
  using namespace std::string_view_literals;
  const auto json = definition->decode(
      "\0\1\0\0"
      "\2\0\0\0a\0\0\0"
      "\1\0\0\0\7\0"
      "\1\0\2\0\0\0"
      "\1\0\0\0\1\x41"sv);
  ASSERT_TRUE(json) << json.error().message;
  EXPECT_EQ(json->dump(), R"({"name":"a","few":"Bw==","pair":[1,2],"parts":[{"is_on":true,"letter":65}]})");
}

TEST(RosMessages, hostile_definitions_and_lengths_end_at_once) {
  EXPECT_FALSE(recorder::RosDefinition::parse("Nowhere x\n"));
  EXPECT_FALSE(recorder::RosDefinition::parse("int8[99999999999] x\n"));
  const auto endless = recorder::RosDefinition::parse("A a\n===\nMSG: p/A\nA a\n");
  ASSERT_TRUE(endless);
  EXPECT_FALSE(endless->decode(std::string_view("\0\1\0\0", 4)));
  const auto empty = recorder::RosDefinition::parse("E[] many\n===\nMSG: p/E\n");
  ASSERT_TRUE(empty);
  EXPECT_FALSE(empty->decode(std::string_view("\0\1\0\0\xff\xff\xff\xff", 8)));
}

}  // namespace
