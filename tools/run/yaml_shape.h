// The shapes of maps in YAML files as tables: their keys, and the form of each value; a check of nodes against them, and readers of nodes
// that fit. Values; any thread.
//
// Each function throws YamlFailure at the node that is wrong: what it must be, and what it is.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace YAML {
class Node;
}

namespace tools {

// What is wrong in a file, and where. Lines and columns from 1; 0: the file as a whole.
struct YamlFailure {
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

using Shapes = std::span<const Shape>;

const Shape& shape(Shapes shapes, std::string_view name);
// `shapes`: all that a key can name.
void check_shape(Shapes shapes, const YAML::Node& node, std::string_view shape, const std::string& what);
void check_form(Shapes shapes, const YAML::Node& node, const Key& key);
[[noreturn]] void fail_at(const YAML::Node& node, const std::string& message);

// Of a key of a map that fits its shape. The scalar; `usual` without one.
std::string word(const YAML::Node& node, const char* key, const std::string& usual = "");
std::optional<double> number(const YAML::Node& node, const char* key);
// A scalar, or a list of them.
std::vector<std::string> words(const YAML::Node& node);

struct Region {
  double x1 = 0, y1 = 0, x2 = 0, y2 = 0;  // [m], x1 <= x2, y1 <= y2
};
// The corners may be in any order; without a node: all 0.
Region to_region(const YAML::Node& node);

}  // namespace tools
