// A name with a list of values, as "robot=r0..r99": {robot} in a text stands for each value, {robot#} for its number (from 0). A value; any
// thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/result.h"

namespace base {

struct NameList {
  std::string name;
  std::vector<std::string> values;

  // "robot=r0..r99", "robot=r00..r99", "robot=left,right", several with commas; "robot=100" is robot0..robot99. At most 100,000 values.
  static Result<NameList> parse(const std::string& text);
  // With {name} and {name#} replaced.
  std::string filled(std::string text, std::size_t number) const;
  bool is_in(const std::string& text) const;
};

inline constexpr const char* name_list_help = "NAME=LIST: repeat what contains {NAME} for each value: robot=r0..r99, robot=a,b, robot=100";

}  // namespace base
