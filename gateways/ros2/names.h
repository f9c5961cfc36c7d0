// Names of ROS 2: what the wire has for topics, types and services, and names of ROS from those of a world. Pure; any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ros2 {

// One part of a name from any text: letters, digits and '_' stay, other characters become '_'; '_' comes before a digit in front.
std::string token(std::string_view text);
// "outer::inner-1" -> "outer/inner_1"
std::string tokens(std::string_view scoped);
// What is wrong with a full name such as "/r1/scan"; nothing when it is one.
std::optional<std::string> problem_of_name(std::string_view name);

// "/r1/scan" -> "rt/r1/scan"
std::string topic_on_wire(std::string_view topic);
// "/r1/get" -> "rq/r1/getRequest", "rr/r1/getReply"
std::string request_on_wire(std::string_view service);
std::string reply_on_wire(std::string_view service);
// "sensor_msgs/msg/Imu" -> "sensor_msgs::msg::dds_::Imu_"
std::string type_on_wire(std::string_view type);
// The other way; what is no type of ROS stays as it is.
std::string type_of_ros(std::string_view type_on_wire);
// The value of KEY in "key=value;key=value;"; nothing when it is not there.
std::optional<std::string> value_in(std::string_view user_data, std::string_view key);

}  // namespace ros2
