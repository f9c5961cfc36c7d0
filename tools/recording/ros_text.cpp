#include "recording/ros_text.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <utility>

#include "base/base64.h"
#include "base/text.h"

namespace recorder {

namespace {

using Json = nlohmann::ordered_json;
using Field = RosDefinition::Field;
using RosKind = RosDefinition::Kind;
using Message = RosDefinition::Message;

constexpr int deepest_message = 32;                  // messages in each other
constexpr std::size_t max_definitions = 10'000;      // in one text
constexpr std::size_t of_message = 2, of_field = 3;  // what a message and its name for a field cost beside the values

base::Error wrong(const std::string& what) { return base::Error{"ros2msg: " + what}; }

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::optional<RosKind> primitive(std::string_view name) {
  static const std::map<std::string_view, RosKind> kinds = {
      {"bool", RosKind::boolean},    {"byte", RosKind::uint8},   {"char", RosKind::uint8},    {"int8", RosKind::int8},
      {"uint8", RosKind::uint8},     {"int16", RosKind::int16},  {"uint16", RosKind::uint16}, {"int32", RosKind::int32},
      {"uint32", RosKind::uint32},   {"int64", RosKind::int64},  {"uint64", RosKind::uint64}, {"float32", RosKind::float32},
      {"float64", RosKind::float64}, {"string", RosKind::string}};
  const auto found = kinds.find(name);
  return found == kinds.end() ? std::nullopt : std::optional(found->second);
}

// "sensor_msgs/msg/Imu" and "sensor_msgs/Imu" are one.
std::string short_name(std::string_view name) {
  const auto middle = name.find("/msg/");
  if (middle == std::string_view::npos) return std::string(name);
  return std::string(name.substr(0, middle)) + std::string(name.substr(middle + 4));
}

struct Line {
  std::string type, name;
};

// Nothing for comments, constants and empty lines.
std::optional<Line> field_line(std::string_view line) {
  const auto comment = line.find('#');
  line = trimmed(line.substr(0, comment));
  const auto space = line.find_first_of(" \t");
  if (space == std::string_view::npos) return std::nullopt;
  const auto rest = trimmed(line.substr(space));
  const auto end = rest.find_first_of(" \t=");
  if (rest.substr(0, rest.find_first_of(" \t")).find('=') != std::string_view::npos) return std::nullopt;
  if (end != std::string_view::npos && trimmed(rest.substr(end)).starts_with("=")) return std::nullopt;
  return Line{std::string(line.substr(0, space)), std::string(rest.substr(0, end))};
}

// "float64[9]" is an array of float64.
base::Result<Field> shape_of(std::string& type, const std::string& name) {
  Field field;
  field.name = name;
  const auto bracket = type.find('[');
  if (bracket != std::string::npos) {
    const auto inside = type.substr(bracket + 1, type.find(']', bracket) - bracket - 1);
    const auto number = base::parse_integer(inside);
    field.shape = number ? Field::Shape::array : Field::Shape::sequence;
    if (number && (*number < 0 || *number > INT32_MAX)) return wrong("field " + base::in_quotes(name) + ": its size is no size");
    field.size = number ? static_cast<std::size_t>(*number) : 0;
    type.resize(bracket);
  }
  if (const auto bound = type.find("<="); bound != std::string::npos) type.resize(bound);
  return field;
}

class Cdr {
 public:
  Cdr(std::string_view octets, bool is_little) : octets_(octets), swaps_(is_little != (std::endian::native == std::endian::little)) {}

  template <class T>
  std::optional<T> number() {
    at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    if (at_ > octets_.size() || octets_.size() - at_ < sizeof(T)) return std::nullopt;
    char raw[sizeof(T)];
    for (std::size_t i = 0; i < sizeof(T); ++i) raw[swaps_ ? sizeof(T) - 1 - i : i] = octets_[at_ + i];
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, raw, sizeof value);
    return value;
  }
  std::optional<std::string_view> take(std::size_t size) {
    if (at_ > octets_.size() || octets_.size() - at_ < size) return std::nullopt;
    at_ += size;
    return octets_.substr(at_ - size, size);
  }
  std::size_t left() const { return at_ < octets_.size() ? octets_.size() - at_ : 0; }

 private:
  std::string_view octets_;
  bool swaps_;
  std::size_t at_ = 0;
};

class Decoder {
 public:
  Decoder(const std::vector<Message>& messages, Cdr cdr)
      : messages_(messages), cdr_(cdr), values_left_(std::min(16 * cdr.left() + 1000, max_values)) {}

  // Empty when the octets end too early.
  std::optional<Json> message(std::size_t place, int depth) {
    if (depth > deepest_message || !charge(of_message + of_field * messages_[place].fields.size())) return std::nullopt;
    Json json = Json::object();
    // A message without members has one octet.
    if (messages_[place].fields.empty() && !cdr_.number<std::uint8_t>()) return std::nullopt;
    for (const Field& field : messages_[place].fields) {
      auto value = this->field(field, depth);
      if (!value) return std::nullopt;
      json[field.name] = std::move(*value);
    }
    return json;
  }

