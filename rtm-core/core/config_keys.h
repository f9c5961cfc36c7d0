// The keys of rtc.conf, with their defaults and the form of their values. Any thread.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rt {

// number: not negative; level: SILENT ... PARANOID; the plural ones are comma lists. choices: any of ConfigKey::choices; addresses: host,
// host:port or corbaloc/IOR texts; processors: their numbers; connections, components: as preconnect and precreate take them.
enum class KeyKind { text, boolean, number, size, level, choices, addresses, processors, connections, components };

struct ConfigKey {
  std::string_view name;           // a last part * stands for any further parts
  std::string_view default_value;  // empty: none
  KeyKind kind = KeyKind::text;
  std::string_view choices{};  // separated by commas
};

std::span<const ConfigKey> config_keys();

struct Complaint {
  std::string text;
  bool takes_value = false;  // all the same: nothing is known of the key (a plug-in may read it), or only an entry of a list is wrong
  bool operator==(const Complaint&) const = default;
};

// What is wrong with the key or its value; nothing if it is one of config_keys() with a fitting value or belongs to a component
// (`<category>.<type or instance>.<key>`).
std::optional<Complaint> complain_about(std::string_view key, std::string_view value);

}  // namespace rt
