// rtcprof FILE [INITFUNC]: prints the profiles of the components in a module, `key: value` lines with --- after each.
// rtcprof --each FILE...: those of many modules, for managers.
// A process of its own, because loading a module runs its code; with --each a child for each module, so that what one does or does not
// finish costs its own profiles only. A fork costs a third of a start with all the libraries.
#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <rtm/Manager.h>
#include <rtm/ModuleManager.h>

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <string>

#include "profile_manual.h"

namespace {

constexpr char usage[] =
    "usage: rtcprof FILE [INITFUNC]\n"
    "  FILE      Module: print the profiles of its RT components\n"
    "  INITFUNC  Function that registers them (default: the file's name with Init)\n"
    "  --each FILE...  Print those of many modules, each with its module_file_path; a module that fails\n"
    "            or takes more than 10 s has none\n"
    "  --man     Print the manual page (view it with: man -l)\n";

// So that rt::parse_config reads it back.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '\\':
        result += "\\\\";
        break;
      case '\n':
        result += "\\n";
        break;
      case '\r':
        result += "\\r";
        break;
      case '\t':
        result += "\\t";
        break;
      default:
        result += c;
    }
  }
  return result;
}

int fail(const std::string& message, int code = 1) {
  std::cerr << "rtcprof: " << message << '\n';
  return code;
}

// Prints the profiles, each with the line `more` before its end.
int print_profiles(const std::string& file, const std::string& function, const std::string& more) {
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) return fail(dlerror(), 2);
  void* symbol = dlsym(handle, function.c_str());
  if (symbol == nullptr) return fail(file + " has no function " + function, 2);
  auto& manager = RTC::Manager::profile_reader();
  reinterpret_cast<void (*)(RTC::Manager*)>(symbol)(&manager);
  for (const auto& profile : manager.getFactoryProfiles()) {
    for (const auto& key : profile.propertyNames()) std::cout << key << ": " << escaped(profile.getProperty(key)) << '\n';
    std::cout << more << "---\n";
  }
  return std::cout.flush().good() ? 0 : fail("the output cannot be written");
}

// What a child prints goes to a file in memory, which is printed when the child has ended well.
void print_profiles_in_child(const std::string& file) {
  constexpr unsigned longest_seconds = 10;
  constexpr off_t longest_output = 256 << 10;
  const int output = memfd_create("profiles", MFD_CLOEXEC);
  const pid_t child = output < 0 ? -1 : fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    alarm(longest_seconds);
    dup2(output, STDOUT_FILENO);
    const auto path = std::filesystem::absolute(file).string();
    _Exit(print_profiles(path, RTC::ModuleManager::initFunction(path), "module_file_path: " + escaped(path) + "\n"));
  }
  if (child < 0) {
    fail(file + ": no process to look into it");
  } else {
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    const off_t size = lseek(output, 0, SEEK_END);
    std::string text(status == 0 && size > 0 && size < longest_output ? static_cast<std::size_t>(size) : 0, '\0');
    if (pread(output, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size())) std::cout << text << std::flush;
  }
  if (output >= 0) close(output);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  if (first == "--each" && argc > 2) {
    for (int i = 2; i < argc; ++i) print_profiles_in_child(argv[i]);
    return std::cout.flush().good() ? 0 : fail("the output cannot be written");
  }
  if (argc < 2 || argc > 3 || first.starts_with("-")) {
    const bool is_asked = first == "--help" || first == "--man";
    (is_asked ? std::cout : std::cerr) << (first == "--man" ? profile_manual : usage);
    if (!std::cout.flush().good()) return fail("the output cannot be written");
    return is_asked ? 0 : 2;
  }
  const auto file = std::filesystem::absolute(first).string();
  _Exit(print_profiles(file, argc > 2 ? std::string(argv[2]) : RTC::ModuleManager::initFunction(file),
                       {}));  // nothing of the module's own may run any more
}
