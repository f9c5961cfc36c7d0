// A check of the command line for files of a kind. Any thread.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "base/command.h"

namespace base {

// A file of which `problem` returns "", not a whole line. As existing_file(): what is wrong with it is a BadFile.
inline Check good_file(std::function<std::string(const std::string&)> problem) {
  return {[problem = std::move(problem)](const std::string& file) {
            if (const auto line = problem(file); !line.empty()) throw BadFile{line};
            return std::string();
          },
          "FILE"};
}

}  // namespace base
