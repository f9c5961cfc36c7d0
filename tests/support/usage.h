// --help of programs that tests and benchmarks start: without it, who tries one by hand starts minutes of work, or waits for nothing.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace test {

// Prints "usage: ..." and ends the process if the first argument asks for help.
inline void answer_help(int argc, char** argv, const char* usage) {
  if (argc < 2 || (std::string_view(argv[1]) != "--help" && std::string_view(argv[1]) != "-h")) return;
  std::printf("usage: %s\n", usage);
  std::exit(0);
}

}  // namespace test
