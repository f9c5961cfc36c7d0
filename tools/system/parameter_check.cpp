#include "system/parameter_check.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "base/text.h"

namespace tools {
namespace {

std::string without_blanks(std::string text) {
  std::erase_if(text, [](unsigned char c) { return std::isspace(c); });
  return text;
}

struct Range {
  double low, high;
};

template <class Integer>
Range range_of() {
  return {static_cast<double>(std::numeric_limits<Integer>::min()), static_cast<double>(std::numeric_limits<Integer>::max())};
}

std::optional<Range> integer_range(std::string type) {
  if (type.starts_with("std::")) type.erase(0, 5);
  if (type.ends_with("int")) {
    if (const auto shorter = type.substr(0, type.size() - 3); shorter == "short" || shorter == "long" || shorter == "longlong" ||
                                                              shorter == "unsignedshort" || shorter == "unsignedlong" ||
                                                              shorter == "unsignedlonglong")
      type = shorter;
  }
  static const std::map<std::string, Range> ranges = {{"short", range_of<std::int16_t>()},
                                                      {"int16_t", range_of<std::int16_t>()},
                                                      {"unsignedshort", range_of<std::uint16_t>()},
                                                      {"uint16_t", range_of<std::uint16_t>()},
                                                      {"int", range_of<std::int32_t>()},
                                                      {"int32_t", range_of<std::int32_t>()},
                                                      {"unsignedint", range_of<std::uint32_t>()},
                                                      {"unsigned", range_of<std::uint32_t>()},
                                                      {"uint32_t", range_of<std::uint32_t>()},
                                                      {"long", range_of<std::int64_t>()},
                                                      {"int64_t", range_of<std::int64_t>()},
                                                      {"longlong", range_of<std::int64_t>()},
                                                      {"unsignedlong", range_of<std::uint64_t>()},
                                                      {"uint64_t", range_of<std::uint64_t>()},
                                                      {"unsignedlonglong", range_of<std::uint64_t>()}};
  const auto found = ranges.find(type);
  return found == ranges.end() ? std::nullopt : std::optional(found->second);
}

std::string scalar_problem(const std::string& type, const std::string& value) {
  if (const auto range = integer_range(type)) {
    const auto number = base::parse_integer(value);
    const bool is_good = number && static_cast<double>(*number) >= range->low && static_cast<double>(*number) <= range->high;
    return is_good ? "" : "a whole number from " + base::format_number(range->low) + " to " + base::format_number(range->high);
  }
  if (type == "double" || type == "float") {
    const auto number = base::parse_number(value);
    if (number && (type == "double" || std::abs(*number) <= std::numeric_limits<float>::max())) return "";
    return "a number";
  }
  if (type == "bool") return base::parse_bool(value) ? "" : "yes or no, true or false, 1 or 0";
  return "";
}

// The limits on one number, "0<=x<10", "x!=3".
struct Limit {
  std::string relation;  // value RELATION bound
  double bound;
};

const std::vector<std::string> relations = {"<=", ">=", "==", "!=", "<", ">", "="};

// Splits "0<=x<10" into "0", "<=", "x", "<", "10".
std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < text.size();) {
    const auto relation = std::ranges::find_if(relations, [&](const std::string& r) { return text.compare(i, r.size(), r) == 0; });
    if (relation == relations.end()) {
      words.back() += text[i++];
      continue;
    }
    words.push_back(*relation);
    words.emplace_back();
    i += relation->size();
  }
  return words;
}

std::string mirrored(std::string relation) {
  if (relation.front() == '<' || relation.front() == '>') relation.front() = relation.front() == '<' ? '>' : '<';
  return relation;
}

// Nothing when the text is no such condition.
std::optional<std::vector<Limit>> limits_of(const std::string& text) {
  const auto words = words_of(text);
  std::vector<Limit> limits;
  if (words.size() == 3) {
    if (const auto bound = base::parse_number(words[2])) {
      limits.push_back({words[1], *bound});
    } else if (const auto low = base::parse_number(words[0])) {
      limits.push_back({mirrored(words[1]), *low});
    }
  } else if (words.size() == 5) {
    const auto low = base::parse_number(words[0]), high = base::parse_number(words[4]);
    if (low && high) limits = {{mirrored(words[1]), *low}, {words[3], *high}};
  }
  if (limits.empty()) return std::nullopt;
  return limits;
}

bool fits(double value, const Limit& limit) {
  if (limit.relation == "<") return value < limit.bound;
  if (limit.relation == "<=") return value <= limit.bound;
  if (limit.relation == ">") return value > limit.bound;
  if (limit.relation == ">=") return value >= limit.bound;
  if (limit.relation == "!=") return value != limit.bound;
  return value == limit.bound;
}

std::string number_problem(const std::string& condition, const std::string& value) {
  const auto limits = limits_of(condition);
  if (!limits) return "";
  const auto number = base::parse_number(value);
  const bool is_good = number && std::ranges::all_of(*limits, [&](const Limit& limit) { return fits(*number, limit); });
  return is_good ? "" : condition;
}

}  // namespace

bool is_parameter_type(const std::string& type_text) {
  auto type = without_blanks(type_text);
  for (const std::string list : {"std::vector<", "vector<"}) {
    if (type.starts_with(list) && type.ends_with('>')) type = type.substr(list.size(), type.size() - list.size() - 1);
  }
  static const std::set<std::string> others = {"float", "double", "bool", "string", "std::string", "char", "unsignedchar"};
  return integer_range(type) || others.contains(type);
}

std::string type_problem(const std::string& type_text, const std::string& value) {
  auto type = without_blanks(type_text);
  for (const std::string list : {"std::vector<", "vector<"}) {
    if (!type.starts_with(list) || !type.ends_with('>')) continue;
    type = type.substr(list.size(), type.size() - list.size() - 1);
    if (base::trim(value).empty()) return "";
    for (const auto& part : base::split_list(value, ',')) {
      if (const auto problem = scalar_problem(type, part); !problem.empty()) return problem + " in each place";
    }
    return "";
  }
  return scalar_problem(type, value);
}

std::string constraint_problem(const std::string& constraint_text, const std::string& value) {
  const auto constraint = without_blanks(constraint_text);
  if (constraint.empty()) return "";
  const bool is_choice = (constraint.front() == '(' && constraint.back() == ')') || (constraint.front() == '{' && constraint.back() == '}');
  if (is_choice) {
    const auto inside = constraint.substr(1, constraint.size() - 2);
    if (inside.find_first_of("(){}:<>=") != std::string::npos) return "";
    const auto choices = base::split_list(inside, ',');
    const bool may_be_several = constraint.front() == '{';
    for (const auto& part : may_be_several ? base::split_list(value, ',') : std::vector<std::string>{value}) {
      if (std::ranges::find(choices, without_blanks(part)) == choices.end())
        return (may_be_several ? "some of " : "one of ") + base::join(choices, ", ");
    }
    return "";
  }
  const auto conditions = base::split_list(constraint, ',');
  if (conditions.size() == 1) return number_problem(constraint, value);
  const auto parts = base::split_list(value, ',');
  for (std::size_t i = 0; i < conditions.size() && i < parts.size(); ++i) {
    if (const auto problem = number_problem(conditions[i], parts[i]); !problem.empty())
      return problem + " in place " + std::to_string(i + 1);
  }
  return "";
}

}  // namespace tools
