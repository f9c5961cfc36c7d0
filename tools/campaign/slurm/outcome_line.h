// The result of a row as one line of JSON, as written by a task on another machine. Numbers keep their exact value. Any thread.
#pragma once

#include <optional>
#include <string>

#include "campaign/run/row_run.h"

namespace campaign {

struct OutcomeLine {
  std::string key;
  Outcome outcome;     // without features
  std::string folder;  // of the row's files; empty: there are none
};

// With its line feed.
std::string to_line(const OutcomeLine& line);
// Nothing: it is no such line, as when its writer was killed.
std::optional<OutcomeLine> from_line(const std::string& text);

}  // namespace campaign
