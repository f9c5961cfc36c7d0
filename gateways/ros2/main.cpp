// ros2-gateway: shows the robots of a simulation to ROS 2 as nodes. See --help.
#include <signal.h>

#include <cstdlib>
#include <iostream>

#include "base/command_line.h"
#include "base/log.h"
#include "base/terminal.h"
#include "base/text.h"
#include "gateway.h"
#include "served.h"
#include "supervisor.h"

namespace {

void block_end_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
}

int end_with(const base::Error& error, int code = 1) {
  std::cerr << base::for_terminal("ros2-gateway: " + error.message + "\n");
  return code;
}

// As typed, before it is checked.
struct Typed {
  std::string network = "host", distro = "auto", on_timeout = "fail", config;
  std::uint32_t domain = 0;
  double command_timeout = 0.5, wait_timeout = 10;
  std::vector<std::string> waits;
  bool has_no_clock = false, has_no_joint_tf = false, has_no_parameters = false, is_table_asked = false;
};

void add_options(base::Command& app, ros2::Options& options, Typed& typed) {
  app.add_option("-s,--server-id", options.server_id, "Simulator ID")
      ->check(base::integer_between(0, 9999))
      ->envname("RTMSIM_SERVER_ID")
      ->capture_default_str();
  app.add_option("--domain", typed.domain, "DDS domain")
      ->check(base::integer_between(0, 232))
      ->envname("ROS_DOMAIN_ID")
      ->capture_default_str();
  app.add_option("--network", typed.network,
                 "Reach: host (participants of this computer), lan (multicast on all interfaces), loopback (127.0.0.1 alone)")
      ->check(base::one_of({"host", "lan", "loopback"}))
      ->capture_default_str();
  app.add_option("--distro", typed.distro,
                 "Distribution of the nodes in the domain: auto (that of the first one), humble, jazzy (Iron and later)")
      ->check(base::one_of({"auto", "humble", "jazzy"}))
      ->capture_default_str();
  app.add_option("--root", options.naming.root_robot, "Robot whose topics and frames have no namespace: /scan, odom");
  app.add_flag("--tf-per-robot", options.naming.has_tf_per_robot)
      ->description("Send the frames of each robot on its own tf topic, without prefix");
  app.add_flag("--one-node", options.naming.is_one_node)->description("Show all robots as one node");
  app.add_option("--config", typed.config, "Mapping file: names, frames, rates and QoS (docs/ros2.md)");
  app.add_option("--service-prefix", options.service_prefix, "Namespace of the simulation services (default: none)");
  app.add_option("--clock-rate", options.clock_rate, "Rate of /clock, and of ticks in lock step [Hz of simulated time]; 0: every step")
      ->capture_default_str();
  app.add_flag("--no-clock", typed.has_no_clock)->description("Do not publish /clock");
  app.add_flag("--no-joint-tf", typed.has_no_joint_tf)->description("Leave the frames of links to robot_state_publisher");
  app.add_flag("--no-parameters", typed.has_no_parameters)->description("Do not serve the parameters of the nodes");
  app.add_option("--command-timeout", typed.command_timeout, "Simulated seconds after which a drive without a new command stops; 0: never")
      ->capture_default_str();
  app.add_flag("--lockstep", options.is_lockstep)->description("Participate in the lock step: simulated time waits for the gateway");
  app.add_option("--wait-for", typed.waits, "With --lockstep: TOPIC=RATE, a command that simulated time waits for, as in cmd_vel=20Hz");
  app.add_option("--wait-timeout", typed.wait_timeout, "Seconds of real time to wait for a command")->capture_default_str();
  app.add_option("--on-timeout", typed.on_timeout,
                 "After --wait-timeout: hold (keep the last command), stop (pause the simulation), fail (exit)")
      ->check(base::one_of({"hold", "stop", "fail"}))
      ->capture_default_str();
  app.add_flag("--interfaces", typed.is_table_asked)->description("Print the tables of topics and services (Markdown), and exit");
}

