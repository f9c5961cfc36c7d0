#include "output.h"

#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

namespace editor {

bool output_is_closed() {
  pollfd out{STDOUT_FILENO, 0, 0};
  return poll(&out, 1, 0) > 0 && (out.revents & (POLLERR | POLLNVAL)) != 0;
}

bool flush_output() {
  const bool is_written = std::cout.flush() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  return is_written || output_is_closed();
}

}  // namespace editor
