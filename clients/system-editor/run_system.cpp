#include "run_system.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>
#include <thread>

#include "base/id.h"
#include "base/text.h"
#include "child_process.h"
#include "tap.h"
#include "value_codec.h"

namespace editor {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto start_limit = 30s;
constexpr auto call_limit = 5s;
// A simulated second may take long on a loaded machine with many robots; a hang is what this finds.
constexpr auto step_limit = 300s;

std::atomic<bool> interrupted{false};
void interrupt(int) { interrupted.store(true, std::memory_order_relaxed); }

// A folder for the run's files, gone at the end unless it is to be kept.
class Workplace {
 public:
  explicit Workplace(const std::string& keep)
      : path_(keep.empty() ? std::filesystem::temp_directory_path() / ("rtse-run-" + base::make_uuid()) : std::filesystem::path(keep)),
        keep_(!keep.empty()) {
    std::filesystem::create_directories(path_);
  }
  ~Workplace() {
    std::error_code ignored;  // a file that cannot be removed from the temporary folder is no failure of the run
    if (!keep_) std::filesystem::remove_all(path_, ignored);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
  bool keep_;
};

// A port of the loopback that nobody listens on just now.
int free_port() {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  int port = 0;
  if (bind(listener, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
      getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) == 0)
    port = ntohs(address.sin_port);
  close(listener);
  return port;
}

std::string last_line(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  const auto lines = base::split_list(text.str(), '\n');
  return lines.empty() ? "it said nothing" : lines.back();
}

// Everything of one run. Its end takes the processes down, the components before the simulator before the naming service.
class Run {
 public:
  Run(CORBA::ORB_ptr orb, const RunOptions& options) : orb_(CORBA::ORB::_duplicate(orb)), options_(options), place_(options.keep) {}

  Result<RunResult> go() {
    auto system = read_system(options_.system);
    if (!system) return system.error();
    system_ = std::move(*system);
    if (!options_.expectations.empty()) {
      auto expectations = read_expectations(options_.expectations);
      if (!expectations) return expectations.error();
      expectations_ = std::move(*expectations);
    }
    const auto began = Clock::now();
    for (auto step : {&Run::start_naming, &Run::start_simulator, &Run::start_hosts, &Run::wire, &Run::listen, &Run::drive, &Run::look}) {
      if (const auto done = (this->*step)(); !done) return done.error();
    }
    stop();
    auto record = read_record(place_.file("record.txt"));
    if (!record) return record.error();
    seen_.record = std::move(*record);
    run_commands();
    result_.verdicts = judge(expectations_, seen_);
    for (const auto& [model, poses] : seen_.record.poses) result_.path_m = std::max(result_.path_m, path_length(poses));
    result_.wall_s = std::chrono::duration<double>(Clock::now() - began).count();
    return result_;
  }

 private:
  Result<void> fail(const std::string& what) const { return Error{what}; }

  // Waits until `ready`, a child ends, an interrupt comes, or time is up.
  Result<void> wait_until(const std::string& what, const std::function<bool()>& ready) {
    const auto deadline = Clock::now() + start_limit;
    while (!ready()) {
      if (interrupted.load(std::memory_order_relaxed)) return fail("run: interrupted");
      if (const auto alive = check_children(); !alive) return alive;
      if (Clock::now() > deadline) return fail(what + ": not ready after " + std::to_string(start_limit.count()) + " s");
      std::this_thread::sleep_for(20ms);  // what is waited for is another program's start, which nobody announces
    }
    return {};
  }

  Result<void> check_children() {
    if (naming_ && naming_->is_running() == false) return fail("omniNames ended: " + last_line(place_.file("omninames.log")));
    if (simulator_ && simulator_->is_running() == false) return fail("sim-server ended: " + last_line(place_.file("sim-server.log")));
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
      if (!hosts_[i].is_running()) return fail("component host ended: " + last_line(place_.file("rtcd-" + std::to_string(i) + ".log")));
    }
    return {};
  }