std::chrono::nanoseconds nanoseconds_of(double seconds) { return std::chrono::nanoseconds(std::llround(seconds * 1e9)); }

base::Result<void> complete(ros2::Options& options, const Typed& typed, bool is_config_typed, bool is_domain_typed, bool is_rate_typed) {
  if (is_config_typed) {
    auto naming = ros2::read_naming(typed.config);
    if (!naming) return naming.error();
    naming->root_robot = options.naming.root_robot;
    naming->has_tf_per_robot = options.naming.has_tf_per_robot;
    naming->is_one_node = options.naming.is_one_node;
    options.naming = std::move(*naming);
  }
  options.dds.domain = is_domain_typed ? typed.domain : options.naming.domain.value_or(typed.domain);
  if (!is_rate_typed) options.clock_rate = options.naming.clock_rate.value_or(options.clock_rate);
  const auto wrong = [](const std::string& rule, double value) { return base::Error{rule + ", got " + base::format_number(value)}; };
  if (!(options.clock_rate >= 0 && options.clock_rate <= 10000))
    return wrong("--clock-rate must be from 0 to 10000 Hz", options.clock_rate);
  if (!(typed.command_timeout >= 0 && typed.command_timeout <= 1e6))
    return wrong("--command-timeout must be from 0 to 1000000 s", typed.command_timeout);
  if (!(typed.wait_timeout > 0 && typed.wait_timeout <= 1e6))
    return wrong("--wait-timeout must be positive and at most 1000000 s", typed.wait_timeout);
  if (!options.service_prefix.empty()) {
    if (options.service_prefix.front() != '/') options.service_prefix = "/" + options.service_prefix;
    if (const auto problem = ros2::problem_of_name(options.service_prefix)) return base::Error{"--service-prefix " + *problem};
  }
  options.dds.network = ros2::network_of(typed.network).value_or(ros2::Network::host);
  options.family = ros2::family_of(typed.distro);
  options.on_timeout = typed.on_timeout == "hold"   ? ros2::OnTimeout::hold
                       : typed.on_timeout == "stop" ? ros2::OnTimeout::stop
                                                    : ros2::OnTimeout::fail;
  options.command_timeout = nanoseconds_of(typed.command_timeout);
  options.wait_timeout = nanoseconds_of(typed.wait_timeout);
  options.has_clock = !typed.has_no_clock;
  options.has_joint_tf = !typed.has_no_joint_tf;
  options.has_parameters = !typed.has_no_parameters;
  for (const auto& text : typed.waits) {
    auto wait = ros2::parse_wait_for(text);
    if (!wait) return base::Error{"--wait-for: " + wait.error().message};
    options.waits.push_back(std::move(*wait));
  }
  if (!options.waits.empty() && !options.is_lockstep) return base::Error{"--wait-for needs --lockstep"};
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  base::Command app{
      "ros2-gateway: show the robots of a simulation to ROS 2 as nodes\nSpeaks DDS as ROS 2 does; nothing of ROS is needed. Prints a line "
      "for "
      "each node."};
  base::add_standard_options(app, "ros2-gateway", RTMSIM_VERSION);
  ros2::Options options;
  Typed typed;
  add_options(app, options, typed);
  if (const auto end = base::parse_command_line(app, "ros2-gateway", argc, argv)) return *end;
  if (typed.is_table_asked) {
    std::cout << ros2::interface_tables();
    return 0;
  }
  const bool is_domain_typed = app.count("--domain") > 0 || std::getenv("ROS_DOMAIN_ID") != nullptr;
  if (auto done = complete(options, typed, app.count("--config") > 0, is_domain_typed, app.count("--clock-rate") > 0); !done)
    return end_with(done.error(), 2);
  block_end_signals();
  return ros2::supervise([&] {
    try {
      ros2::Gateway gateway(options);
      if (const auto done = gateway.run(); !done) return end_with(done.error());
    } catch (const std::exception& e) {
      return end_with({std::string("out of system resources (threads or files): ") + e.what()});
    }
    return 0;
  });
}
