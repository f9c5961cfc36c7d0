#include "names.h"

#include <algorithm>
#include <cctype>

namespace ros2 {
namespace {

bool is_letter_or_digit(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

constexpr std::string_view middle = "::dds_::";

}  // namespace

std::string token(std::string_view text) {
  std::string name(text);
  std::ranges::replace_if(
      name, [](char c) { return !is_letter_or_digit(c); }, '_');
  if (name.empty() || is_digit(name.front())) name.insert(name.begin(), '_');
  return name;
}

std::string tokens(std::string_view scoped) {
  std::string names;
  while (true) {
    const auto border = scoped.find("::");
    names += token(scoped.substr(0, border));
    if (border == std::string_view::npos) return names;
    names += '/';
    scoped.remove_prefix(border + 2);
  }
}

std::optional<std::string> problem_of_name(std::string_view name) {
  constexpr std::size_t most = 247;
  if (name.empty() || name.front() != '/') return "must begin with /";
  if (name.size() > most) return "must have at most 247 characters";
  if (name.back() == '/') return "must not end with /";
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name[i] != '/' && !is_letter_or_digit(name[i])) return "may have letters, digits, _ and / only";
    if (name[i] == '/' && (name[i + 1] == '/' || is_digit(name[i + 1]))) return "has an empty part, or one that begins with a digit";
  }
  return std::nullopt;
}

std::string topic_on_wire(std::string_view topic) { return "rt" + std::string(topic); }
std::string request_on_wire(std::string_view service) { return "rq" + std::string(service) + "Request"; }
std::string reply_on_wire(std::string_view service) { return "rr" + std::string(service) + "Reply"; }

std::string type_on_wire(std::string_view type) {
  const auto last = type.rfind('/');
  std::string front(type.substr(0, last));
  if (const auto slash = front.find('/'); slash != std::string::npos) front.replace(slash, 1, "::");
  return front + std::string(middle) + std::string(type.substr(last + 1)) + "_";
}

std::string type_of_ros(std::string_view type) {
  const auto found = type.find(middle);
  if (found == std::string_view::npos || !type.ends_with('_')) return std::string(type);
  std::string name(type.substr(0, found));
  if (const auto border = name.find("::"); border != std::string::npos) name.replace(border, 2, "/");
  const auto last = type.substr(found + middle.size());
  return name + "/" + std::string(last.substr(0, last.size() - 1));
}

std::optional<std::string> value_in(std::string_view user_data, std::string_view key) {
  while (!user_data.empty()) {
    const auto end = user_data.find(';');
    const auto entry = user_data.substr(0, end);
    if (const auto equals = entry.find('='); equals != std::string_view::npos && entry.substr(0, equals) == key)
      return std::string(entry.substr(equals + 1));
    if (end == std::string_view::npos) break;
    user_data.remove_prefix(end + 1);
  }
  return std::nullopt;
}

}  // namespace ros2