  Result<void> start_naming() {
    const int port = free_port();
    if (port == 0) return fail("no free port on 127.0.0.1");
    server_ = "127.0.0.1:" + std::to_string(port);
    std::filesystem::remove_all(place_.file("names"));  // of an earlier run that was kept
    std::filesystem::create_directories(place_.file("names"));
    auto started = ChildProcess::start({{"omniNames", "-start", std::to_string(port), "-datadir", place_.file("names"), "-errlog",
                                         place_.file("omninames.err"), "-ORBendPoint", "giop:tcp:127.0.0.1:" + std::to_string(port)},
                                        {},
                                        place_.file("omninames.log")});
    if (!started) return started.error();
    naming_.emplace(std::move(*started));
    return wait_until("naming service", [&] { return NamingTree::read(orb_, server_, 1000ms).ok(); });
  }

  // Ids below a thousand are for people.
  static std::string pick_server_id() {
    static std::atomic<unsigned> next{0};
    return std::to_string(1000 + (static_cast<unsigned>(getpid()) * 7 + next.fetch_add(1)) % 9000);
  }

  Result<void> start_simulator() {
    server_id_ = pick_server_id();
    ProgramCall call{{own_program("sim-server"), options_.world, "--server-id", server_id_, "--paused", "--lockstep", "--rtf",
                      options_.in_real_time ? "1" : "0", "--seed", std::to_string(options_.seed), "--record", place_.file("record.txt")},
                     {},
                     place_.file("sim-server.log")};
    for (const auto& path : options_.resource_paths) call.words.insert(call.words.end(), {"--resource-path", path});
    auto started = ChildProcess::start(call);
    if (!started) return started.error();
    simulator_.emplace(std::move(*started));
    return wait_until("simulator", [&] {
      const auto stats = simctl({"--json", "stats"});
      if (!stats) return false;
      const auto json = Json::parse(*stats, nullptr, false);
      step_s_ = json.is_object() ? json.value("step", 0.0) : 0.0;
      return step_s_ > 0;
    });
  }

  Result<std::string> simctl(const std::vector<std::string>& words, std::chrono::milliseconds limit = call_limit) const {
    ProgramCall call{{own_program("simctl"), "-s", server_id_}, {}, ""};
    call.words.insert(call.words.end(), words.begin(), words.end());
    return output_of(call, limit);
  }

  // "Type?instance_name=...&..." as managers create components.
  static std::string creation(const SavedComponent& component) {
    const auto parts = base::split_list(component.id, ':');
    const auto type = parts.size() >= 4 ? parts[3] : component.instance;
    auto text = type + "?instance_name=" + component.instance;
    if (!component.contexts.empty()) text += "&exec_cxt.periodic.rate=" + component.contexts.front().rate;
    return text;
  }

  Result<void> start_host(const std::vector<const SavedComponent*>& components) {
    const auto libraries = std::filesystem::path(own_program("rtcd")).parent_path().parent_path() / "lib";
    auto paths = options_.module_paths;
    paths.push_back(libraries.string());
    paths.push_back((libraries / "rtm-sim").string());
    const auto set = [](const std::string& key, const std::string& value) { return key + ":" + value; };
    ProgramCall call{
        {own_program("rtcd")}, {{"RTMSIM_SERVER_ID", server_id_}}, place_.file("rtcd-" + std::to_string(hosts_.size()) + ".log")};
    for (const auto& option :
         {set("corba.nameservers", server_), set("manager.modules.load_path", base::join(paths, ",")),
          set("manager.modules.preload", "SimTimeContext.so"), set("exec_cxt.periodic.type", "SimTimeContext"),
          set("manager.shutdown_auto", "NO"), set("manager.shutdown_on_nortcs", "NO"), set("logger.log_level", "INFO")}) {
      call.words.insert(call.words.end(), {"-o", option});
    }
    for (const auto* component : components) call.words.push_back(creation(*component));
    auto started = ChildProcess::start(call);
    if (!started) return started.error();
    hosts_.push_back(std::move(*started));
    return {};
  }

