#include "recording/sample_text.h"

#include <cstdio>

#include "base/text.h"
#include "system/value_codec.h"

namespace recorder {

namespace {

// "RTC::TimedLong" -> "IDL:RTC/TimedLong:1.0".
std::string repository_id(const std::string& scoped) {
  std::string id = "IDL:";
  for (std::size_t i = 0; i < scoped.size(); ++i) {
    if (scoped.compare(i, 2, "::") == 0) {
      id += '/';
      ++i;
    } else {
      id += scoped[i];
    }
  }
  return id + ":1.0";
}

// False when there are more than `most`.
bool collect(const Json& value, const std::string& place, std::size_t most, std::vector<std::pair<std::string, Json>>& members) {
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      if (!collect(member, place_of(place, key), most, members)) return false;
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      if (!collect(value[i], place + "[" + std::to_string(i) + "]", most, members)) return false;
    }
  } else {
    if (members.size() >= most) return false;
    members.emplace_back(place, value);
  }
  return true;
}

// Before it is parsed, which takes memory for each value, and stack for each level when the value is used. At most what is said here.
base::Result<void> check_json(std::string_view text) {
  constexpr std::size_t deepest = 100, of_key = 3;
  std::size_t values = 1, depth = 0;
  bool is_in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_in_string) {
      i += c == '\\' ? 1 : 0;
      is_in_string = c != '"';
      continue;
    }
    is_in_string = c == '"';
    values += c == ':' ? of_key : c == ',' || c == '[' || c == '{' ? 1 : 0;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if ((c == '[' || c == '{') && ++depth > deepest)
      return base::Error{"a sample is nested deeper than " + std::to_string(deepest) + " levels"};
    if (values > max_values) return base::Error{"a sample has more than " + std::to_string(max_values) + " values"};
  }
  return {};
}

}  // namespace

base::Result<Json> SampleValues::ros_value(const mcap::Schema& schema, std::string_view octets) {
  auto known = definitions_.find(schema.id);
  if (known == definitions_.end()) known = definitions_.emplace(schema.id, RosDefinition::parse(schema.data)).first;
  return known->second ? known->second->decode(octets) : base::Result<Json>(known->second.error());
}

base::Result<Json> SampleValues::of(const mcap::Message& message) {
  const mcap::Channel& channel = reader_.channels().at(message.channel);
  const auto wrong = [&](const std::string& what) { return base::Error{"channel " + base::in_quotes(channel.topic) + ": " + what}; };
  if (channel.encoding == "json") {
    if (const auto good = check_json(message.data); !good) return wrong(good.error().message);
    Json value = Json::parse(message.data, nullptr, false);
    if (value.is_discarded()) return wrong("a sample is no JSON");
    return value;
  }
  const auto schema = reader_.schemas().find(channel.schema);
  const bool is_known = schema != reader_.schemas().end();
  const std::string name = is_known ? schema->second.name : "";
  const std::string encoding = is_known ? schema->second.encoding : "";
  if (channel.encoding == "cdr" && encoding == "ros2msg") {
    auto value = ros_value(schema->second, message.data);
    return value ? std::move(value) : wrong(value.error().message);
  }
  if (channel.encoding != "cdr" || encoding != "omgidl") {
    return wrong("samples of encoding " + base::in_quotes(channel.encoding) + " and schema " + base::in_quotes(name) + " cannot be shown");
  }
  const auto type = tools::type_code_of(repository_id(name));
  if (CORBA::is_nil(type)) return wrong("the data type " + base::in_quotes(name) + " is not known");
  if (message.data.size() < 4) return wrong("a sample has no bytes for its byte order");
  const auto* octets = reinterpret_cast<const unsigned char*>(message.data.data());
  auto value = tools::decode(type, {octets + 4, message.data.size() - 4}, octets[1] == 1, max_values);
  if (!value) return wrong(value.error().message);
  return std::move(*value);
}

std::vector<std::pair<std::string, Json>> members_of(const Json& value, std::size_t most) {
  std::vector<std::pair<std::string, Json>> members;
  (void)collect(value, "", most, members);
  return members;
}

std::string place_of(const std::string& outer, const std::string& key) { return outer.empty() ? key : outer + "." + key; }

// JSON takes these as they are, a terminal obeys them.
std::string json_text(const Json& value) {
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  for (std::string_view rest = text; !rest.empty();) {
    const auto character = base::first_character(rest);
    const std::size_t size = character ? character->size : 1;
    if (character && base::is_obeyed(character->code)) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(character->code));
      safe += code;
    } else {
      safe += rest.substr(0, size);
    }
    rest.remove_prefix(size);
  }
  return safe;
}

std::string seconds_text(mcap::Time time) {
  char text[40];
  std::snprintf(text, sizeof text, "%llu.%09llu", static_cast<unsigned long long>(time.count() / 1'000'000'000),
                static_cast<unsigned long long>(time.count() % 1'000'000'000));
  return text;
}

}  // namespace recorder
