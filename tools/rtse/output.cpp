#include "rtse/output.h"

#include <cstdio>
#include <iostream>

#include "base/descriptors.h"

namespace tools {

bool flush_output() {
  const bool is_written = std::cout.flush() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  return is_written || base::output_is_closed();
}

}  // namespace tools
