#include "base/name_list.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <optional>
#include <set>
#include <string_view>

#include "base/text.h"

namespace base {
namespace {

constexpr std::size_t max_listed_values = 100'000;

bool is_list_name(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

struct Numbered {
  std::string prefix, digits;
};

std::optional<Numbered> numbered(const std::string& text) {
  const auto at = text.find_last_not_of("0123456789") + 1;  // npos + 1 is 0
  if (at == text.size() || text.size() - at > 9) return std::nullopt;
  return Numbered{text.substr(0, at), text.substr(at)};
}

// "r0..r9" and "r00..r99"; false when it is none, or too long.
bool append_range(const std::string& from, const std::string& to, std::vector<std::string>& values) {
  const auto a = numbered(from), b = numbered(to);
  if (!a || !b || a->prefix != b->prefix) return false;
  const auto first = std::stoul(a->digits), last = std::stoul(b->digits);
  if (first > last || last - first >= max_listed_values) return false;
  for (auto i = first; i <= last; ++i) {
    auto number = std::to_string(i);
    if (a->digits.size() > 1 && number.size() < a->digits.size()) number.insert(0, a->digits.size() - number.size(), '0');
    values.push_back(a->prefix + number);
  }
  return true;
}

}  // namespace

Result<NameList> NameList::parse(const std::string& text) {
  const auto fail = [&](const std::string& why) {
    return Error{"--for " + in_quotes(text) + ": " + why + "; expected NAME=LIST, for example robot=r0..r99, robot=a,b or robot=100"};
  };
  const auto equals = text.find('=');
  NameList list;
  list.name = text.substr(0, equals);
  if (equals == std::string::npos || !is_list_name(list.name)) return fail("has no name");
  const auto words = split_list(text.substr(equals + 1));
  if (words.size() == 1 && words[0].find_first_not_of("0123456789") == std::string::npos) {
    const auto count = parse_integer(words[0]).value_or(-1);
    if (count < 1 || count > static_cast<std::int64_t>(max_listed_values)) return fail("has " + words[0] + " values, not 1 to 100000");
    for (std::int64_t i = 0; i < count; ++i) list.values.push_back(list.name + std::to_string(i));
    return list;
  }
  for (const auto& word : words) {
    const auto dots = word.find("..");
    if (dots == std::string::npos) {
      list.values.push_back(word);
    } else if (!append_range(word.substr(0, dots), word.substr(dots + 2), list.values)) {
      return fail(in_quotes(word) + " is not a range of at most 100000 numbers");
    }
  }
  if (list.values.empty()) return fail("has no values");
  if (list.values.size() > max_listed_values) return fail("has more than 100000 values");
  std::set<std::string> seen;
  for (const auto& value : list.values) {
    if (value.find_first_of("{}=&?/ \t") != std::string::npos) return fail("value " + in_quotes(value) + " cannot be a part of a name");
    if (!seen.insert(value).second) return fail("has " + in_quotes(value) + " twice");
  }
  return list;
}

std::string NameList::filled(std::string text, std::size_t number) const {
  const auto replace = [&](const std::string& what, const std::string& by) {
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) text.replace(at, what.size(), by);
  };
  replace("{" + name + "}", values[number]);
  replace("{" + name + "#}", std::to_string(number));
  return text;
}

bool NameList::is_in(const std::string& text) const {
  return text.find("{" + name + "}") != std::string::npos || text.find("{" + name + "#}") != std::string::npos;
}

}  // namespace base
