#include "rtm/ModuleManager.h"

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>

#include "base/guarded.h"
#include "base/log.h"
#include "base/text.h"
#include "core/config_file.h"
#include "core/name_format.h"
#include "manager/manager_impl.h"
#include "rtm/ECFactory.h"

namespace RTC {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

constexpr const char* profile_program = "rtcprof";
constexpr const char* block_end = "---";
constexpr const char* script_suffix = ".py";

std::string real_path(const fs::path& path) {
  std::error_code error;
  const auto result = fs::weakly_canonical(path, error);
  return error ? path.string() : result.string();
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

// Where this library is: PREFIX/lib, or PREFIX/lib/ARCHITECTURE.
fs::path library_folder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<void*>(&library_folder), &info) == 0 || info.dli_fname == nullptr) return {};
  return fs::path(real_path(info.dli_fname)).parent_path();
}

// Of the same installation or build folder; else wherever PATH has it. Where packages of OpenRTM-aist are too, `rtcprof` may be theirs.
std::string profile_program_path() {
  const auto lib = library_folder();
  for (const auto& prefix : {lib.parent_path(), lib.parent_path().parent_path()}) {
    for (const auto* name : {"rtcprof.rtm-sim", profile_program}) {
      if (const auto path = prefix / "bin" / name; is_file(path)) return path.string();
    }
  }
  return profile_program;
}

bool ends_until(pid_t child, steady_clock::time_point deadline) {
  const int process = static_cast<int>(syscall(SYS_pidfd_open, child, 0));
  if (process < 0) {  // a kernel without them
    siginfo_t info{};
    while (waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == 0) {
      if (steady_clock::now() >= deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));  // nothing tells of it
    }
    return true;
  }
  int ready = -1;
  do {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - steady_clock::now()).count();
    pollfd ended{process, POLLIN, 0};
    ready = poll(&ended, 1, static_cast<int>(std::max<std::int64_t>(left, 0)));
  } while (ready < 0 && errno == EINTR);
  close(process);
  return ready > 0;
}

// What the program prints on stdout; nothing when it fails or takes too long, in which case it is killed. `start_error`: why it does not
// start, or 0.
std::optional<std::string> output_of(const std::vector<std::string>& words, std::chrono::seconds timeout, int& start_error) {
  base::expect_no_data_held();
  constexpr std::size_t longest = std::size_t{64} << 20;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  std::vector<char*> argv;
  for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  pid_t child = -1;
  start_error = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string output;
  bool complete = false;
  if (start_error == 0) {
    const auto deadline = steady_clock::now() + timeout;
    while (output.size() < longest) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - steady_clock::now()).count();
      pollfd ready{ends[0], POLLIN, 0};
      if (left <= 0 || poll(&ready, 1, static_cast<int>(left)) == 0) break;
      char buffer[4096];
      const auto size = read(ends[0], buffer, sizeof buffer);
      if (size < 0 && errno == EINTR) continue;
      if (size <= 0) {
        complete = size == 0;
        break;
      }
      output.append(buffer, static_cast<std::size_t>(size));
    }
    if (complete) complete = ends_until(child, deadline);  // it may have closed its output long before
    if (!complete) kill(child, SIGKILL);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    complete = complete && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  close(ends[0]);
  if (!complete) return std::nullopt;
  return output;
}

// A library with stubs of its own has registered them with the ORB, which keeps pointers into it: it must stay mapped.
bool contains_stubs(const std::string& file) {
  const auto text = rt::read_text_file(file);
  return !text || text->find("_pof_") != std::string::npos;
}

// Of a library that is shorter than it says, the loader maps pages that are not there, and whoever touches them dies.
bool is_cut_short(const std::string& file) {
  base::expect_no_data_held();
  std::error_code error;
  const auto size = fs::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  Elf64_Ehdr header{};
  if (error || !in.read(reinterpret_cast<char*>(&header), sizeof header)) return false;  // dlopen says what it is instead
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64) return false;
  for (int i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr segment{};
    in.seekg(static_cast<std::streamoff>(header.e_phoff + static_cast<Elf64_Off>(i) * header.e_phentsize));
    if (!in.read(reinterpret_cast<char*>(&segment), sizeof segment)) return true;
    if (segment.p_filesz > size || segment.p_offset > size - segment.p_filesz) return true;
  }
  return false;
}

struct Module {
  std::string file;
  std::string init_function;
  void* handle = nullptr;
  bool registers_contexts = false;
};

