// Messages of ROS 2 that hold one value: numbers, arrays of numbers, geometry with a stamp. Values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ros/messages.h"

namespace ros {

// The name of a message as a template argument.
template <std::size_t size>
struct WireName {
  char text[size]{};
  constexpr WireName(const char (&from)[size]) { std::copy_n(from, size, text); }  // NOLINT(google-explicit-constructor): a literal
};

template <class T, WireName wire_name>
struct Single {
  static constexpr std::string_view name{wire_name.text};
  T data{};
  static void fields(auto& m, auto& visit) { visit("data", m.data); }
};
using Bool = Single<bool, "std_msgs/msg/Bool">;
using Int8 = Single<std::int8_t, "std_msgs/msg/Int8">;
using Int16 = Single<std::int16_t, "std_msgs/msg/Int16">;
using Int32 = Single<std::int32_t, "std_msgs/msg/Int32">;
using Int64 = Single<std::int64_t, "std_msgs/msg/Int64">;
using UInt8 = Single<std::uint8_t, "std_msgs/msg/UInt8">;
using UInt16 = Single<std::uint16_t, "std_msgs/msg/UInt16">;
using UInt32 = Single<std::uint32_t, "std_msgs/msg/UInt32">;
using UInt64 = Single<std::uint64_t, "std_msgs/msg/UInt64">;
using Float32 = Single<float, "std_msgs/msg/Float32">;
using Float64 = Single<double, "std_msgs/msg/Float64">;

struct MultiArrayDimension {
  static constexpr std::string_view name = "std_msgs/msg/MultiArrayDimension";
  std::string label{};
  std::uint32_t size = 0;
  std::uint32_t stride = 0;
  static void fields(auto& m, auto& visit) {
    visit("label", m.label);
    visit("size", m.size);
    visit("stride", m.stride);
  }
};
struct MultiArrayLayout {
  static constexpr std::string_view name = "std_msgs/msg/MultiArrayLayout";
  std::vector<MultiArrayDimension> dim{};
  std::uint32_t data_offset = 0;  // elements before the first one that counts
  static void fields(auto& m, auto& visit) {
    visit("dim", m.dim);
    visit("data_offset", m.data_offset);
  }
};
template <class T, WireName wire_name>
struct MultiArray {
  static constexpr std::string_view name{wire_name.text};
  MultiArrayLayout layout{};
  std::vector<T> data{};
  static void fields(auto& m, auto& visit) {
    visit("layout", m.layout);
    visit("data", m.data);
  }
};
using Int8MultiArray = MultiArray<std::int8_t, "std_msgs/msg/Int8MultiArray">;
using Int16MultiArray = MultiArray<std::int16_t, "std_msgs/msg/Int16MultiArray">;
using Int32MultiArray = MultiArray<std::int32_t, "std_msgs/msg/Int32MultiArray">;
using Int64MultiArray = MultiArray<std::int64_t, "std_msgs/msg/Int64MultiArray">;
using UInt8MultiArray = MultiArray<std::uint8_t, "std_msgs/msg/UInt8MultiArray">;
using UInt16MultiArray = MultiArray<std::uint16_t, "std_msgs/msg/UInt16MultiArray">;
using UInt32MultiArray = MultiArray<std::uint32_t, "std_msgs/msg/UInt32MultiArray">;
using UInt64MultiArray = MultiArray<std::uint64_t, "std_msgs/msg/UInt64MultiArray">;
using Float32MultiArray = MultiArray<float, "std_msgs/msg/Float32MultiArray">;
using Float64MultiArray = MultiArray<double, "std_msgs/msg/Float64MultiArray">;

struct PointStamped {
  static constexpr std::string_view name = "geometry_msgs/msg/PointStamped";
  Header header{};
  Point point{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("point", m.point);
  }
};
struct Vector3Stamped {
  static constexpr std::string_view name = "geometry_msgs/msg/Vector3Stamped";
  Header header{};
  Vector3 vector{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("vector", m.vector);
  }
};
struct QuaternionStamped {
  static constexpr std::string_view name = "geometry_msgs/msg/QuaternionStamped";
  Header header{};
  Quaternion quaternion{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("quaternion", m.quaternion);
  }
};
struct PoseStamped {
  static constexpr std::string_view name = "geometry_msgs/msg/PoseStamped";
  Header header{};
  Pose pose{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("pose", m.pose);
  }
};

}  // namespace ros
