// rtcd: hosts components. See `rtcd --help`.
#include <rtm/Manager.h>
#include <rtm/ManagerConfig.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "base/command_line.h"
#include "base/prefork.h"
#include "base/text.h"
#include "core/manager_arguments.h"
#include "name_service.h"
#include "python_host.h"

namespace {

// The options for --help, --completion and --man; they are read by the manager, as those of every component program.
struct Description {
  base::Command app{"rtcd: hosts RT components"};
  Description() {
    base::add_standard_options(app, "rtcd", RTMSIM_VERSION);
    app.add_option("MODULE")->description(
        "Module (a library, or a source of Python), or its name in manager.modules.load_path: load it and create one component of each of "
        "its types. "
        "Type?key=value&...: create a component, loading Type.so if necessary");
    app.add_option("-f")->description("Read this file instead of $RTC_MANAGER_CONFIG, ./rtc.conf, /etc/rtc.conf, ...")->type_name("FILE");
    app.add_flag("-i")->description("Ignore a missing -f file");
    app.add_option("-o")->description("Override a key of rtc.conf (repeatable)")->type_name("KEY:VALUE");
    app.add_option("-p")->description("Listen on this port of the loopback interface")->type_name("PORT");
    app.add_flag("-d")->description("Be the master manager: listen on the port of corba.master_manager");
    app.add_flag("-a")->description("Start no CORBA object for the manager");
    app.add_flag("--with-naming")
        ->description(
            "Start omniNames if the first of corba.nameservers does not respond; stop it at the end. Without MODULE the program waits for "
            "others "
            "to create components");
    app.footer(
        "Exit code: 0 ended on request, 1 failed, 2 wrong command line\n"
        "SIGTERM ends the program. So do SIGINT and SIGHUP, unless they were ignored at its start, as with nohup");
  }
};

// Modules of the load path that the words before name, and of the folders where ours are: beside the program, when built and when
// installed.
std::optional<std::vector<base::Offer>> modules_offered(const std::string& value, const std::vector<std::string>& before,
                                                        const std::string& current) {
  if (value != "MODULE" || current.find_first_of("/.") != std::string::npos) return std::nullopt;
  std::error_code error;
  const auto prefix = std::filesystem::read_symlink("/proc/self/exe", error).parent_path().parent_path();
  std::vector<std::filesystem::path> folders = {prefix / "lib/rtm-sim", prefix / "lib"};
  constexpr std::string_view key = "manager.modules.load_path:";
  for (const auto& word : before) {
    if (!word.starts_with(key)) continue;
    for (const auto& folder : base::split_list(word.substr(key.size()))) folders.emplace_back(folder);
  }
  std::set<std::string> names;
  for (const auto& folder : folders) {
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      if (const auto& file = entry.path();
          (file.extension() == ".so" || file.extension() == ".py") && !file.filename().string().starts_with("lib"))
        names.insert(file.stem().string());
    }
  }
  std::vector<base::Offer> offers;
  for (const auto& name : names) offers.push_back({name});
  return offers;
}

int fail(int code, const std::string& message) {
  std::cerr << "rtcd: " << message << '\n';
  return code;
}

// Takes the option out of the arguments if it is there.
bool take(std::vector<char*>& arguments, std::string_view option) {
  const auto at = std::find_if(arguments.begin() + 1, arguments.end(), [&](const char* a) { return option == a; });
  if (at == arguments.end()) return false;
  arguments.erase(at);
  return true;
}

// A name server without components waits for others to create them, and stays when the last one is deleted. An -o of the user's counts.
void stay(std::vector<char*>& arguments) {
  static char option[] = "-o", empty[] = "manager.shutdown_auto:NO", deleted[] = "manager.shutdown_on_nortcs:NO";
  arguments.insert(arguments.begin() + 1, {option, empty, option, deleted});
  std::cerr
      << "rtcd: no components on the command line: waiting for others to create them (rtse mgr create, rtm-studio); Ctrl+C or SIGTERM "
         "ends the program and its name server\n";
}

