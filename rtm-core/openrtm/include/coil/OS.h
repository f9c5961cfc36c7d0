// The operating system as the classic API shows it. Any thread, as far as the functions of the system are.
#pragma once

#include <sys/types.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace coil {

using utsname = ::utsname;
using pid_t = ::pid_t;

inline int uname(utsname* name) { return ::uname(name); }
inline pid_t getpid() { return ::getpid(); }
inline pid_t getppid() { return ::getppid(); }
// 1.x: nullptr if it is not set. 2.x: false if it is not set.
inline char* getenv(const char* name) { return std::getenv(name); }
inline bool getenv(const char* name, std::string& value) {
  const char* found = std::getenv(name);
  if (found == nullptr) return false;
  value = found;
  return true;
}

// Walks through command-line options, see getopt(3). One at a time in a process.
class GetOpt {
 public:
  GetOpt(int argc, char* const argv[], const char* opt, int flag) : argc_(argc), argv_(argv), opt_(opt), opterr(flag) { ::optind = 1; }

  // The next option, '?' for an unknown one, -1 at the end.
  int operator()() {
    ::opterr = opterr;
    const int found = ::getopt(argc_, argv_, opt_);
    optarg = ::optarg;
    optind = ::optind;
    optopt = ::optopt;
    return found;
  }

 private:
  int argc_;
  char* const* argv_;
  const char* opt_;

 public:
  char* optarg = nullptr;
  int optind = 1;
  int opterr;
  int optopt = 0;
};

}  // namespace coil
