#include "core/component_argument.h"

#include <algorithm>
#include <cctype>

#include "base/text.h"
#include "core/key_limits.h"

namespace rt {
namespace {

constexpr std::size_t max_length = std::size_t{64} << 10;
constexpr std::size_t max_name = 1024;

bool has_control_characters(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c); });
}

std::vector<std::string_view> pieces_of(std::string_view text, char separator) {
  std::vector<std::string_view> pieces;
  for (;;) {
    const auto at = text.find(separator);
    pieces.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return pieces;
    text.remove_prefix(at + 1);
  }
}

base::Result<ComponentId> parse_id(std::string_view text) {
  ComponentId id;
  if (text.find(':') == std::string_view::npos) {
    id.implementation_id = text;
  } else {
    const auto parts = pieces_of(text, ':');
    if (parts.size() != 6 || parts[0] != "RTC") {
      return base::Error{"component " + base::in_quotes(text) + ": expected RTC:vendor:category:type:language:version"};
    }
    id = {std::string(parts[1]), std::string(parts[2]), std::string(parts[3]), std::string(parts[4]), std::string(parts[5])};
  }
  if (id.implementation_id.empty()) return base::Error{"component " + base::in_quotes(text) + ": no type given"};
  if (id.implementation_id.size() > max_name) return base::Error{"component: type name is longer than 1024 characters"};
  return id;
}

}  // namespace

base::Result<ComponentArgument> parse_component_argument(std::string_view text) {
  text = base::trim(text);
  if (text.empty()) return base::Error{"component: no type given"};
  if (text.size() > max_length) return base::Error{"component: argument is longer than 64 KiB"};
  if (has_control_characters(text)) return base::Error{"component " + base::in_quotes(text) + ": control characters in the argument"};
  const auto question = text.find('?');
  auto id = parse_id(base::trim(text.substr(0, question)));
  if (!id) return id.error();
  ComponentArgument argument{std::move(*id), {}};
  KeyCounter counter("component: key");
  if (question == std::string_view::npos) return argument;
  for (const auto piece : pieces_of(text.substr(question + 1), '&')) {
    if (base::trim(piece).empty()) continue;  // `Type?&instance_name=x` is what some tools send
    const auto equals = piece.find('=');
    const auto key = base::trim(piece.substr(0, equals));
    if (key.empty()) return base::Error{"component " + base::in_quotes(text) + ": expected key=value, got " + base::in_quotes(piece)};
    if (auto checked = counter.add(key); !checked) return checked.error();
    const auto value = equals == std::string_view::npos ? std::string_view() : base::trim(piece.substr(equals + 1));
    argument.properties.emplace_back(key, value);
  }
  return argument;
}

bool is_match(const ComponentId& wanted, const ComponentId& offered) {
  const auto same = [](const std::string& a, const std::string& b) { return a.empty() || b.empty() || a == b; };
  return wanted.implementation_id == offered.implementation_id && same(wanted.vendor, offered.vendor) &&
         same(wanted.category, offered.category) && same(wanted.language, offered.language) && same(wanted.version, offered.version);
}

base::Result<void> check_instance_name(std::string_view name) {
  if (name.empty()) return base::Error{"instance name is empty"};
  if (name.size() > max_name) return base::Error{"instance name is longer than 1024 characters"};
  if (has_control_characters(name)) return base::Error{"instance name " + base::in_quotes(name) + ": has control characters"};
  return {};
}

}  // namespace rt
