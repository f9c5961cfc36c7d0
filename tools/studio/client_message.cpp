#include "studio/client_message.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

constexpr std::size_t max_depth = 24;
constexpr std::size_t max_name = 64;
constexpr std::size_t max_pairs = 1024;

Result<std::uint32_t> id_of(const Json& json, const char* what) {
  if (!json.is_number_integer() || json < 0 || json > std::numeric_limits<std::uint32_t>::max())
    return Error{std::string(what) + ": expected a whole number from 0 to 4294967295"};
  return json.get<std::uint32_t>();
}

const Json& member(const Json& object, const std::string& key) {
  static const Json nothing;
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found == object.end() ? nothing : *found;
}

Result<ClientMessage> request_of(const Json& json) {
  Request request;
  const Json& id = member(json, "id");
  if (!id.is_number_integer()) return Error{"request: expected a whole number as id"};
  request.id = id.get<std::int64_t>();
  const Json& name = member(json, "name");
  if (!name.is_string() || name.get_ref<const std::string&>().size() > max_name) return Error{"request: expected a name"};
  request.name = name.get<std::string>();
  request.args = member(json, "args");
  if (request.args.is_null()) request.args = Json::object();
  if (!request.args.is_object()) return Error{"request " + base::in_quotes(request.name) + ": expected an object as args"};
  request.is_dry = flag_of(json, "dry");
  return ClientMessage(std::move(request));
}

Error expected(const std::string& key, const std::string& what) { return {key + ": expected " + what}; }

}  // namespace

bool is_flat_enough(std::string_view text) {
  std::size_t depth = 0;
  bool is_in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_in_text) {
      if (c == '\\') ++i;
      if (c == '"') is_in_text = false;
      continue;
    }
    if (c == '"') is_in_text = true;
    if ((c == '{' || c == '[') && ++depth > max_depth) return false;
    if ((c == '}' || c == ']') && depth > 0) --depth;
  }
  return true;
}

Result<ClientMessage> parse_message(std::string_view text) {
  if (text.size() > max_message) return Error{"message: is longer than 1 MiB"};
  if (!is_flat_enough(text)) return Error{"message: its brackets are more than 24 deep"};
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return Error{"message: expected a JSON object"};
  const Json& op = member(json, "op");
  if (!op.is_string()) return Error{"message: expected a text as op"};
  const auto& name = op.get_ref<const std::string&>();
  if (name == "request") return request_of(json);
  auto foxglove = parse_foxglove(name, json);
  if (!foxglove) return foxglove.error();
  if (*foxglove) return std::visit([](auto& message) { return ClientMessage(std::move(message)); }, **foxglove);
  return ClientMessage(Unused{name.substr(0, max_name)});
}

std::string to_text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

const Json& list_in(const Json& object, const char* key) {
  static const Json nothing = Json::array();
  const Json& list = member(object, key);
  return list.is_array() ? list : nothing;
}

std::string values_key(std::uint32_t watch) { return "values." + std::to_string(watch); }

std::string reply_text(std::int64_t id, const Result<Json>& result, const std::string& command) {
  Json reply{{"op", "reply"}, {"id", id}};
  if (result) {
    reply["result"] = *result;
  } else {
    reply["error"] = result.error().message;
  }
  if (!command.empty()) reply["command"] = command;
  return to_text(reply);
}

Result<std::string> text_of(const Json& args, const std::string& key) {
  const Json& value = member(args, key);
  if (!value.is_string()) return expected(key, "a text");
  auto text = value.get<std::string>();
  if (text.find('\0') != std::string::npos) return expected(key, "a text without the octet 0");
  return text;
}

std::string text_or(const Json& args, const std::string& key, const std::string& otherwise) {
  auto text = text_of(args, key);
  return text ? std::move(*text) : otherwise;
}

Result<double> number_of(const Json& args, const std::string& key) {
  const Json& value = member(args, key);
  if (!value.is_number() || !std::isfinite(value.get<double>())) return expected(key, "a number");
  return value.get<double>();
}

Result<std::uint32_t> whole_number_of(const Json& args, const std::string& key) { return id_of(member(args, key), key.c_str()); }

Result<std::vector<std::uint32_t>> whole_numbers_of(const Json& args, const std::string& key) {
  const Json& list = member(args, key);
  if (!list.is_array() || list.size() > max_subscriptions) return expected(key, "a list of at most 1024 whole numbers");
  std::vector<std::uint32_t> numbers;
  for (const Json& entry : list) {
    const auto number = id_of(entry, key.c_str());
    if (!number) return number.error();
    numbers.push_back(*number);
  }
  return numbers;
}

double number_or(const Json& args, const std::string& key, double otherwise) {
  const auto number = number_of(args, key);
  return number ? *number : otherwise;
}

bool flag_of(const Json& args, const std::string& key) {
  const Json& value = member(args, key);
  return value.is_boolean() && value.get<bool>();
}

Result<std::vector<double>> numbers_of(const Json& args, const std::string& key, std::size_t min, std::size_t max) {
  const Json& list = member(args, key);
  const auto what = std::to_string(min) + (max > min ? " to " + std::to_string(max) : "") + " numbers";
  if (!list.is_array() || list.size() < min || list.size() > max) return expected(key, what);
  std::vector<double> numbers;
  for (const Json& value : list) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) return expected(key, what);
    numbers.push_back(value.get<double>());
  }
  return numbers;
}

Result<std::vector<std::string>> texts_of(const Json& args, const std::string& key, std::size_t min, std::size_t max) {
  const Json& list = member(args, key);
  const auto what = std::to_string(min) + " to " + std::to_string(max) + " texts";
  if (!list.is_array() || list.size() < min || list.size() > max) return expected(key, what);
  std::vector<std::string> texts;
  for (const Json& value : list) {
    if (!value.is_string() || value.get_ref<const std::string&>().find('\0') != std::string::npos) return expected(key, what);
    texts.push_back(value.get<std::string>());
  }
  return texts;
}

Result<std::vector<std::pair<std::string, std::string>>> values_of(const Json& args, const std::string& key) {
  std::vector<std::pair<std::string, std::string>> values;
  const Json& object = member(args, key);
  if (object.is_null()) return values;
  if (!object.is_object() || object.size() > max_pairs) return expected(key, "an object of texts");
  for (const auto& [name, value] : object.items()) {
    if (!value.is_string()) return expected(key + "." + name.substr(0, max_name), "a text");
    const auto& text = value.get_ref<const std::string&>();
    if (name.empty() || name.find('\0') != std::string::npos || text.find('\0') != std::string::npos)
      return expected(key, "an object of texts without the octet 0");
    values.emplace_back(name, text);
  }
  return values;
}

}  // namespace studio
