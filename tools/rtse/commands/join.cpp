// join, leave: components that run already, of any maker, take part in the simulated time of a simulator.
//
// The contexts in which they are called live in a host of their own, an rtcd that outlives this command and ends with the last proxy in it.
// A proxy goes by `leave`, and by itself when its component has gone.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/command_line.h"
#include "base/output_name.h"
#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "run/time_members.h"
#include "shm/client.h"
#include "shm/lockstep.h"

namespace tools {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto start_limit = 30s;
constexpr auto join_limit = 70s;  // the context waits for a minute, and says then that nobody has answered
constexpr auto participant_limit = 10s;
constexpr int highest_server = 9999;
// [s]; a proxy that has nobody to serve any more ends after so long, whether somebody says `leave` or not.
const std::string alone_limit = "&sim_time_proxy.alone_limit=10";

struct JoinOptions {
  std::vector<std::string> components;
  int phase = 1, turn = 0;
  double rate = 0;  // [Hz]; 0: that of the component's own context
  std::string server_id;
  bool ticks = false;  // its own context instead
  std::string log;
  std::vector<std::string> options;  // of the host
};

// A program that belongs to nobody: it goes on when we end.
class ProgramApart {
 public:
  // `log`: a file; empty: what it says at first is kept for said().
  static Result<ProgramApart> start(const std::vector<std::string>& words, const std::string& log) {
    const int output = log.empty() ? memfd_create("output", MFD_CLOEXEC) : open(log.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (output < 0) return Error{"log file " + base::in_quotes(log) + ": cannot be written"};
    std::vector<char*> arguments;
    for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const pid_t pid = fork();
    if (pid == 0) {
      setsid();
      dup2(open("/dev/null", O_RDONLY), 0);
      dup2(output, 1);
      dup2(output, 2);
      close_range(3, ~0U, 0);
      execvp(arguments[0], arguments.data());
      _exit(127);
    }
    if (pid < 0) return Error{"program " + words[0] + ": no process can be made"};
    return ProgramApart(pid, output);
  }

  bool has_ended() const { return waitpid(pid_, nullptr, WNOHANG) == pid_; }
  // The last line.
  std::string said() const {
    std::string text(4096, '\0');
    const auto size = lseek(output_, 0, SEEK_END);
    const auto from = std::max<off_t>(0, size - static_cast<off_t>(text.size()));
    const auto count = pread(output_, text.data(), text.size(), from);
    text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    const auto lines = base::split_list(text, '\n');
    return lines.empty() ? "its log is empty" : lines.back();
  }

 private:
  ProgramApart(pid_t pid, int output) : pid_(pid), output_(output) {}
  pid_t pid_;
  int output_;  // until we end
};

struct Joining {
  std::string path;
  TimeMember member;
};

Result<Joining> look_at(const Session& session, Console& console, const std::string& path, const JoinOptions& options) {
  const auto component = session.component(path, {.contexts = true});
  if (!component) return component.error();
  if (simulated_context(*component))
    return Error{"component " + component->path + ": already participates in simulated time (rtse leave ends that)"};
  if (has_proxy(session, component->instance))
    return Error{"component " + component->path + ": its own context is ticked in simulated time already (rtse leave)"};
  auto rate = options.rate;
  for (const auto& context : component->contexts) {
    if (rate == 0 && context.is_owned) rate = context.rate;
  }
  if (!(rate > 0)) return Error{"component " + component->path + ": has no context with a rate to take over; name one with --rate"};
  const auto how = options.ticks ? TimeMember::How::tick : TimeMember::How::member;
  if (options.ticks && ticks_on_its_own(*component))
    console.warn("component " + component->path +
                 ": its context, an ExtTrigExecutionContext, runs it after each tick on a thread of its own, for which nothing can wait; "
                 "join it as a member (without --tick)");
  return Joining{component->path, {component->instance, options.phase, base::format_number(rate), how, options.turn}};
}

Result<void> await_proxies(const Session& session, const ProgramApart& host, const std::vector<Joining>& all) {
  const auto deadline = Clock::now() + start_limit;
  for (const auto& one : all) {
    for (;;) {
      const auto names = session.tree();
      if (names && names->find_component({false, {proxy_name(one.member.instance) + ".rtc"}, ""})) break;
      if (host.has_ended()) return Error{"host of the contexts on simulated time: has ended: " + host.said()};
      if (Clock::now() > deadline)
        return Error{"component " + proxy_name(one.member.instance) + ": is not there after " + std::to_string(start_limit.count()) + " s"};
      std::this_thread::sleep_for(20ms);  // nobody announces the start of another program
    }
  }
  return {};
}

void end_proxy_of(const Session& session, const Joining& one) {
  const auto proxy = session.component(proxy_name(one.member.instance) + ".rtc", {});
  if (proxy) static_cast<void>(remote("proxy", [&] { proxy->object->exit(); }));
}

// From when on time waits for them; false when there is no such simulator.
bool await_participants(const std::vector<Joining>& all, const std::string& server_id) {
  const auto id = static_cast<std::uint32_t>(base::parse_integer(server_id).value_or(0));
  const auto deadline = Clock::now() + participant_limit;
  while (Clock::now() < deadline) {
    const auto simulation = shm::Iface::open(id, shm::IfaceType::simulation, "world");
    const auto participants = simulation ? shm::read_participants(*simulation) : Error{simulation.error()};
    if (!participants) return false;
    const auto takes_part = [&](const Joining& one) {
      return std::ranges::any_of(*participants, [&](const auto& participant) { return participant.name == one.member.instance; });
    };
    const auto found = static_cast<std::size_t>(std::ranges::count_if(all, takes_part));
    if (found >= all.size()) return true;
    std::this_thread::sleep_for(20ms);  // the simulator takes them in between two steps, and tells nobody
  }
  return false;
}

void join(const Session& session, Console& console, const JoinOptions& options) {
  std::vector<Joining> all;
  HostSettings settings{
      .naming = session.server(), .name = "time" + std::to_string(getpid()), .empty_file = "/dev/null", .options = options.options};
  for (const auto& path : options.components) {
    auto one = look_at(session, console, path, options);
    if (!one) return console.fail(one.error());
    settings.creations.push_back(proxy_creation(one->member, options.server_id) + alone_limit);
    all.push_back(std::move(*one));
  }
  const auto host = ProgramApart::start(host_words(settings), options.log);
  if (!host) return console.fail(host.error());
  if (const auto there = await_proxies(session, *host, all); !there) {
    for (const auto& one : all) end_proxy_of(session, one);
    return console.fail(there.error());
  }
  for (const auto& one : all) {
    if (const auto joined = join_time(session, one.path, proxy_name(one.member.instance) + ".rtc", one.member.how, join_limit); !joined) {
      end_proxy_of(session, one);
      console.fail(joined.error());
    }
  }
  if (console.failed()) return;
  const bool runs = await_participants(all, options.server_id);
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& one : all) {
    if (!console.json())
      std::cout << one.path << ": participates in simulator " << options.server_id << (runs ? "" : ", once that runs,") << " at "
                << one.member.rate << " Hz, phase " << one.member.phase << '\n';
    json.push_back({{"component", one.path},
                    {"server_id", options.server_id},
                    {"phase", one.member.phase},
                    {"rate", one.member.rate},
                    {"takes_part", runs}});
  }
  if (console.json()) console.print(json);
}

void leave(const Session& session, Console& console, const std::vector<std::string>& components) {
  for (const auto& path : components) {
    if (const auto left = leave_time(session, path); !left) console.fail(left.error());
  }
}

std::string usual_server() {
  const char* id = std::getenv("RTMSIM_SERVER_ID");
  return id && *id ? id : "0";
}

}  // namespace

