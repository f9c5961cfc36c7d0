// sim-server: loads a world and runs it. See --help.
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <thread>

#include "base/command_line.h"
#include "base/guarded.h"
#include "base/log.h"
#include "base/output_name.h"
#include "base/prefork.h"
#include "base/terminal.h"
#include "base/text.h"
#include "base/whole_file.h"
#include "render/assets.h"
#include "render/scene.h"
#include "server/describe.h"
#include "server/server_loop.h"
#include "shm/segment.h"
#include "shm/specs.h"
#include "world/joint_gains.h"
#include "world/world_loader.h"

namespace {

struct Options {
  std::string world;
  std::uint32_t server_id = 0;
  bool is_paused = false, is_lockstep = false, ends_with_input = false, check = false, is_json = false, print_hash = false;
  double rtf = 1;
  std::uint32_t wait_for = 0;
  double participant_timeout = 0, duration = -1;
  std::optional<double> hash_period{};  // [s]
  std::uint64_t seed = 1;
  std::vector<std::string> resource_paths, faults, gains, spawned;
  std::string record, hash_log, shm_mode = "0600", shm_group, rolling = "on";
  std::uint64_t shm_limit = shm::ServerOptions::usual_most_bytes >> 20U;  // [MiB]
  int verbosity = 1, threads = 0;
};

// Where our own worlds and models are: installed beside the program, or in the source tree.
std::filesystem::path installed_worlds() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto beside = program.parent_path().parent_path() / "share" / "rtm-sim" / "worlds";
  return std::filesystem::is_directory(beside, error) ? beside : std::filesystem::path(RTMSIM_WORLDS_DIR);
}

// Names in a world must not control a terminal.
void print_line(const std::string& line) { std::fprintf(stderr, "%s\n", base::for_terminal(line).c_str()); }

int fail(const std::string& message) {
  print_line("sim-server: " + message);
  return 1;
}

// SIGINT, SIGTERM and SIGHUP, and with follow_input() the end of standard input, received by a thread of their own instead of a handler.
// They stop the loop after its step; before there is
// one, and when the step takes long or a second signal comes, they end the process at once.
class Signals {
 public:
  // Before any other thread is started this must exist.
  Signals() {
    sigemptyset(&set_);
    for (const int signal : {SIGINT, SIGTERM, SIGUSR2, SIGIO}) sigaddset(&set_, signal);
    struct sigaction hang_up {};
    sigaction(SIGHUP, nullptr, &hang_up);
    if (hang_up.sa_handler != SIG_IGN) sigaddset(&set_, SIGHUP);  // ignored: started by nohup
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
    thread_ = std::thread([this] {
      while (true) {
        int signal = 0;
        sigwait(&set_, &signal);
        if (signal == SIGIO && !is_input_closed()) continue;
        if (signal != SIGUSR2 && !is_over_.load(std::memory_order_acquire)) stop(signal);
        if (is_over_.load(std::memory_order_acquire)) return;  // pairs with the release in end
      }
    });
  }
  // From now on the process ends when standard input, a pipe, has no writer any more. False: it is no pipe.
  bool follow_input() {
    struct stat input {};
    if (fstat(STDIN_FILENO, &input) != 0 || !S_ISFIFO(input.st_mode)) return false;
    fcntl(STDIN_FILENO, F_SETOWN, getpid());
    fcntl(STDIN_FILENO, F_SETFL, fcntl(STDIN_FILENO, F_GETFL) | O_ASYNC);
    kill(getpid(), SIGIO);  // it may have ended before
    return true;
  }
  void watch(sim::ServerLoop* loop) { *loop_.lock() = loop; }
  void end() {
    if (!thread_.joinable()) return;
    is_over_.store(true, std::memory_order_release);  // pairs with the acquire in the thread
    pthread_kill(thread_.native_handle(), SIGUSR2);
    thread_.join();
  }
  ~Signals() { end(); }