 private:
  // False when it is too much.
  bool charge(std::size_t values) {
    if (values > values_left_) return false;
    values_left_ -= values;
    return true;
  }
  std::optional<Json> field(const Field& field, int depth) {
    if (field.shape == Field::Shape::one) return one(field, depth);
    std::size_t size = field.size;
    if (field.shape == Field::Shape::sequence) {
      const auto length = cdr_.number<std::uint32_t>();
      if (!length) return std::nullopt;
      size = *length;
    }
    if (size > cdr_.left()) return std::nullopt;  // each element has an octet at least
    if (field.kind == RosKind::uint8) {
      const auto octets = cdr_.take(size);
      return octets ? std::optional<Json>(base::to_base64(*octets)) : std::nullopt;
    }
    if (!charge(size)) return std::nullopt;
    Json json = Json::array();
    json.get_ref<Json::array_t&>().reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
      auto value = one(field, depth);
      if (!value) return std::nullopt;
      json.push_back(std::move(*value));
    }
    return json;
  }

  template <class T>
  std::optional<Json> number() {
    const auto value = cdr_.number<T>();
    return value ? std::optional<Json>(*value) : std::nullopt;
  }

  std::optional<Json> one(const Field& field, int depth) {
    switch (field.kind) {
      case RosKind::boolean: {
        const auto value = cdr_.number<std::uint8_t>();
        return value ? std::optional<Json>(*value != 0) : std::nullopt;
      }
      case RosKind::int8:
        return number<std::int8_t>();
      case RosKind::uint8:
        return number<std::uint8_t>();
      case RosKind::int16:
        return number<std::int16_t>();
      case RosKind::uint16:
        return number<std::uint16_t>();
      case RosKind::int32:
        return number<std::int32_t>();
      case RosKind::uint32:
        return number<std::uint32_t>();
      case RosKind::int64:
        return number<std::int64_t>();
      case RosKind::uint64:
        return number<std::uint64_t>();
      case RosKind::float32:
        return number<float>();
      case RosKind::float64:
        return number<double>();
      case RosKind::string: {
        const auto length = cdr_.number<std::uint32_t>();
        const auto text = length ? cdr_.take(*length) : std::nullopt;
        if (!text) return std::nullopt;
        return Json(std::string(text->substr(0, text->find('\0'))));
      }
      case RosKind::message:
        return message(field.message, depth + 1);
    }
    return std::nullopt;
  }

  const std::vector<Message>& messages_;
  Cdr cdr_;
  std::size_t values_left_;  // arrays of nothing need no octets, but time; an octet of a file becomes sixteen of memory and more
};

}  // namespace

base::Result<RosDefinition> RosDefinition::parse(std::string_view text) {
  RosDefinition all;
  std::vector<std::vector<std::string>> types(1);  // of the fields, as they are written
  std::map<std::string, std::size_t> places;
  all.messages_.push_back({});
  for (std::size_t begin = 0; begin <= text.size();) {
    const auto end = std::min(text.find('\n', begin), text.size());
    const auto line = trimmed(text.substr(begin, end - begin));
    begin = end + 1;
    if (line.starts_with("====")) continue;
    if (line.starts_with("MSG:")) {
      if (all.messages_.size() >= max_definitions) return wrong("more than " + std::to_string(max_definitions) + " definitions");
      const auto name = short_name(trimmed(line.substr(4)));
      places.emplace(name, all.messages_.size());
      all.messages_.push_back({name, {}});
      types.emplace_back();
      continue;
    }
    auto parsed = field_line(line);
    if (!parsed) continue;
    auto field = shape_of(parsed->type, parsed->name);
    if (!field) return field.error();
    all.messages_.back().fields.push_back(*field);
    types.back().push_back(parsed->type);
  }
  const auto find = [&](const std::string& package, const std::string& type) {
    auto found = places.find(short_name(type));
    if (found == places.end()) found = places.find(package + "/" + type);
    if (found == places.end() && type == "Header") found = places.find("std_msgs/Header");
    if (found != places.end() || type.find('/') != std::string::npos) return found;
    // The root does not say its package; the name alone is enough when there is one of it.
    for (auto one = places.begin(); one != places.end(); ++one) {
      if (one->first.ends_with("/" + type)) return one;
    }
    return found;
  };
  for (std::size_t m = 0; m < types.size(); ++m) {
    auto& message = all.messages_[m];
    const std::string package = message.name.substr(0, message.name.find('/'));
    for (std::size_t f = 0; f < types[m].size(); ++f) {
      if (const auto kind = primitive(types[m][f])) {
        message.fields[f].kind = *kind;
        continue;
      }
      const auto found = find(package, types[m][f]);
      if (found == places.end()) return wrong("type " + base::in_quotes(types[m][f]) + " is not defined");
      message.fields[f].message = found->second;
    }
  }
  return all;
}

base::Result<Json> RosDefinition::decode(std::string_view octets) const {
  if (octets.size() < 4) return wrong("a sample has no bytes for its byte order");
  auto value = Decoder(messages_, Cdr(octets.substr(4), octets[1] == 1)).message(0, 0);
  if (!value)
    return wrong("a sample ends too early, is deeper than " + std::to_string(deepest_message) + " messages, or has more than " +
                 std::to_string(max_values) + " values");
  return std::move(*value);
}

}  // namespace recorder
