// Names, units and offsets of the fields in the table of iface types (iface_types.h). Constants; no thread rule.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

#include "shm/layout.h"

namespace shm {

// A value in an info, a sample or an element of what follows them.
struct Field {
  enum class Kind {
    u32,
    u64,
    f64,
    f32,
    text,         // char[count], terminated
    pose,         // Pose
    stamp,        // Stamp
    flag,         // u32, 0 or 1
    nanoseconds,  // i64, told in seconds
    followers,    // the array number `count` of what follows, not a member
  };
  std::string_view name;
  Kind kind = Kind::f64;
  std::size_t count = 1;                           // values; characters of a text
  const void* (*in)(const void* whole) = nullptr;  // where it is
  std::string_view unit;                           // empty: a number, or as its structure says
};

namespace detail {

template <class Whole, class Part>
constexpr std::size_t values_of(Part Whole::*) {
  return std::is_array_v<Part> ? std::extent_v<Part> : 1;
}

template <class Whole, class Part>
constexpr Field::Kind kind_of(Part Whole::*) {
  using Value = std::remove_all_extents_t<Part>;
  if constexpr (std::is_same_v<Value, char>) return Field::Kind::text;
  if constexpr (std::is_same_v<Value, double>) return Field::Kind::f64;
  if constexpr (std::is_same_v<Value, std::uint32_t>) return Field::Kind::u32;
  if constexpr (std::is_same_v<Value, std::uint64_t>) return Field::Kind::u64;
  if constexpr (std::is_same_v<Value, Pose>) return Field::Kind::pose;
  if constexpr (std::is_same_v<Value, Stamp>) return Field::Kind::stamp;
  if constexpr (std::is_same_v<Value, std::int64_t>) return Field::Kind::nanoseconds;
}

template <auto member, class Whole, class Part>
const void* part_of(const void* whole, Part Whole::*) {
  return &(static_cast<const Whole*>(whole)->*member);
}

}  // namespace detail

template <auto member>
constexpr Field field(std::string_view name, std::string_view unit = "") {
  return {name, detail::kind_of(member), detail::values_of(member),
          [](const void* whole) { return detail::part_of<member>(whole, member); }, unit};
}
template <auto member>
constexpr Field flag(std::string_view name) {
  Field result = field<member>(name);
  result.kind = Field::Kind::flag;
  return result;
}
constexpr Field followers(std::string_view name, std::size_t array, std::string_view unit = "") {
  return {name, Field::Kind::followers, array, nullptr, unit};
}

// What follows an info or a sample: `arrays` arrays of as many elements as the row's count says.
struct Tail {
  std::size_t arrays = 0;
  std::size_t size = 0;           // of an element
  std::span<const Field> fields;  // of an element
};

namespace detail {

template <auto member>
constexpr auto part() {
  return [](const void* whole) { return part_of<member>(whole, member); };
}

inline constexpr std::array value_fields{Field{"", Field::Kind::f32, 1, [](const void* whole) { return whole; }, ""}};
inline constexpr std::array pose_fields{Field{"", Field::Kind::pose, 1, [](const void* whole) { return whole; }, ""}};

}  // namespace detail
}  // namespace shm
