// player-gateway: lets clients of Player drive the robots of a simulation. See --help.
#include <signal.h>

#include <iostream>

#include "base/command_line.h"
#include "base/log.h"
#include "base/terminal.h"
#include "device_kinds.h"
#include "gateway.h"

namespace {

// Before any thread is started, so that none of them gets the signals.
void block_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
}

const base::Check is_key{[](const std::string& text) {
                           return text.empty() || text.size() > gateway::AccessPolicy::max_key
                                      ? "key must have 1 to " + std::to_string(gateway::AccessPolicy::max_key) + " characters"
                                      : std::string();
                         },
                         "KEY"};

int fail(const base::Error& error, int code = 1) {
  std::cerr << base::for_terminal("player-gateway: " + error.message + "\n");
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  base::Command app{
      "player-gateway: let clients of Player drive the robots of a simulation\nServes the TCP protocol of Player 3.1: each robot of the "
      "world on "
      "a port of its own, or what a mapping file says. Prints a line for each port."};
  base::add_standard_options(app, "player-gateway", RTMSIM_VERSION);
  gateway::Options options;
  std::string config;
  bool is_quiet = false;
  app.add_option("-s,--server-id", options.server_id, "Simulator ID")
      ->check(base::integer_between(0, 9999))
      ->envname("RTMSIM_SERVER_ID")
      ->capture_default_str();
  auto* port = app.add_option("-p,--port", options.first_port, "Port of the first robot; the others get the next ports; 0: any free ports")
                   ->check(base::integer_between(0, 65535))
                   ->capture_default_str();
  app.add_option("--address", options.address, "Address to listen on; 0.0.0.0: all")->capture_default_str();
  app.add_option("--auth", options.access.key,
                 "Also serve clients of other accounts and hosts that send this key (Player's authentication request)")
      ->check(is_key)
      ->envname("RTMSIM_PLAYER_AUTH");
  app.add_flag("--open", options.access.is_open)->description("Accept every client that reaches the ports, without a key");
  app.add_option("--config", config, "Mapping file, or a configuration file of Player: devices of each port (docs/player.md)")
      ->check(base::existing_file())
      ->excludes(port);
  app.add_flag("-q,--quiet", is_quiet)->description("Do not log clients that send bytes of another protocol");
  bool is_table_asked = false;
  app.add_flag("--interfaces", is_table_asked)->description("Print the table of supported Player interfaces (Markdown), and exit");
  if (const auto end = base::parse_command_line(app, "player-gateway", argc, argv)) return *end;
  if (is_table_asked) {
    std::cout << gateway::interface_table();
    return 0;
  }
  if (is_quiet) base::set_log_level(base::Level::warn);
  if (!config.empty()) {
    auto ports = gateway::read_config(config);
    if (!ports) return fail(ports.error(), 2);
    options.config = std::move(*ports);
  }
  block_signals();
  try {
    gateway::Gateway gateway(std::move(options));
    if (const auto done = gateway.run(); !done) return fail(done.error());
  } catch (const std::exception& e) {
    return fail({std::string("out of system resources (threads or files): ") + e.what()});
  }
  return 0;
}