// `name(function)` -> name, function.
std::pair<std::string, std::string> split_module(const std::string& module, const std::string& init_function) {
  const auto text = std::string(base::trim(module));
  const auto open = text.find('(');
  if (open == std::string::npos || !text.ends_with(')')) return {text, init_function};
  return {std::string(base::trim(text.substr(0, open))), std::string(base::trim(text.substr(open + 1, text.size() - open - 2)))};
}

}  // namespace

struct ModuleManager::Impl {
  struct Profile {
    fs::file_time_type time;
    std::uintmax_t size = 0;
    std::vector<coil::Properties> profiles;
  };

  Manager* manager;
  std::function<std::string(const std::string&, const std::string&)> load_script;
  base::Guarded<std::vector<Module>, base::Rank::objects> modules;
  base::Guarded<std::map<std::string, Profile>, base::Rank::objects> known_profiles;

  std::vector<fs::path> load_path() const {
    std::vector<fs::path> folders;
    const auto nothing = [](char) { return std::optional<std::string>(); };
    auto paths = base::split_list(manager->configValue("manager.modules.load_path"));
    for (const auto* key : {"manager.modules.C++.load_paths", "manager.modules.Python.load_paths"})
      for (const auto& path : base::split_list(manager->configValue(key))) paths.push_back(path);
    for (const auto& path : paths) folders.emplace_back(rt::expand_format(path, nothing));
    // Last, the modules that were installed with this library: PREFIX/lib/rtm-sim.
    const auto lib = library_folder();
    for (const auto& installed : {lib / "rtm-sim", lib.parent_path() / "rtm-sim"}) {
      std::error_code error;
      if (fs::is_directory(installed, error)) folders.push_back(installed);
    }
    return folders;
  }

  // Whether a file, by its real path, is in one of these folders or below.
  bool is_in_load_path(const fs::path& file) const {
    for (const auto& path : load_path()) {
      const fs::path folder = fs::path(real_path(path)) / "";  // weakly_canonical keeps or drops a slash at the end
      const auto up = file.lexically_relative(folder.parent_path());
      if (!up.empty() && *up.begin() != "..") return true;
    }
    return false;
  }

  // With the dot.
  std::vector<std::string> suffixes() const {
    auto list = base::split_list(manager->configValue("manager.modules.C++.suffixes"));
    for (auto& suffix : list) {
      if (!suffix.starts_with('.')) suffix.insert(0, ".");
    }
    if (list.empty()) list.emplace_back(".so");
    list.emplace_back(script_suffix);  // after the libraries: of two modules of one name the library counts
    return list;
  }

  // The line that says why it failed.
  std::string run_script(const std::string& file, const std::string& function) {
    if (!load_script) return "is a Python module: it needs a process of its own, " + base::in_quotes("rtcd " + file) + " or python3";
    const auto contexts_before = ExecutionContextFactory::instance().getIdentifiers().size();
    ManagerImpl::current_module = file;
    std::string failure = load_script(file, function);
    ManagerImpl::current_module.clear();
    if (!failure.empty()) {
      manager->impl_->forget_module(file);
      return failure;
    }
    modules.lock()->push_back({file, function, nullptr, ExecutionContextFactory::instance().getIdentifiers().size() != contexts_before});
    return {};
  }

  std::string init_function(const std::string& file) const {
    const auto suffix = manager->configValue("manager.modules.init_func_suffix");
    const auto name = ModuleManager::initFunction(file);
    const auto base_name = name.substr(0, name.size() - std::string_view("Init").size());
    return manager->configValue("manager.modules.init_func_prefix") + base_name + (suffix.empty() ? "Init" : suffix);
  }

  // The program that prints the profiles in a module, and its arguments; none: ours, which looks into many at a time.
  std::vector<std::string> profile_command() const {
    auto given = base::split_list(manager->configValue("manager.modules.C++.profile_cmd"), ' ');
    if (given.size() == 1 && (given[0] == profile_program || given[0] == "rtcprof2")) given.clear();
    return given;
  }

  std::optional<Module> find(const std::string& name, const std::string& file) const {
    for (const auto& module : modules.snapshot()) {
      const fs::path path(module.file);
      if (module.file == file || path.filename() == name || path.stem() == name) return module;
    }
    return std::nullopt;
  }

  static Profile nothing_known_of(const std::string& file) {
    std::error_code error;
    return {fs::last_write_time(file, error), fs::file_size(file, error), {}};
  }