  Result<void> start_hosts() {
    std::vector<const SavedComponent*> all;
    for (const auto& component : system_.components) all.push_back(&component);
    if (all.empty()) return fail("system " + options_.system + ": has no components");
    if (!options_.one_process_each) {
      if (const auto started = start_host(all); !started) return started;
    } else {
      for (const auto* component : all) {
        if (const auto started = start_host({component}); !started) return started;
      }
    }
    std::string missing;
    auto waited = wait_until("components", [&] {
      const auto names = NamingTree::read(orb_, server_, 1000ms);
      if (!names) return false;
      missing.clear();
      for (const auto& component : system_.components) {
        if (!names->find_component({false, {component.instance + ".rtc"}, ""})) missing = component.instance;
      }
      return missing.empty();
    });
    if (!waited && !missing.empty())
      return fail(waited.error().message + "; " + missing + " is missing: " + last_line(place_.file("rtcd-0.log")));
    return waited;
  }

  // The profile as it is for this run: the simulator has an id of its own.
  Result<void> wire() {
    for (auto& component : system_.components) {
      for (auto& set : component.configuration_sets) {
        for (auto& [key, value] : set.values) {
          if (key == "server_id") value = server_id_;
        }
      }
    }
    const auto file = place_.file("system.xml");
    if (const auto written = write_system(system_, file); !written) return written;
    editor_.emplace(orb_, server_, false, std::chrono::milliseconds(call_limit));
    load(*editor_, file, false);
    if (!editor_->failed()) start(*editor_, file, false);
    if (editor_->failed()) return fail("system " + options_.system + ": could not be wired and activated; " + logs());
    return {};
  }

  std::string logs() const {
    std::string text;
    for (std::size_t i = 0; i < hosts_.size(); ++i)
      text += (i ? "; " : "last words of the hosts: ") + last_line(place_.file("rtcd-" + std::to_string(i) + ".log"));
    return text;
  }

  // Taps on the ports whose values are judged.
  Result<void> listen() {
    for (const auto& expectation : expectations_) {
      if (expectation.kind != Expectation::Kind::value) continue;
      auto port = editor_->port(expectation.port);
      if (!port) return port.error();
      const auto type = type_code_of(port->port.data_type());
      if (CORBA::is_nil(type))
        return fail("port " + expectation.port + ": carries " + port->port.data_type() + ", which rtse does not know");
      const auto key = expectation.port + " " + expectation.member;
      nlohmann::json::json_pointer pointer("/" + replaced(expectation.member));
      auto tap = Tap::connect(
          orb_, port->port, {{"dataport.allow_dup_connection", "YES"}},
          [this, type, key, pointer](std::span<const unsigned char> payload, bool little) { take(type, key, pointer, payload, little); });
      if (!tap) return tap.error();
      taps_.push_back(std::move(*tap));
    }
    return {};
  }

  static std::string replaced(std::string member) {
    std::replace(member.begin(), member.end(), '.', '/');
    return member;
  }

  void take(CORBA::TypeCode_ptr type, const std::string& key, const nlohmann::json::json_pointer& pointer,
            std::span<const unsigned char> payload, bool little) {
    const auto value = decode(type, payload, little);
    if (!value) return;
    const Json json = *value;
    if (!json.contains(pointer) || !json[pointer].is_number()) return;
    const double number = json[pointer].get<double>();
    const std::scoped_lock lock(mutex_);
    auto& seen = seen_.values[key];
    seen.lowest = seen.samples ? std::min(seen.lowest, number) : number;
    seen.highest = seen.samples ? std::max(seen.highest, number) : number;
    ++seen.samples;
  }

  Result<void> drive() {
    auto left = static_cast<std::int64_t>(std::llround(options_.duration_s / step_s_));
    const auto second = std::max<std::int64_t>(1, std::llround(1 / step_s_));
    const bool shows = !options_.quiet && isatty(2);
    for (std::int64_t done = 0; left > 0;) {
      if (interrupted.load(std::memory_order_relaxed)) return fail("run: interrupted");
      const auto steps = std::min(left, second);
      if (const auto stepped = simctl({"step", std::to_string(steps)}, step_limit); !stepped) {
        if (const auto alive = check_children(); !alive) return alive;
        return stepped.error();
      }
      left -= steps;
      done += steps;
      if (shows) std::fprintf(stderr, "\r%6.1f of %.1f s", static_cast<double>(done) * step_s_, options_.duration_s);
    }
    if (shows) std::fprintf(stderr, "\r                         \r");
    result_.simulated_s = options_.duration_s;
    return check_children();
  }