 private:
  void stop(int signal) {
    constexpr timespec timeout{2, 0};
    bool has_loop = false;
    {
      auto loop = loop_.lock();
      has_loop = *loop != nullptr;
      if (has_loop) (*loop)->stop();
    }
    if (!has_loop) end_process(signal);
    const int next = sigtimedwait(&set_, nullptr, &timeout);
    if (is_over_.load(std::memory_order_acquire)) return;  // pairs with the release in end
    if (next < 0) std::fprintf(stderr, "sim-server: ended in the middle of a step, which takes more than %ld s\n", timeout.tv_sec);
    end_process(signal);
  }
  static bool is_input_closed() {
    pollfd input{STDIN_FILENO, 0, 0};
    return poll(&input, 1, 0) > 0 && (input.revents & POLLHUP) != 0;
  }
  [[noreturn]] static void end_process(int signal) {
    shm::remove_own();
    std::_Exit(128 + signal);
  }

  sigset_t set_;
  base::Guarded<sim::ServerLoop*, base::Rank::manager> loop_{nullptr};
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

// Those of the files that the user has named, in the order of the names.
base::Result<void> add_named_gains(const std::vector<std::string>& files, sim::WorldDef& world) {
  for (const auto& file : files) {
    std::vector<std::string> left_out;
    auto gains = sim::read_gains(file, left_out);
    if (!gains) return gains.error();
    for (const auto& line : left_out) print_line(line);
    for (auto& one : *gains) one.is_named = true;
    std::size_t count = 0;
    for (auto& model : world.models) count += sim::add_gains(*gains, model);
    if (count == 0) return base::Error{"gains " + base::in_quotes(file) + ": " + sim::why_no_gains(*gains, left_out, "the world")};
    for (const auto& line : sim::gains_of_no_joint(*gains, world.models, "the world")) print_line(line);
  }
  return {};
}

int reject(const std::string& message) {
  fail(message);
  return 2;
}

int run(const Options& options, Signals& signals) {
  using namespace sim;
  auto access = shm::parse_access(options.shm_mode, options.shm_group);
  if (!access) return reject(access.error().message);
  const ModelPath model_path = ModelPath::from_environment(options.resource_paths, installed_worlds());
  for (const auto& file : {options.hash_log, options.record}) {
    if (const auto writable = file.empty() ? base::Result<void>() : base::check_writable_file(file); !writable)
      return reject(writable.error().message);
  }
  auto loaded = load_world(options.world, model_path);
  if (!loaded) return reject(loaded.error().message);
  std::size_t dropped = 0;
  for (const auto& finding : loaded->findings) {
    if (finding.severity == Finding::Severity::dropped) ++dropped;
    const int wanted = finding.severity == Finding::Severity::dropped ? 0 : finding.severity == Finding::Severity::warning ? 1 : 2;
    if (options.check || options.verbosity >= wanted) print_line(finding.text());
  }
  if (const auto added = add_named_gains(options.gains, loaded->world); !added) return reject(added.error().message);
  auto world = std::make_shared<const WorldDef>(std::move(loaded->world));

  // Who only looks takes no server's place; ids of this kind cannot be asked for.
  const std::uint32_t server_id = options.check ? shm::first_unnamed_server + static_cast<std::uint32_t>(getpid()) : options.server_id;
  if (options.check) shm::remove_stale(shm::first_unnamed_server);
  auto server = shm::Server::start({.server_id = server_id, .access = *access, .max_bytes = options.shm_limit << 20U});
  if (!server) return fail(server.error().message);
  shm::SimulationInfo info{};
  info.step_ns = std::llround(world->physics.step * 1e9);
  info.seed = options.seed;
  info.lockstep = options.is_lockstep ? 1 : 0;
  info.wait_for = options.wait_for;
  shm::set_text(info.world, world->name);
  std::error_code error;
  shm::set_text(info.file, std::filesystem::absolute(options.world, error).string());
  shm::set_text(info.version, RTMSIM_VERSION);
  auto iface = (*server)->create(shm::simulation_spec(info));
  if (!iface) return fail(iface.error().message);

  std::vector<std::string> notes, left_out;
  const int threads = options.threads > 0 ? options.threads : static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 8U));
  std::vector<FaultOrder> faults;
  for (const auto& text : options.faults) faults.push_back(parse_fault_order(text).value());  // checked with the command line
  auto simulation = Simulation::create(
      world, **server, {.seed = options.seed, .threads = threads, .rolling = options.rolling == "on", .faults = faults}, notes, left_out);
  if (!simulation) return fail(simulation.error().message);
  for (const auto* lines : {&left_out, &notes}) {
    if (lines == &notes && options.verbosity == 0 && !options.check) continue;
    // Plugins know their place in the files; models are told by name.
    for (const auto& line : *lines) {
      const char* separator = line.starts_with("model ") ? ": " : "";
      print_line((*separator != 0 ? options.world : "") + separator + line);
    }
  }
  dropped += left_out.size();
  if (options.check) {
    if (options.is_json) std::printf("%s\n", check_text(**simulation, loaded->found, options.spawned, model_path).c_str());
    std::fflush(stdout);  // before the findings on stderr
    // Pictures are made when somebody looks; their files are read now.
    Assets assets(world->model_path);
    Scene::build(*world, assets);
    for (const auto& line : assets.take_complaints()) {
      print_line(options.world + ": " + line);
      ++dropped;
    }
    return loaded->dropped || dropped > 0 ? 1 : 0;
  }

  std::optional<Recorder> recorder;
  if (!options.record.empty()) {
    auto opened = Recorder::open(options.record, world->name);
    if (!opened) return fail(opened.error().message);
    recorder = std::move(*opened);
  }
  std::optional<WorldHashes> hashes;
  if (!options.hash_log.empty()) {
    std::optional<std::chrono::nanoseconds> period;
    if (options.hash_period) period = std::chrono::nanoseconds(std::llround(*options.hash_period * 1e9));
    auto opened = WorldHashes::open(options.hash_log, period);
    if (!opened) return fail(opened.error().message);
    hashes = std::move(*opened);
  }
  LoopOptions loop_options;
  loop_options.rtf = options.rtf;
  loop_options.is_paused = options.is_paused;
  loop_options.is_lockstep = options.is_lockstep;
  loop_options.wait_for = options.wait_for;
  if (!options.is_lockstep && options.participant_timeout > 0) {
    std::fprintf(stderr, "sim-server: --participant-timeout has no effect without --lockstep: time waits for no participant\n");
  }
  loop_options.participant_timeout = std::chrono::nanoseconds(std::llround(options.participant_timeout * 1e9));
  if (options.duration >= 0) loop_options.duration = std::chrono::nanoseconds(std::llround(options.duration * 1e9));
  loop_options.has_status_line = isatty(STDERR_FILENO) != 0;
  ServerLoop loop(**simulation, **server, **iface, model_path, loop_options, std::move(recorder));
  if (hashes) loop.keep_hashes(std::move(*hashes));
  signals.watch(&loop);
  const bool is_complete = loop.run();
  signals.end();
  if (options.print_hash) {
    std::printf("%016lx\n", static_cast<unsigned long>((*simulation)->hash()));
  }
  return is_complete ? 0 : 1;
}