  // Fills known_profiles for the files that are new or have changed.
  void look_into(const std::vector<std::string>& files) {
    std::vector<std::string> changed;
    {
      auto known = known_profiles.lock();
      for (const auto& file : files) {
        const auto profile = nothing_known_of(file);
        const auto at = known->find(file);
        if (at == known->end() || at->second.time != profile.time || at->second.size != profile.size) changed.push_back(file);
      }
    }
    const auto given = profile_command();
    const std::size_t most = given.empty() ? 200 : 1;
    const auto command = given.empty() ? std::vector<std::string>{profile_program_path(), "--each"} : given;
    for (std::size_t first = 0; first < changed.size(); first += most) {
      const auto begin = changed.begin() + static_cast<std::ptrdiff_t>(first);
      auto found = profiles_by_file(command, {begin, begin + static_cast<std::ptrdiff_t>(std::min(most, changed.size() - first))});
      auto known = known_profiles.lock();
      for (auto& [file, profile] : found) known->insert_or_assign(file, std::move(profile));
    }
  }

  // What the command prints of these files; nothing when it does not start.
  static std::map<std::string, Profile> profiles_by_file(std::vector<std::string> command, const std::vector<std::string>& files) {
    std::map<std::string, Profile> found;
    for (const auto& file : files) found.emplace(file, nothing_known_of(file));
    command.insert(command.end(), files.begin(), files.end());
    int start_error = 0;
    const auto output = output_of(command, std::chrono::seconds(10) * files.size(), start_error);
    if (start_error != 0) {
      base::log(base::Level::warn, "manager", "cannot start {} to inspect module {}{}: {}", command.front(), files.front(),
                files.size() > 1 ? " and " + std::to_string(files.size() - 1) + " more" : "", std::strerror(start_error));
      return {};
    }
    std::string block;
    std::string_view rest = output ? std::string_view(*output) : std::string_view();
    while (!rest.empty()) {
      const auto end = rest.find('\n');
      const auto line = rest.substr(0, end);
      rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
      if (line != block_end) {
        block.append(line).append("\n");
        continue;
      }
      coil::Properties properties;
      for (const auto& entry : rt::parse_config(block).entries) properties.setProperty(entry.key, entry.value);
      block.clear();
      const auto file = files.size() == 1 ? files.front() : properties.getProperty("module_file_path");
      const auto at = found.find(file);
      if (at == found.end()) continue;
      properties.setProperty("module_file_name", fs::path(file).filename().string());
      properties.setProperty("module_file_path", file);
      at->second.profiles.push_back(std::move(properties));
    }
    return found;
  }
};

ModuleManager::ModuleManager(Manager* manager) : impl_(std::make_unique<Impl>()) { impl_->manager = manager; }
ModuleManager::~ModuleManager() = default;

std::string ModuleManager::findFile(const std::string& name) const {
  if (name.empty() || name.find('\0') != std::string::npos) return {};
  const fs::path given(name);
  if (name.find('/') != std::string::npos) {
    if (is_file(given)) return real_path(given);
    if (given.is_absolute()) return {};
  }
  for (const auto& folder : impl_->load_path()) {
    if (is_file(folder / name)) return real_path(folder / name);
    for (const auto& suffix : impl_->suffixes()) {
      for (const auto& file : {name + suffix, "lib" + name + suffix}) {
        if (is_file(folder / file)) return real_path(folder / file);
      }
    }
  }
  return {};
}

std::string ModuleManager::initFunction(const std::string& file) {
  auto stem = fs::path(file).stem().string();
  if (stem.starts_with("lib")) stem.erase(0, 3);
  return stem + "Init";
}

std::string described_load_path(const std::string& value) {
  return value + (value.find(':') == std::string::npos ? "" : " (its folders are separated by commas, not by colons)");
}

