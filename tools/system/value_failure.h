// Ends the walk through a value that cannot be read or written. Thrown and caught inside one file: only an Error leaves it.
#pragma once

#include <string>

namespace tools {

struct ValueFailure {
  std::string message;
};

}  // namespace tools
