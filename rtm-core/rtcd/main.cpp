// rtcd: hosts components. See `rtcd --help`.
#include <rtm/Manager.h>
#include <rtm/ManagerConfig.h>
#include <rtm/version.h>

#include <algorithm>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "base/text.h"
#include "core/manager_arguments.h"
#include "name_service.h"

namespace {

constexpr const char* help = R"(rtcd - hosts RT components

usage: rtcd [options] [MODULE...]

  MODULE              a library, or its name in manager.modules.load_path: load it and create one component of each type in it;
                      Type?key=value&...: create a component, loading Type.so if need be

  -f FILE             read this file instead of $RTC_MANAGER_CONFIG, ./rtc.conf, /etc/rtc.conf, ...
  -i                  go on when the file of -f does not exist
  -o KEY:VALUE        set a key of rtc.conf, over the file (many)
  -p PORT             listen on this port (of the loopback interface)
  -d                  be the master manager: listen on the port of corba.master_manager, stay without components
  -a                  without the manager's own CORBA object
  --with-naming       start omniNames when the first of corba.nameservers does not answer, stop it at the end
  --help, --version

exit code: 0 ended as asked, 1 failed, 2 wrong command line
)";

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

}  // namespace

int main(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  if (take(arguments, "--help") || take(arguments, "-h")) {
    std::cout << help;
    return 0;
  }
  if (take(arguments, "--version")) {
    std::cout << "rtcd (rtm-sim), API of " << RTC::openrtm_name << '\n';
    return 0;
  }
  const bool with_naming = take(arguments, "--with-naming");
  const int count = static_cast<int>(arguments.size());
  const auto parsed = rt::parse_manager_arguments(std::vector<std::string>(arguments.begin() + 1, arguments.end()));
  if (!parsed) return fail(2, parsed.error().message);

  std::unique_ptr<NameService> name_service;
  if (with_naming) {
    RTC::ManagerConfig config;
    if (!config.init(count, arguments.data(), true)) return fail(config.exitCode(), config.error());
    coil::Properties properties;
    config.configure(properties);
    const auto servers = base::split_list(properties.getProperty("corba.nameservers"));
    auto started = NameService::start_if_none(servers.empty() ? "localhost" : servers.front());
    if (!started) return fail(1, started.error().message);
    name_service = std::move(*started);
  }

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
