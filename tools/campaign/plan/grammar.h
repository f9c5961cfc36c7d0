// The grammar of plans as a table: each kind of map with its keys, and the form of their values. The reader checks files against it, and
// the published JSON Schema is generated from it. Values; any thread.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

namespace YAML {
class Node;
}

namespace campaign {

// What is wrong in a file, and where. Lines and columns from 1; 0: the file as a whole.
struct PlanError {
  std::string message;
  int line = 0, column = 0;
};

enum class Form {
  text,      // any scalar, not empty
  number,    // finite
  positive,  // more than 0
  count,     // a whole number, 0 or more
  fraction,  // from 0 to 1
  flag,      // true or false
  pair,      // two numbers
  region,    // four numbers: x1 y1 x2 y2
  values,    // a list of scalars
  texts,     // a scalar or a list of them
  words,     // exactly one of the words in `of`, separated by blanks
  any,       // judged where it is used
  map,       // keys of the shape `of`
  one,       // a map with exactly one key, of the shape `of`
  list,      // a list of `one`s of the shape `of`
  maps,      // a list of `map`s of the shape `of`
  named,     // a map from any name to a value of the shape `of`: see vary
};

struct Key {
  std::string_view name;
  Form form = Form::text;
  std::string_view of{};  // a shape, or words
  bool is_needed = false;
  std::string_view meaning{};
};

struct Shape {
  std::string_view name;
  std::span<const Key> keys;
};

inline constexpr std::string_view plan_shape = "plan";

const Shape& shape(std::string_view name);
// Throws PlanError.
void check_shape(const YAML::Node& node, std::string_view shape, const std::string& what);
void check_form(const YAML::Node& node, const Key& key);
// The scalar of this key of a map; `usual` without one.
std::string word(const YAML::Node& node, const char* key, const std::string& usual = "");
[[noreturn]] void fail_at(const YAML::Node& node, const std::string& message);

// Draft 2020-12.
nlohmann::ordered_json plan_schema();

}  // namespace campaign
