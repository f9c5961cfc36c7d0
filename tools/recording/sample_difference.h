// Finds the first member in which two samples differ, with both values. Values; any thread.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "recording/sample_text.h"

namespace recorder {

struct DifferenceOptions {
  std::vector<std::string> ignored;          // members that do not count, with what is in them: "tm", "data.vx"
  std::map<std::string, double> tolerances;  // numbers of this member, and of what is in it, may differ so far; "" is all members
};

// "data.vx: 0.5 and 0.4"; nothing when all that counts is equal. Not a number equals itself.
std::optional<std::string> difference(const DifferenceOptions& options, const Json& first, const Json& second);

// "MEMBER=EPS", or "EPS" for all members.
base::Result<std::pair<std::string, double>> parse_tolerance(const std::string& text);

}  // namespace recorder