int serve(int argc, char** argv) {
  Options options;
  base::Command app(
      "sim-server: simulate an SDFormat world\n"
      "Every device is an iface in shared memory. simctl shows and controls them.",
      "sim-server");
  base::add_standard_options(app, "sim-server", RTMSIM_VERSION);
  app.add_option("WORLD", options.world, "SDFormat world, or a model (SDFormat, URDF) that is opened on a floor")->required();
  app.add_option("-s,--server-id", options.server_id, "simulator ID, by which clients find it (default 0)")
      ->check(base::integer_between(0, 9999))
      ->envname("RTMSIM_SERVER_ID");
  app.add_flag("-u,--paused", options.is_paused, "start paused");
  app.add_option("--rtf", options.rtf, "real-time factor (default 1); 0: as fast as possible")->check(base::number_between(0.0, 1e6));
  app.add_flag("--ends-with-input", options.ends_with_input,
               "exit when standard input, a pipe, is closed: when the program that started this one exits");
  app.add_flag("--lockstep", options.is_lockstep, "run in lock step: time waits for all participants of each tick");
  app.add_option("--wait-for", options.wait_for, "number of participants that must join before time starts (default 0)")
      ->check(base::integer_between(0, static_cast<int>(shm::max_participants)));
  app.add_option("--participant-timeout", options.participant_timeout,
                 "remove a participant that hangs longer than this [wall-clock s] (default 0: never)")
      ->check(base::number_between(0.0, 1e6));
  app.add_option("--duration", options.duration, "stop after this time [simulated s]")->check(base::number_between(0.0, 1e9));
  app.add_option("--seed", options.seed, "seed of all sensor noise (default 1)")->check([](const std::string& text) {
    return text.starts_with("-") ? "expected a whole number that is not negative, got " + text : std::string();
  });
  app.add_option("--resource-path", options.resource_paths,
                 "folder with models; repeatable (also RTMSIM_RESOURCE_PATH, GZ_SIM_RESOURCE_PATH, GAZEBO_MODEL_PATH)")
      ->expected(1)
      ->take_all()
      ->check([](const std::string& text) {
        std::error_code error;
        return std::filesystem::is_directory(text, error) ? std::string() : "expected a folder, got " + base::in_quotes(text);
      });
  app.add_option("--gains", options.gains,
                 "take the gains of joint controllers from a YAML file of ros_control or ros2_control, before those of the world; "
                 "repeatable")
      ->expected(1)
      ->take_all();
  app.add_option("--fault", options.faults,
                 "inject a fault, KIND:START:DURATION:AMOUNT:IFACE [simulated s]; DURATION 0: until the end; repeatable")
      ->expected(1)
      ->take_all()
      ->check([](const std::string& text) {
        const auto order = sim::parse_fault_order(text);
        return order ? std::string() : order.error().message;
      });
  app.add_flag("--check", options.check, "load the world, print every finding, exit with 1 if something was left out");
  app.add_flag("--json", options.is_json, "with --check: print models, their collision shapes and all files as JSON")->needs("--check");
  app.add_option("--spawn", options.spawned, "with --json: also list the files of this model, file, folder or model://NAME; repeatable")
      ->expected(1)
      ->take_all()
      ->needs("--json");
  app.add_flag("--hash", options.print_hash, "print the hash of the final state");
  app.add_option("--hash-log", options.hash_log, "write a hash of each model and device over time; rtse diff compares two such files")
      ->check(base::output_name());
  app.add_option("--hash-period", options.hash_period,
                 "time between two hashes [simulated s] (default: the ticks of components, between 0.01 s and 0.1 s)")
      ->check(base::number_between(1e-6, 1e6));
  app.add_option("--record", options.record,
                 "write the poses of moving models, ten times a simulated second, as text: time model x y z qw qx qy qz")
      ->check(base::output_name());
  app.add_option("--threads", options.threads,
                 "number of threads for physics and sensors (default 0: one per core); results do not depend on it")
      ->check(base::integer_between(0, 64));
  app.add_option("--rolling", options.rolling,
                 "on: move robots that roll alone on level ground by the rolling step, which is faster; off: by ODE (default on)")
      ->check([](const std::string& text) { return text == "on" || text == "off" ? std::string() : "expected on or off, got " + text; });
  app.add_option("--shm-mode", options.shm_mode, "access mode of the ifaces (default 0600)");
  app.add_option("--shm-group", options.shm_group, "group of the ifaces");
  app.add_option("--shm-limit", options.shm_limit, "limit of shared memory for all ifaces [MiB] (default 1536)")
      ->check(base::integer_between(1, 1 << 20));
  app.add_option("-v", options.verbosity, "log level: 0 errors, 1 normal, 2 notes, 3 debug (default 1)")
      ->check(base::integer_between(0, 3));
  if (const auto end = base::parse_command_line(app, "sim-server", argc, argv)) return *end;
  const base::Level levels[] = {base::Level::error, base::Level::info, base::Level::info, base::Level::debug};
  base::set_log_level(levels[options.verbosity]);
  try {
    Signals signals;
    if (options.ends_with_input && !signals.follow_input()) return reject("--ends-with-input: expected a pipe as standard input");
    return run(options, signals);
  } catch (const std::bad_alloc&) {
    return fail(options.world + ": not enough memory for this world");
  } catch (const std::system_error& e) {  // a thread that cannot be started, most likely
    return fail(options.world + ": not enough memory for this world, or too many processes: " + e.what());
  } catch (const std::exception& e) {  // from libraries
    return fail(e.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (base::is_prefork_server(argc, argv)) {
    // The specification of SDFormat is read with the first world: more than half of a start, with the libraries.
    static_cast<void>(sim::load_world_text("<sdf version='1.6'><world name='none'/></sdf>", "/", "none", sim::ModelPath{}));
    return base::make_processes(serve);
  }
  return serve(argc, argv);
}
