// The services of a node's parameters (rcl_interfaces). Values.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ros/messages.h"

namespace ros {

struct ParameterValue {
  static constexpr std::string_view name = "rcl_interfaces/msg/ParameterValue";
  static constexpr std::uint8_t is_not_set = 0, is_bool = 1, is_integer = 2, is_double = 3, is_string = 4;
  std::uint8_t type = 0;
  bool bool_value = false;
  std::int64_t integer_value = 0;
  double double_value = 0;
  std::string string_value{};
  std::vector<Byte> byte_array_value{};
  std::vector<bool> bool_array_value{};
  std::vector<std::int64_t> integer_array_value{};
  std::vector<double> double_array_value{};
  std::vector<std::string> string_array_value{};
  static void fields(auto& m, auto& visit) {
    visit("type", m.type);
    visit("bool_value", m.bool_value);
    visit("integer_value", m.integer_value);
    visit("double_value", m.double_value);
    visit("string_value", m.string_value);
    visit("byte_array_value", m.byte_array_value);
    visit("bool_array_value", m.bool_array_value);
    visit("integer_array_value", m.integer_array_value);
    visit("double_array_value", m.double_array_value);
    visit("string_array_value", m.string_array_value);
  }
};
struct Parameter {
  static constexpr std::string_view name = "rcl_interfaces/msg/Parameter";
  std::string key{};
  ParameterValue value{};
  static void fields(auto& m, auto& visit) {
    visit("name", m.key);
    visit("value", m.value);
  }
};
struct FloatingPointRange {
  static constexpr std::string_view name = "rcl_interfaces/msg/FloatingPointRange";
  double from_value = 0;
  double to_value = 0;
  double step = 0;
  static void fields(auto& m, auto& visit) {
    visit("from_value", m.from_value);
    visit("to_value", m.to_value);
    visit("step", m.step);
  }
};
struct IntegerRange {
  static constexpr std::string_view name = "rcl_interfaces/msg/IntegerRange";
  std::int64_t from_value = 0;
  std::int64_t to_value = 0;
  std::uint64_t step = 0;
  static void fields(auto& m, auto& visit) {
    visit("from_value", m.from_value);
    visit("to_value", m.to_value);
    visit("step", m.step);
  }
};
struct ParameterDescriptor {
  static constexpr std::string_view name = "rcl_interfaces/msg/ParameterDescriptor";
  std::string key{};
  std::uint8_t type = 0;
  std::string description{};
  std::string additional_constraints{};
  bool read_only = false;
  bool dynamic_typing = false;
  Bounded<FloatingPointRange, 1> floating_point_range{};
  Bounded<IntegerRange, 1> integer_range{};
  static void fields(auto& m, auto& visit) {
    visit("name", m.key);
    visit("type", m.type);
    visit("description", m.description);
    visit("additional_constraints", m.additional_constraints);
    visit("read_only", m.read_only);
    visit("dynamic_typing", m.dynamic_typing);
    visit("floating_point_range", m.floating_point_range);
    visit("integer_range", m.integer_range);
  }
};
struct SetParametersResult {
  static constexpr std::string_view name = "rcl_interfaces/msg/SetParametersResult";
  bool successful = false;
  std::string reason{};
  static void fields(auto& m, auto& visit) {
    visit("successful", m.successful);
    visit("reason", m.reason);
  }
};
struct ListParametersResult {
  static constexpr std::string_view name = "rcl_interfaces/msg/ListParametersResult";
  std::vector<std::string> names{};
  std::vector<std::string> prefixes{};
  static void fields(auto& m, auto& visit) {
    visit("names", m.names);
    visit("prefixes", m.prefixes);
  }
};
struct ParameterEvent {
  static constexpr std::string_view name = "rcl_interfaces/msg/ParameterEvent";
  Time stamp{};
  std::string node{};
  std::vector<Parameter> new_parameters{};
  std::vector<Parameter> changed_parameters{};
  std::vector<Parameter> deleted_parameters{};
  static void fields(auto& m, auto& visit) {
    visit("stamp", m.stamp);
    visit("node", m.node);
    visit("new_parameters", m.new_parameters);
    visit("changed_parameters", m.changed_parameters);
    visit("deleted_parameters", m.deleted_parameters);
  }
};

struct ListParametersRequest {
  static constexpr std::string_view name = "rcl_interfaces/srv/ListParameters_Request";
  std::vector<std::string> prefixes{};
  std::uint64_t depth = 0;
  static void fields(auto& m, auto& visit) {
    visit("prefixes", m.prefixes);
    visit("depth", m.depth);
  }
};
struct ListParametersResponse {
  static constexpr std::string_view name = "rcl_interfaces/srv/ListParameters_Response";
  ListParametersResult result{};
  static void fields(auto& m, auto& visit) { visit("result", m.result); }
};
struct GetParametersRequest {
  static constexpr std::string_view name = "rcl_interfaces/srv/GetParameters_Request";
  std::vector<std::string> names{};
  static void fields(auto& m, auto& visit) { visit("names", m.names); }
};
struct GetParametersResponse {
  static constexpr std::string_view name = "rcl_interfaces/srv/GetParameters_Response";
  std::vector<ParameterValue> values{};
  static void fields(auto& m, auto& visit) { visit("values", m.values); }
};
struct GetParameterTypesRequest {
  static constexpr std::string_view name = "rcl_interfaces/srv/GetParameterTypes_Request";
  std::vector<std::string> names{};
  static void fields(auto& m, auto& visit) { visit("names", m.names); }
};
struct GetParameterTypesResponse {
  static constexpr std::string_view name = "rcl_interfaces/srv/GetParameterTypes_Response";
  std::vector<std::uint8_t> types{};
  static void fields(auto& m, auto& visit) { visit("types", m.types); }
};
struct DescribeParametersRequest {
  static constexpr std::string_view name = "rcl_interfaces/srv/DescribeParameters_Request";
  std::vector<std::string> names{};
  static void fields(auto& m, auto& visit) { visit("names", m.names); }
};
struct DescribeParametersResponse {
  static constexpr std::string_view name = "rcl_interfaces/srv/DescribeParameters_Response";
  std::vector<ParameterDescriptor> descriptors{};
  static void fields(auto& m, auto& visit) { visit("descriptors", m.descriptors); }
};
struct SetParametersRequest {
  static constexpr std::string_view name = "rcl_interfaces/srv/SetParameters_Request";
  std::vector<Parameter> parameters{};
  static void fields(auto& m, auto& visit) { visit("parameters", m.parameters); }
};
struct SetParametersResponse {
  static constexpr std::string_view name = "rcl_interfaces/srv/SetParameters_Response";
  std::vector<SetParametersResult> results{};
  static void fields(auto& m, auto& visit) { visit("results", m.results); }
};
struct SetParametersAtomicallyRequest {
  static constexpr std::string_view name = "rcl_interfaces/srv/SetParametersAtomically_Request";
  std::vector<Parameter> parameters{};
  static void fields(auto& m, auto& visit) { visit("parameters", m.parameters); }
};
struct SetParametersAtomicallyResponse {
  static constexpr std::string_view name = "rcl_interfaces/srv/SetParametersAtomically_Response";
  SetParametersResult result{};
  static void fields(auto& m, auto& visit) { visit("result", m.result); }
};

}  // namespace ros