void add_join(base::Command& app, Chosen& chosen) {
  auto* join = app.add_subcommand("join", "Add running components, of any maker, to the simulated time of a simulator");
  auto options = std::make_shared<JoinOptions>();
  options->server_id = usual_server();
  join->add_option("COMPONENT", options->components, "Components, in the order of their calls")->required();
  join->add_option("-p,--phase", options->phase, "Phase inside a tick: 0 sensors, 1 clients, 2 actuators")
      ->check(base::integer_between(0, highest_phase))
      ->capture_default_str();
  join->add_option("--turn", options->turn, "Call order within the phase; a reader needs a lower number than its senders")
      ->check(base::integer_between(0, highest_turn))
      ->capture_default_str();
  join->add_option("-r,--rate", options->rate, "Ticks per simulated second (default: rate of the component's own context)")
      ->check(base::number_between(1e-6, 1e6));
  join->add_option("-s,--server-id", options->server_id, "Simulator ID")
      ->check(base::integer_between(0, highest_server))
      ->capture_default_str();
  join->add_flag("--tick", options->ticks, "Tick the component's own context, which must be an externally triggered one");
  join->add_option("--log", options->log, "Log file of the context host")->check(base::output_name());
  join->add_option("-o,--option", options->options, "Key of rtc.conf for that host, KEY:VALUE, e.g. of corba.endpoints")
      ->allow_extra_args(false);
  join->callback([&chosen, options] {
    chosen.work = [options](const Session& session, Console& console) { tools::join(session, console, *options); };
  });

  auto* leave = app.add_subcommand("leave", "Undo join: components run in their own contexts again");
  auto components = std::make_shared<std::vector<std::string>>();
  leave->add_option("COMPONENT", *components, "Components")->required();
  leave->callback([&chosen, components] {
    chosen.work = [components](const Session& session, Console& console) { tools::leave(session, console, *components); };
  });
}

}  // namespace tools
