// The command line of every program with a manager. Any thread.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"

namespace rt {

struct ManagerArguments {
  std::optional<std::string> config_file;                      // -f
  bool ignore_no_config = false;                               // -i: -f may name a file that is not there
  bool without_servant = false;                                // -a
  bool is_master = false;                                      // -d
  std::optional<int> port;                                     // -p
  std::vector<std::pair<std::string, std::string>> overrides;  // -o key:value, in order
  std::vector<std::string> orb_arguments;                      // -ORB...
  std::vector<std::string> unknown;                            // options that are somebody else's
  std::vector<std::string> rest;                               // what is no option
};

// `arguments` without the program's name. Fails with one line when a value is missing or wrong.
base::Result<ManagerArguments> parse_manager_arguments(const std::vector<std::string>& arguments);

}  // namespace rt
