// Messages of ROS 2 as bytes, and their definitions as text, both from one description: a message is a structure with its name, and
// fields() names its members in order. Little-endian CDR after a header of four bytes. Pure; any thread.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace ros {

static_assert(std::endian::native == std::endian::little, "the writer copies numbers as they lie in memory");

// The four bytes before a message: plain CDR, little-endian, no options.
inline constexpr std::array<char, 4> little_endian_head{0, 1, 0, 0};

// A type of its own in definitions, an octet on the wire.
enum class Byte : std::uint8_t {};

// A sequence of at most `most` elements, and a text of at most as many bytes: on the wire like those without a limit.
template <class T, std::size_t max_elements>
struct Bounded : std::vector<T> {
  using std::vector<T>::vector;
};
template <std::size_t max_bytes>
struct BoundedText : std::string {
  static constexpr std::size_t most = max_bytes;
  using std::string::string;
  explicit BoundedText(std::string text) : std::string(std::move(text)) {}
};
template <class T>
inline constexpr bool is_bounded_text = false;
template <std::size_t most>
inline constexpr bool is_bounded_text<BoundedText<most>> = true;

template <class T>
concept Message = requires {
  T::name;
};
template <class T>
concept Number = std::is_arithmetic_v<T> || std::is_same_v<T, Byte>;

// How many octets come.
class Measure {
 public:
  std::size_t size() const { return size_; }
  void fill(std::size_t count) { size_ += count; }
  void append(const void*, std::size_t count) { size_ += count; }

 private:
  std::size_t size_ = 0;
};

// The octets themselves, into room that is large enough.
class Octets {
 public:
  explicit Octets(std::span<char> room) : begin_(room.data()), end_(room.data()) {}
  std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
  void fill(std::size_t count) {
    std::memset(end_, 0, count);
    end_ += count;
  }
  void append(const void* from, std::size_t count) {
    std::memcpy(end_, from, count);
    end_ += count;
  }

 private:
  char* begin_;
  char* end_;
};

// A visitor of fields().
template <class Out>
class Encoder {
 public:
  explicit Encoder(Out out) : out_(std::move(out)) { out_.append(little_endian_head.data(), little_endian_head.size()); }

  template <class T>
  void operator()(std::string_view, const T& value) {
    put(value);
  }
  Out& out() { return out_; }

 private:
  template <Number T>
  void put(const T& value) {
    align(sizeof value);
    out_.append(&value, sizeof value);
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    out_.append(text.c_str(), text.size() + 1);
  }
  template <Message T>
  void put(const T& message) {
    T::fields(message, *this);
  }
  template <class T>
  void put(const std::vector<T>& values) {
    if constexpr (std::is_same_v<T, bool>) {
      put(static_cast<std::uint32_t>(values.size()));
      for (const bool value : values) put(value);
    } else {
      put(std::span<const T>(values));
    }
  }
  template <class T>
  void put(std::span<const T> values) {
    put(static_cast<std::uint32_t>(values.size()));
    put_all(values);
  }
  template <class T, std::size_t size>
  void put(const std::array<T, size>& values) {
    put_all(std::span<const T>(values));
  }
  template <class T>
  void put_all(std::span<const T> values) {
    if constexpr (Number<T> && !std::is_same_v<T, bool>) {
      if (values.empty()) return;
      align(sizeof(T));
      out_.append(values.data(), values.size_bytes());
    } else {
      for (const T& value : values) put(value);
    }
  }
  // Counted from behind the head.
  void align(std::size_t size) {
    if (const auto rest = (out_.size() - head_size) & (size - 1); rest != 0) out_.fill(size - rest);  // sizes are powers of two
  }

  static constexpr std::size_t head_size = little_endian_head.size();
  Out out_;
};

// The definition of a message and those that it needs, each once, its own first.
class Definitions {
 public:
  template <Message T>
  static std::string of() {
    Definitions definitions;
    definitions.add<T>();
    std::string text = definitions.texts_.front().second;
    for (std::size_t i = 1; i < definitions.texts_.size(); ++i) {
      const auto& [name, own] = definitions.texts_[i];
      text.append(80, '=').append("\nMSG: ").append(name).append("\n").append(own);
    }
    return text;
  }

 private:
  // A visitor of fields().
  struct Fields {
    Definitions& all;
    std::size_t place;
    template <class T>
    void operator()(std::string_view name, const T&) {
      all.texts_[place].second += all.spell<T>() + " " + std::string(name) + "\n";
    }
  };

  template <Message T>
  std::string add() {
    // "sensor_msgs/msg/Imu" is "sensor_msgs/Imu" in definitions.
    const auto slash = T::name.find("/msg/");
    const std::string name = std::string(T::name.substr(0, slash)) + std::string(T::name.substr(slash + 4));
    if (std::ranges::find(texts_, name, &std::pair<std::string, std::string>::first) == texts_.end()) {
      texts_.emplace_back(name, "");
      if constexpr (requires { T::constants; }) texts_.back().second = T::constants;
      const T example{};
      Fields fields{*this, texts_.size() - 1};
      T::fields(example, fields);
    }
    return name;
  }

  template <class T>
  struct Part {  // of a sequence or an array
    using type = void;
  };
  template <class T>
  struct Part<std::vector<T>> {
    using type = T;
    static std::string brackets() { return "[]"; }
  };
  template <class T>
  struct Part<std::span<const T>> : Part<std::vector<T>> {};
  template <class T, std::size_t most>
  struct Part<Bounded<T, most>> {
    using type = T;
    static std::string brackets() { return "[<=" + std::to_string(most) + "]"; }
  };
  template <class T, std::size_t size>
  struct Part<std::array<T, size>> {
    using type = T;
    static std::string brackets() { return "[" + std::to_string(size) + "]"; }
  };

  template <class T>
  std::string spell() {
    if constexpr (!std::is_void_v<typename Part<T>::type>) {
      return spell<typename Part<T>::type>() + Part<T>::brackets();
    } else if constexpr (Message<T>) {
      return add<T>();
    } else if constexpr (std::is_same_v<T, std::string>) {
      return "string";
    } else if constexpr (is_bounded_text<T>) {
      return "string<=" + std::to_string(T::most);
    } else if constexpr (std::is_same_v<T, bool>) {
      return "bool";
    } else if constexpr (std::is_same_v<T, Byte>) {
      return "byte";
    } else if constexpr (std::is_floating_point_v<T>) {
      return "float" + std::to_string(8 * sizeof(T));
    } else {
      return (std::is_signed_v<T> ? "int" : "uint") + std::to_string(8 * sizeof(T));
    }
  }

  std::vector<std::pair<std::string, std::string>> texts_;  // by name
};

template <Message T>
std::size_t encoded_size(const T& message) {
  Encoder measured{Measure()};
  T::fields(message, measured);
  return measured.out().size();
}

// Into room of that size.
template <Message T>
void encode(const T& message, std::span<char> room) {
  Encoder encoder{Octets(room)};
  T::fields(message, encoder);
}

template <Message T>
std::vector<char> encode(const T& message) {
  std::vector<char> octets(encoded_size(message));
  encode(message, octets);
  return octets;
}

}  // namespace ros
