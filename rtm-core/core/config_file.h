// The text of an rtc.conf as a list of keys and values with the lines they came from. Any thread.
// Syntax: `key: value` or `key = value`, # and ! start a comment line, a backslash at the end of a line continues it (blanks at the start
// of the next line are dropped), \t \n \r \f and a backslash before any other character are escapes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace rt {

struct ConfigEntry {
  std::string key;
  std::string value;
  int line;  // from 1; of the key
  bool operator==(const ConfigEntry&) const = default;
};

struct ConfigFinding {
  int line;
  std::string text;  // what is wrong and what was done about it
  bool operator==(const ConfigFinding&) const = default;
};

struct ConfigText {
  std::vector<ConfigEntry> entries;  // in the order of the file; a later one of the same key wins
  std::vector<ConfigFinding> findings;
};

// Takes what can be understood; the rest becomes findings.
ConfigText parse_config(std::string_view text);

// The whole file, at most 16 MiB; devices and pipes as well, as far as they end. Fails with one line that names it.
base::Result<std::string> read_text_file(const std::string& path);

}  // namespace rt
