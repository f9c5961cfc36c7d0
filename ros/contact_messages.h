// Contacts and heights as ros_gz_interfaces has them. Units: m, N, N m. Values.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ros/plain_messages.h"

namespace ros {

struct Entity {
  static constexpr std::string_view name = "ros_gz_interfaces/msg/Entity";
  static constexpr std::uint8_t collision = 5;
  std::uint64_t id = 0;
  std::string label{};
  std::uint8_t type = 0;
  static void fields(auto& m, auto& visit) {
    visit("id", m.id);
    visit("name", m.label);
    visit("type", m.type);
  }
};
struct JointWrench {
  static constexpr std::string_view name = "ros_gz_interfaces/msg/JointWrench";
  Header header{};
  Text body_1_name{};
  UInt32 body_1_id{};
  Text body_2_name{};
  UInt32 body_2_id{};
  Wrench body_1_wrench{};
  Wrench body_2_wrench{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("body_1_name", m.body_1_name);
    visit("body_1_id", m.body_1_id);
    visit("body_2_name", m.body_2_name);
    visit("body_2_id", m.body_2_id);
    visit("body_1_wrench", m.body_1_wrench);
    visit("body_2_wrench", m.body_2_wrench);
  }
};
struct Contact {
  static constexpr std::string_view name = "ros_gz_interfaces/msg/Contact";
  Entity collision1{};
  Entity collision2{};
  std::vector<Vector3> positions{};
  std::vector<Vector3> normals{};
  std::vector<double> depths{};
  std::vector<JointWrench> wrenches{};
  static void fields(auto& m, auto& visit) {
    visit("collision1", m.collision1);
    visit("collision2", m.collision2);
    visit("positions", m.positions);
    visit("normals", m.normals);
    visit("depths", m.depths);
    visit("wrenches", m.wrenches);
  }
};
struct Contacts {
  static constexpr std::string_view name = "ros_gz_interfaces/msg/Contacts";
  Header header{};
  std::vector<Contact> contacts{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("contacts", m.contacts);
  }
};
struct Altimeter {
  static constexpr std::string_view name = "ros_gz_interfaces/msg/Altimeter";
  Header header{};
  double vertical_position = 0;
  double vertical_velocity = 0;
  double vertical_reference = 0;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("vertical_position", m.vertical_position);
    visit("vertical_velocity", m.vertical_velocity);
    visit("vertical_reference", m.vertical_reference);
  }
};

}  // namespace ros
