// The type hash of ROS 2 ("RIHS01_" and 64 digits) of a message, from the fields that are encoded. Pure; any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "ros/cdr.h"
#include "ros/sha256.h"

namespace ros {

class TypeHash {
 public:
  template <Message T>
  static std::string of() {
    return of_text(text_of<T>());
  }
  static std::string of_text(const std::string& text) { return "RIHS01_" + sha256(text); }
  // What the hash is made of. Needs no library.
  template <Message T>
  static std::string text_of() {
    TypeHash hash;
    std::string own = hash.describe<T>();
    std::string referenced;
    for (const auto& [name, text] : hash.others_) {
      if (name != T::name) referenced += (referenced.empty() ? "" : ", ") + text;
    }
    return "{\"type_description\": " + own + ", \"referenced_type_descriptions\": [" + referenced + "]}";
  }

 private:
  struct Field {
    std::uint32_t type_id = 0;
    std::size_t capacity = 0, string_capacity = 0;
    std::string nested{};
  };

  // A visitor of fields().
  struct Fields {
    TypeHash& all;
    std::string text{};
    template <class T>
    void operator()(std::string_view name, const T&) {
      const Field field = all.field<T>();
      text += (text.empty() ? "" : ", ") + ("{\"name\": \"" + std::string(name)) +
              "\", \"type\": {\"type_id\": " + std::to_string(field.type_id) + ", \"capacity\": " + std::to_string(field.capacity) +
              ", \"string_capacity\": " + std::to_string(field.string_capacity) + ", \"nested_type_name\": \"" + field.nested + "\"}}";
    }
  };

  template <Message T>
  std::string describe() {
    Fields fields{*this};
    const T example{};
    T::fields(example, fields);
    return "{\"type_name\": \"" + std::string(T::name) + "\", \"fields\": [" + fields.text + "]}";
  }

  template <class T>
  struct Part {
    using type = void;
  };
  template <class T>
  struct Part<std::vector<T>> {
    using type = T;
    static constexpr std::uint32_t offset = 144;
    static constexpr std::size_t capacity = 0;
  };
  template <class T>
  struct Part<std::span<const T>> : Part<std::vector<T>> {};
  template <class T, std::size_t most>
  struct Part<Bounded<T, most>> {
    using type = T;
    static constexpr std::uint32_t offset = 96;
    static constexpr std::size_t capacity = most;
  };
  template <class T, std::size_t size>
  struct Part<std::array<T, size>> {
    using type = T;
    static constexpr std::uint32_t offset = 48;
    static constexpr std::size_t capacity = size;
  };

  template <class T>
  Field field() {
    if constexpr (!std::is_void_v<typename Part<T>::type>) {
      Field part = field<typename Part<T>::type>();
      part.type_id += Part<T>::offset;
      part.capacity = Part<T>::capacity;
      return part;
    } else if constexpr (Message<T>) {
      if (!others_.contains(T::name)) {
        others_[T::name];  // one that contains itself would have no end
        others_[T::name] = describe<T>();
      }
      return {1, 0, 0, std::string(T::name)};
    } else if constexpr (std::is_same_v<T, std::string>) {
      return {17};
    } else if constexpr (is_bounded_text<T>) {
      return {21, 0, T::most};
    } else {
      return {number_id<T>()};
    }
  }

  template <Number T>
  static constexpr std::uint32_t number_id() {
    if constexpr (std::is_same_v<T, Byte>) return 16;
    if constexpr (std::is_same_v<T, bool>) return 15;
    if constexpr (std::is_same_v<T, float>) return 10;
    if constexpr (std::is_same_v<T, double>) return 11;
    if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
      constexpr std::uint32_t width = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 1 : sizeof(T) == 4 ? 2 : 3;
      return 2 + 2 * width + (std::is_signed_v<T> ? 0 : 1);
    }
    return 0;
  }

  std::map<std::string_view, std::string> others_;  // by name, which is the order that the hash wants
};

}  // namespace ros
