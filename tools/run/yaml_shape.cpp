#include "run/yaml_shape.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cassert>
#include <set>

#include "base/text.h"

namespace tools {
namespace {

std::string names_of(const Shape& shape) {
  std::vector<std::string> names;
  for (const Key& key : shape.keys) names.emplace_back(key.name);
  return base::join(names, ", ");
}

double number_at(const YAML::Node& node, const std::string& what) {
  const auto value = node.IsScalar() ? base::parse_number(node.Scalar()) : std::nullopt;
  if (!value) fail_at(node, what + " must be a finite number" + (node.IsScalar() ? ", got " + base::in_quotes(node.Scalar()) : ""));
  return *value;
}

void check_numbers(const YAML::Node& node, const std::string& what, std::size_t count, const char* form) {
  if (!node.IsSequence() || node.size() != count) fail_at(node, what + " must be " + form);
  for (const auto& one : node) number_at(one, what);
}

void check_scalars(const YAML::Node& node, const std::string& what, bool may_be_one) {
  if (may_be_one && node.IsScalar() && !node.Scalar().empty()) return;
  if (!node.IsSequence() || node.size() == 0)
    fail_at(node, what + (may_be_one ? " must be a word or a list of words" : " must be a list of values"));
  for (const auto& one : node) {
    if (!one.IsScalar() || one.Scalar().empty()) fail_at(one, what + " must hold plain values");
  }
}

void check_scalar(const YAML::Node& node, const Key& key) {
  const std::string what(key.name);
  if (!node.IsScalar() || node.Scalar().empty()) fail_at(node, what + " must be a plain value");
  const auto& text = node.Scalar();
  const auto fail = [&](const std::string& expected) { fail_at(node, what + " must be " + expected + ", got " + base::in_quotes(text)); };
  switch (key.form) {
    case Form::number:
      number_at(node, what);
      break;
    case Form::positive:
      if (number_at(node, what) <= 0) fail("more than 0");
      break;
    case Form::fraction:
      if (const double value = number_at(node, what); value < 0 || value > 1) fail("from 0 to 1");
      break;
    case Form::count:
      if (const auto value = base::parse_integer(text); !value || *value < 0) fail("a whole number, 0 or more");
      break;
    case Form::flag:
      if (text != "true" && text != "false") fail("true or false");
      break;
    case Form::words: {
      const auto words = base::split_list(key.of, ' ');
      if (std::ranges::find(words, text) == words.end()) fail(base::join(words, ", "));
      break;
    }
    default:
      break;
  }
}

void check_list(Shapes shapes, const YAML::Node& node, const Key& key) {
  if (!node.IsSequence()) fail_at(node, std::string(key.name) + " must be a list");
  for (const auto& entry : node) {
    if (key.form == Form::list && (!entry.IsMap() || entry.size() != 1))
      fail_at(entry, "each entry of " + std::string(key.name) + " must be one NAME: {...}");
    check_shape(shapes, entry, key.of, std::string(key.name));
  }
}

void check_named(Shapes shapes, const YAML::Node& node, const Key& key) {
  if (!node.IsMap()) fail_at(node, std::string(key.name) + " must be a map");
  std::set<std::string> seen;
  for (const auto& entry : node) {
    if (!seen.insert(entry.first.Scalar()).second) fail_at(entry.first, std::string(key.name) + " has " + entry.first.Scalar() + " twice");
    if (entry.second.IsSequence()) {
      check_scalars(entry.second, entry.first.Scalar(), false);
    } else if (entry.second.IsMap()) {
      check_shape(shapes, entry.second, key.of, entry.first.Scalar());
    } else {
      fail_at(entry.second, entry.first.Scalar() + " must be a list of values, or a map with " + names_of(shape(shapes, key.of)));
    }
  }
}

}  // namespace

const Shape& shape(Shapes shapes, std::string_view name) {
  const auto found = std::ranges::find_if(shapes, [&](const Shape& one) { return one.name == name; });
  assert(found != shapes.end());
  return *found;
}

void fail_at(const YAML::Node& node, const std::string& message) {
  throw YamlFailure{message, node.Mark().line + 1, node.Mark().column + 1};
}

void check_form(Shapes shapes, const YAML::Node& node, const Key& key) {
  const std::string what(key.name);
  switch (key.form) {
    case Form::any:
      return;
    case Form::pair:
      return check_numbers(node, what, 2, "[NUMBER, NUMBER]");
    case Form::region:
      return check_numbers(node, what, 4, "[x1, y1, x2, y2]");
    case Form::values:
      return check_scalars(node, what, false);
    case Form::texts:
      return check_scalars(node, what, true);
    case Form::map:
    case Form::one:
      return check_shape(shapes, node, key.of, what);
    case Form::list:
    case Form::maps:
      return check_list(shapes, node, key);
    case Form::named:
      return check_named(shapes, node, key);
    default:
      return check_scalar(node, key);
  }
}

void check_shape(Shapes shapes, const YAML::Node& node, std::string_view name, const std::string& what) {
  const Shape& wanted = shape(shapes, name);
  if (!node.IsMap()) {
    if (node.IsNull() && std::ranges::none_of(wanted.keys, [](const Key& key) { return key.is_needed; })) return;
    fail_at(node, what + " must be a map with " + names_of(wanted));
  }
  std::set<std::string> seen;
  for (const auto& entry : node) {
    if (!entry.first.IsScalar()) fail_at(entry.first, what + ": keys must be words");
    const auto& given = entry.first.Scalar();
    const auto key = std::ranges::find_if(wanted.keys, [&](const Key& one) { return one.name == given; });
    if (key == wanted.keys.end()) fail_at(entry.first, what + " has no key " + base::in_quotes(given) + "; it has " + names_of(wanted));
    if (!seen.insert(given).second) fail_at(entry.first, what + " has " + given + " twice");
    check_form(shapes, entry.second, *key);
  }
  for (const Key& key : wanted.keys) {
    if (key.is_needed && !seen.contains(std::string(key.name))) fail_at(node, what + " needs " + std::string(key.name));
  }
}

std::string word(const YAML::Node& node, const char* key, const std::string& usual) { return node[key] ? node[key].Scalar() : usual; }

std::optional<double> number(const YAML::Node& node, const char* key) {
  return node[key] ? base::parse_number(node[key].Scalar()) : std::nullopt;
}

std::vector<std::string> words(const YAML::Node& node) {
  std::vector<std::string> all;
  if (!node) return all;
  if (node.IsScalar()) return {node.Scalar()};
  for (const auto& one : node) all.push_back(one.Scalar());
  return all;
}

Region to_region(const YAML::Node& node) {
  if (!node) return {};
  double corners[4] = {};
  for (std::size_t i = 0; i < 4; ++i) corners[i] = *base::parse_number(node[i].Scalar());
  const auto [x1, x2] = std::minmax(corners[0], corners[2]);
  const auto [y1, y2] = std::minmax(corners[1], corners[3]);
  return {x1, y1, x2, y2};
}

}  // namespace tools