ReturnCode_t ModuleManager::load(const std::string& text, const std::string& init_function, std::string& error) {
  auto [name, function] = split_module(text, init_function);
  const auto complain = [&](const std::string& why) {
    error = "module " + base::in_quotes(name) + ": " + why;
    return RTC_ERROR;
  };
  if (name.empty() || name.size() > 4096) return complain("not the name of a file"), BAD_PARAMETER;
  const auto file = findFile(name);
  if (file.empty())
    return complain("not found; looked in " + described_load_path(impl_->manager->configValue("manager.modules.load_path"))), BAD_PARAMETER;
  if (!base::parse_bool(impl_->manager->configValue("manager.modules.abs_path_allowed")).value_or(true)) {
    const char* const forbidden = " is not allowed by manager.modules.abs_path_allowed";
    if (fs::path(name).is_absolute()) return complain(std::string("an absolute path") + forbidden), PRECONDITION_NOT_MET;
    if (!impl_->is_in_load_path(file)) return complain(file + ", outside manager.modules.load_path," + forbidden), PRECONDITION_NOT_MET;
  }
  if (impl_->find({}, file)) return RTC_OK;
  if (file.ends_with(script_suffix)) {
    base::expect_no_data_held();
    const std::string failure = impl_->run_script(file, function);
    return failure.empty() ? RTC_OK : complain(failure);
  }
  if (function.empty()) function = impl_->init_function(file);

  if (is_cut_short(file)) return complain("is cut short");
  base::expect_no_data_held();
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* why = dlerror();
    return complain(why != nullptr ? why : "cannot be loaded");
  }
  void* symbol = dlsym(handle, function.c_str());
  // A library may be named otherwise than the function in it only when the caller says so, except for the prefix lib.
  if (symbol == nullptr && init_function.empty()) symbol = dlsym(handle, (fs::path(file).stem().string() + "Init").c_str());
  if (symbol == nullptr) {
    dlclose(handle);
    return complain("has no function " + function);
  }
  const auto contexts_before = ExecutionContextFactory::instance().getIdentifiers().size();
  ManagerImpl::current_module = file;
  std::string failure;
  try {
    reinterpret_cast<void (*)(Manager*)>(symbol)(impl_->manager);
  } catch (const std::exception& e) {
    failure = e.what();
  } catch (...) {
    failure = "unknown exception";
  }
  ManagerImpl::current_module.clear();
  if (!failure.empty()) {  // it stays mapped: somebody may hold something of it
    impl_->manager->impl_->forget_module(file);
    return complain(function + " failed: " + failure);
  }
  impl_->modules.lock()->push_back(
      {file, function, handle, ExecutionContextFactory::instance().getIdentifiers().size() != contexts_before});
  return RTC_OK;
}

void ModuleManager::setScriptLoader(std::function<std::string(const std::string& file, const std::string& init_function)> loader) {
  impl_->load_script = std::move(loader);
}

ReturnCode_t ModuleManager::unload(const std::string& name) {
  const auto module = impl_->find(name, findFile(name));
  if (!module) return BAD_PARAMETER;
  if (impl_->manager->impl_->forget_module(module->file) > 0) return PRECONDITION_NOT_MET;
  std::erase_if(*impl_->modules.lock(), [&](const auto& other) { return other.file == module->file; });
  if (module->handle && !module->registers_contexts && !contains_stubs(module->file)) dlclose(module->handle);
  return RTC_OK;
}

void ModuleManager::unloadAll() {
  for (const auto& module : impl_->modules.snapshot()) unload(module.file);
}

void* ModuleManager::symbol(const std::string& name, const std::string& function) const {
  const auto module = impl_->find(name, findFile(name));
  return module && module->handle ? dlsym(module->handle, function.c_str()) : nullptr;
}

std::vector<coil::Properties> ModuleManager::getLoadedModules() const {
  std::vector<coil::Properties> result;
  for (const auto& module : impl_->modules.snapshot()) {
    coil::Properties properties;
    properties.setProperty("file_path", module.file);
    properties.setProperty("import_path", fs::path(module.file).parent_path().string());
    properties.setProperty("init_func", module.init_function);
    properties.setProperty("language", module.handle ? "C++" : "Python");
    result.push_back(std::move(properties));
  }
  return result;
}

std::vector<coil::Properties> ModuleManager::getLoadableModules() {
  std::vector<std::string> files;
  const auto suffixes = impl_->suffixes();
  for (const auto& folder : impl_->load_path()) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const auto extension = entry.path().extension().string();
      if (std::find(suffixes.begin(), suffixes.end(), extension) == suffixes.end() || !is_file(entry.path())) continue;
      const auto file = real_path(entry.path());
      if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
    }
  }
  impl_->look_into(files);
  std::vector<coil::Properties> result;
  auto known = impl_->known_profiles.lock();
  for (const auto& file : files) {
    const auto at = known->find(file);
    if (at != known->end()) result.insert(result.end(), at->second.profiles.begin(), at->second.profiles.end());
  }
  return result;
}

}  // namespace RTC
