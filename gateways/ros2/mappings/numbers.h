// Mappings of numbers, texts and sequences of numbers to messages of std_msgs. These messages have no time: a received sample has time 0.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>

#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "ros/plain_messages.h"
#include "ros2/port_mapping.h"

namespace ros2 {

// The nearest number that To has, without what is behind the point for integers; 0 for what is no number.
template <class To, class From>
To number_to(From value) {
  using Limits = std::numeric_limits<To>;
  if constexpr (std::is_same_v<To, bool>) {
    return value != 0;
  } else if constexpr (std::is_floating_point_v<To>) {
    return static_cast<To>(value);
  } else if constexpr (std::is_floating_point_v<From>) {
    if (std::isnan(value)) return 0;
    // The greatest numbers of 64 bits are none of From: they are compared with the power of two above them.
    if (value >= std::ldexp(static_cast<From>(1), Limits::digits)) return Limits::max();
    if (value <= static_cast<From>(Limits::min())) return Limits::min();
    return static_cast<To>(value);
  } else {
    if (std::cmp_greater(+value, +Limits::max())) return Limits::max();  // +: characters and truth values as numbers
    if (std::cmp_less(+value, +Limits::min())) return Limits::min();
    return static_cast<To>(value);
  }
}

template <class Timed, ros::Message T>
struct NumberAndNumber {
  using Data = Timed;
  using Message = T;
  static Message to_ros(const Data& data) { return {number_to<decltype(Message::data)>(data.data)}; }
  static void from_ros(const Message& message, Data& data) {
    data.tm = {};
    data.data = number_to<decltype(Data::data)>(message.data);
  }
};

struct TextAndString {
  using Data = RTC::TimedString;
  using Message = ros::Text;
  static Message to_ros(const Data& data) { return {std::string(data.data.in())}; }
  static void from_ros(const Message& message, Data& data) {
    data.tm = {};
    data.data = message.data.c_str();
  }
};

template <class Timed, ros::Message T>
struct SequenceAndArray {
  using Data = Timed;
  using Message = T;
  using Number = typename decltype(Message::data)::value_type;
  using Own = std::remove_cvref_t<decltype(std::declval<Data>().data[0])>;
  static Message to_ros(const Data& data) {
    Message message;
    message.data.reserve(data.data.length());
    for (CORBA::ULong i = 0; i < data.data.length(); ++i) message.data.push_back(number_to<Number>(data.data[i]));
    return message;
  }
  // False if the layout leaves out more than there is.
  static bool from_ros(const Message& message, Data& data) {
    const std::size_t begin = message.layout.data_offset;
    if (begin > message.data.size()) return false;
    data.tm = {};
    data.data.length(static_cast<CORBA::ULong>(message.data.size() - begin));
    for (CORBA::ULong i = 0; i < data.data.length(); ++i) data.data[i] = number_to<Own>(message.data[begin + i]);
    return true;
  }
};

}  // namespace ros2
