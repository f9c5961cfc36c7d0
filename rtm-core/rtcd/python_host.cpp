#include "python_host.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace {

namespace fs = std::filesystem;

// Debian's Python: the extension modules are made for it, whatever other one comes first in PATH.
constexpr const char* interpreter = "/usr/bin/python3";

std::string bare_name(std::string module) {
  module = module.substr(0, module.find('?'));
  module = module.substr(0, module.find('('));
  const auto colon = module.rfind("RTC:", 0) == 0 ? module.find_first_not_of(':') : std::string::npos;
  if (colon == std::string::npos) return module;
  // RTC:vendor:category:Type:language:version
  std::size_t from = 0;
  for (int field = 0; field < 3 && from != std::string::npos; ++field) {
    from = module.find(':', from);
    if (from != std::string::npos) ++from;
  }
  return from == std::string::npos ? module : module.substr(from, module.find(':', from) - from);
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

// Where the packages are: in a build folder, or in an installation under another prefix than /usr.
void add_packages() {
  std::error_code error;
  const auto prefix = fs::read_symlink("/proc/self/exe", error).parent_path().parent_path();
  for (const auto& folder : {prefix / "python", prefix / "lib/python3/dist-packages"}) {
    if (prefix == "/usr" || !is_file(folder / "OpenRTM_aist/rtcd.py")) continue;
    const char* known = std::getenv("PYTHONPATH");
    setenv("PYTHONPATH", (folder.string() + (known && *known ? std::string(":") + known : "")).c_str(), 1);
    return;
  }
}

// As which Python starts: that of an active virtual environment, whose packages it then has, if it is this interpreter. By a bare name,
// Python would find its library along PATH, which may be that of another installation.
std::string started_as() {
  std::error_code error;
  const char* active = std::getenv("VIRTUAL_ENV");
  const fs::path own = fs::path(active ? active : "") / "bin/python3";
  return active && fs::equivalent(own, interpreter, error) ? own.string() : interpreter;
}

}  // namespace

bool is_for_python(const std::vector<std::string>& modules, const std::vector<std::string>& load_path) {
  return std::any_of(modules.begin(), modules.end(), [&](const std::string& module) {
    const std::string name = bare_name(module);
    if (name.ends_with(".py")) return true;
    if (name.empty() || name.find('/') != std::string::npos) return false;
    for (const auto& folder : load_path) {
      for (const auto& library : {name, name + ".so", "lib" + name + ".so"})
        if (is_file(fs::path(folder) / library)) return false;
      if (is_file(fs::path(folder) / (name + ".py"))) return true;
    }
    return false;
  });
}

std::string become_python(const std::vector<std::string>& options, const std::vector<std::string>& modules) {
  add_packages();
  std::vector<std::string> words = {started_as(), "-m", "OpenRTM_aist.rtcd"};
  words.insert(words.end(), options.begin(), options.end());
  words.emplace_back("--");
  words.insert(words.end(), modules.begin(), modules.end());
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv(interpreter, arguments.data());
  return std::string("modules of Python need ") + interpreter + ", which does not start: " + std::strerror(errno);
}