// Whoever may call the components may look for them.
bool is_open(const coil::Properties& properties) {
  const auto open_to = base::to_lower(properties.getProperty("corba.open_to"));
  return open_to == "host" || open_to == "network";
}

// What the command line and rtc.conf name, with the folders where it is looked for. False, and nothing else, when they are wrong: the
// manager says so.
struct Named {
  std::vector<std::string> modules, load_path;
};
std::optional<Named> read_named(std::vector<char*> arguments, const std::vector<std::string>& rest) {
  RTC::ManagerConfig config;
  if (!config.init(static_cast<int>(arguments.size()), arguments.data(), true)) return std::nullopt;
  coil::Properties properties;
  config.configure(properties);
  Named named{rest, {}};
  for (const auto* key : {"manager.modules.preload", "manager.components.precreate"})
    for (const auto& module : base::split_list(properties.getProperty(key))) named.modules.push_back(module);
  for (const auto* key : {"manager.modules.load_path", "manager.modules.Python.load_paths"})
    for (const auto& folder : base::split_list(properties.getProperty(key))) named.load_path.push_back(folder);
  return named;
}

// The words that are no modules, for the host of Python.
std::vector<std::string> without(const std::vector<char*>& arguments, std::vector<std::string> rest) {
  std::vector<std::string> options;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const auto at = std::find(rest.begin(), rest.end(), arguments[i]);
    if (at == rest.end())
      options.emplace_back(arguments[i]);
    else
      rest.erase(at);
  }
  return options;
}

int host(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  if (arguments.size() > 1 && std::string_view(arguments[1]) == "--complete") {
    Description description;
    return base::parse_command_line(description.app, "rtcd", argc, argv, modules_offered).value_or(0);
  }
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::string_view word = arguments[i];
    if (word != "--help" && word != "-h" && word != "--version" && word != "--man" && !word.starts_with("--completion")) continue;
    Description description;
    const bool has_value = word == "--completion" && i + 1 < arguments.size();
    const char* words[] = {"rtcd", arguments[i], has_value ? arguments[i + 1] : nullptr};
    return base::parse_command_line(description.app, "rtcd", has_value ? 3 : 2, words).value_or(0);
  }
  const bool with_naming = take(arguments, "--with-naming");
  const auto parsed = rt::parse_manager_arguments(std::vector<std::string>(arguments.begin() + 1, arguments.end()));
  if (!parsed) return fail(2, parsed.error().message);

  if (const auto named = read_named(arguments, parsed->rest); named && is_for_python(named->modules, named->load_path)) {
    if (with_naming)
      return fail(2, "--with-naming does not go with modules of Python: start the name server by another rtcd --with-naming");
    return fail(1, become_python(without(arguments, parsed->rest), parsed->rest));
  }

  std::unique_ptr<NameService> name_service;
  if (with_naming) {
    if (parsed->rest.empty()) stay(arguments);
    RTC::ManagerConfig config;
    if (!config.init(static_cast<int>(arguments.size()), arguments.data(), true)) return fail(config.exitCode(), config.error());
    coil::Properties properties;
    config.configure(properties);
    const auto servers = base::split_list(properties.getProperty("corba.nameservers"));
    auto started = NameService::start_if_none(servers.empty() ? "localhost" : servers.front(), is_open(properties));
    if (!started) return fail(1, started.error().message);
    name_service = std::move(*started);
  }

  const int count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  auto* manager = RTC::Manager::init(count, arguments.data(), {.strict_arguments = true, .bind_manager = true, .modules = parsed->rest});
  if (!manager->activateManager()) {
    const bool was_told_to_end = !manager->isRunning();
    manager->shutdown();
    return was_told_to_end ? 0 : fail(1, "not everything on the command line could be created");
  }
  manager->runManager();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return base::is_prefork_server(argc, argv) ? base::make_processes(host) : host(argc, argv);
  } catch (const std::system_error& e) {
    fail(1, std::string("out of system resources (threads or files): ") + e.what());
  } catch (const std::bad_alloc&) {
    fail(1, "out of memory");
  }
  std::_Exit(1);  // what has been started cannot be ended in order
}