  // What can be seen only while everything still runs.
  Result<void> look() {
    taps_.clear();
    const auto stats = simctl({"--json", "stats"});
    if (!stats) return stats.error();
    const auto json = Json::parse(*stats, nullptr, false);
    if (json.is_object() && json.contains("hash"))
      result_.state_hash = json["hash"].is_string() ? json["hash"].get<std::string>() : json["hash"].dump();
    if (!options_.picture.empty()) {
      const auto file = std::filesystem::absolute(options_.picture).string();
      if (const auto drawn = simctl({"screenshot", file, "--top", "--scans", "--size", "900x900"}, 60s); !drawn) return drawn.error();
    }
    for (const auto& component : system_.components) {
      const auto view = editor_->component(component.instance + ".rtc", {.contexts = true});
      seen_.states[component.instance] = view ? state_text(view->state()) : "gone";
    }
    return {};
  }

  // Ends components first, so that they can say good-bye to the naming service.
  void stop() {
    for (auto& host : hosts_) host.terminate();
    hosts_.clear();
    simulator_.reset();
    naming_.reset();
  }

  void run_commands() {
    for (const auto& expectation : expectations_) {
      if (expectation.kind != Expectation::Kind::command) continue;
      auto started = ChildProcess::start(
          {{"sh", "-c", expectation.command},
           {{"RTMSIM_RECORD", place_.file("record.txt")}, {"RTMSIM_SERVER_ID", server_id_}, {"RTCTREE_NAMESERVERS", server_}},
           place_.file("command.log")});
      if (!started) continue;
      if (started->wait(60s)) seen_.exit_codes[expectation.command] = started->exit_code();
    }
  }

  CORBA::ORB_var orb_;
  const RunOptions& options_;
  Workplace place_;
  SavedSystem system_;
  std::vector<Expectation> expectations_;
  std::string server_;
  std::string server_id_;
  double step_s_ = 0;
  Seen seen_;
  std::mutex mutex_;  // of seen_.values
  RunResult result_;
  std::optional<ChildProcess> naming_;
  std::optional<ChildProcess> simulator_;
  std::vector<ChildProcess> hosts_;
  std::optional<Editor> editor_;
  std::vector<std::unique_ptr<Tap>> taps_;
};

}  // namespace

bool RunResult::is_passed() const {
  return std::all_of(verdicts.begin(), verdicts.end(), [](const Verdict& verdict) { return verdict.problem.empty(); });
}

Result<RunResult> run_system(CORBA::ORB_ptr orb, const RunOptions& options) {
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  return Run(orb, options).go();
}

Result<void> write_junit(const std::string& file, const RunOptions& options, const std::vector<RunResult>& results) {
  pugi::xml_document document;
  auto suite = document.append_child("testsuite");
  suite.append_attribute("name") = std::filesystem::path(options.system).stem().c_str();
  int tests = 0;
  int failures = 0;
  double time = 0;
  for (const auto& result : results) {
    for (const auto& verdict : result.verdicts) {
      auto test = suite.append_child("testcase");
      test.append_attribute("classname") = std::filesystem::path(options.world).stem().c_str();
      test.append_attribute("name") = verdict.expectation.c_str();
      ++tests;
      if (verdict.problem.empty()) continue;
      test.append_child("failure").append_attribute("message") = verdict.problem.c_str();
      ++failures;
    }
    time += result.wall_s;
  }
  suite.append_attribute("tests") = tests;
  suite.append_attribute("failures") = failures;
  suite.append_attribute("time") = time;
  if (!document.save_file(file.c_str(), "  ")) return Error{"file " + base::in_quotes(file) + ": cannot be written"};
  return {};
}

}  // namespace editor
