// The keys that rtc.conf may have, with their defaults and what their values must look like. Any thread.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rt {

enum class KeyKind { text, boolean, number, level };  // number: not negative; level: SILENT ... PARANOID

struct ConfigKey {
  std::string_view name;           // a last part * stands for any further parts
  std::string_view default_value;  // empty: none
  KeyKind kind = KeyKind::text;
};

std::span<const ConfigKey> config_keys();

// What is wrong with the key or its value; nothing if it is one of config_keys() with a fitting value or belongs to a component
// (`<category>.<type or instance>.<key>`).
std::optional<std::string> complain_about(std::string_view key, std::string_view value);

}  // namespace rt
