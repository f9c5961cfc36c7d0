// rtcprof FILE [INITFUNC]: prints the profiles of the components in a module, `key: value` lines with --- after each.
// A process of its own, because loading a module runs its code.
#include <dlfcn.h>

#include <rtm/Manager.h>
#include <rtm/ModuleManager.h>

#include <filesystem>
#include <iostream>
#include <string>

#include "profile_manual.h"

namespace {

constexpr char usage[] =
    "usage: rtcprof FILE [INITFUNC]\n"
    "  FILE      Module: print the profiles of its RT components\n"
    "  INITFUNC  Function that registers them (default: the file's name with Init)\n"
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

int fail(const std::string& message) {
  std::cerr << "rtcprof: " << message << '\n';
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  if (argc < 2 || argc > 3 || first.starts_with("-")) {
    const bool is_asked = first == "--help" || first == "--man";
    (is_asked ? std::cout : std::cerr) << (first == "--man" ? profile_manual : usage);
    if (!std::cout.flush().good()) return fail("the output cannot be written");
    return is_asked ? 0 : 2;
  }
  const auto file = std::filesystem::absolute(first).string();
  const auto function = argc > 2 ? std::string(argv[2]) : RTC::ModuleManager::initFunction(file);
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) return fail(dlerror());
  void* symbol = dlsym(handle, function.c_str());
  if (symbol == nullptr) return fail(file + " has no function " + function);
  auto& manager = RTC::Manager::profile_reader();
  reinterpret_cast<void (*)(RTC::Manager*)>(symbol)(&manager);
  for (const auto& profile : manager.getFactoryProfiles()) {
    for (const auto& key : profile.propertyNames()) std::cout << key << ": " << escaped(profile.getProperty(key)) << '\n';
    std::cout << "---\n";
  }
  const bool is_written = std::cout.flush().good();
  if (!is_written) fail("the output cannot be written");
  _Exit(is_written ? 0 : 1);  // nothing of the module's own may run any more
}
