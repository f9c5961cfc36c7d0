#include <rtm/Manager.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <string>

#include <ros2/port_mapping.h>

// A message of your own: its name, and its fields in the order of the .msg file.
struct Label {
  static constexpr std::string_view name = "shop_msgs/msg/Label";
  ros::Header header{};
  std::string text{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("text", m.text);
  }
};

struct StringAndLabel : ros2::Frames {
  using Data = RTC::TimedString;
  using Message = Label;
  Message to_ros(const Data& data) const { return {header(data.tm), data.data.in()}; }
  void from_ros(const Message& message, Data& data) const {
    ros2::set_time(data.tm, message.header.stamp);
    data.data = message.text.c_str();
  }
};

extern "C" void OwnMappingInit(RTC::Manager*) { ros2::add_mapping<StringAndLabel>(); }
