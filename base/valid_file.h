// Checks the content of files on the command line. Any thread.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "base/command.h"

namespace base {

// Accepts a file for which `problem` returns "". Otherwise the text, a whole line, is thrown as BadFile, as by existing_file().
inline Check valid_file(std::function<std::string(const std::string&)> problem) {
  return {[problem = std::move(problem)](const std::string& file) {
            if (const auto line = problem(file); !line.empty()) throw BadFile{line};
            return std::string();
          },
          "FILE"};
}

}  // namespace base
