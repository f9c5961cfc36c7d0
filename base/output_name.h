// A check of options that name a file or folder that is written. Any thread.
#pragma once

#include <string>

#include "base/command.h"

namespace base {

// Not empty: such a name would be ignored in silence.
inline Check output_name() {
  return {[](const std::string& name) {
    return name.empty() ? std::string("expected the name of a file or folder, got \"\"") : std::string();
  }};
}

}  // namespace base
