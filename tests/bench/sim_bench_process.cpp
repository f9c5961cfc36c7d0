// The simulator as a process: robots in real time, loading, idling, system calls.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>
#include <tuple>

#include "bare_loops.h"
#include "shm/request_board.h"
#include "sim_bench.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim::bench {
namespace {

using namespace std::chrono_literals;
using namespace sim::test;

class ServerProcess {
 public:
  ServerProcess(std::vector<std::string> words, bool is_quiet = true) {
    words.insert(words.begin(), std::string(RTMSIM_BIN_DIR) + "/sim-server");
    words.insert(words.end(), {"-s", std::to_string(id())});
    std::vector<char*> arguments;
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    if (is_quiet) posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    start_ = Clock::now();
    if (posix_spawn(&pid_, words[0].c_str(), &actions, nullptr, arguments.data(), environ) != 0) std::abort();
    posix_spawn_file_actions_destroy(&actions);
  }
  ~ServerProcess() {
    if (pid_ == 0) return;
    kill(pid_, SIGTERM);
    wait();
  }
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  static std::uint32_t id() { return 9000 - own_server_id() / 10; }
  pid_t pid() const { return pid_; }
  // Waits until the process has ended by itself.
  void wait() {
    int status = 0;
    wait4(pid_, &status, 0, &usage_);
    took_ = us_since(start_) * 1e-6;
    pid_ = 0;
    if (status != 0) std::abort();
  }
  double took() const { return took_; }
  double megabytes() const { return static_cast<double>(usage_.ru_maxrss) / 1024; }
  // Processor time of all threads [s], from the nanoseconds of the scheduler. The ticks of /proc/PID/stat miss threads that sleep between
  // ticks.
  double processor_time() const {
    double ns = 0;
    for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(pid_) + "/task")) {
      std::ifstream file(task.path() / "schedstat");
      double ran = 0;
      file >> ran;
      ns += ran;
    }
    return ns * 1e-9;
  }
  // The connection for requests, once the simulator answers.
  shm::Requester line() const {
    for (int i = 0; i < 3000; ++i) {
      if (auto requester = shm::Requester::open(id()); requester && requester->ask(shm::StatsRequest{})) return std::move(*requester);
      std::this_thread::sleep_for(10ms);
    }
    std::abort();
  }

 private:
  pid_t pid_ = 0;
  Clock::time_point start_;
  double took_ = 0;
  rusage usage_{};
};

// All robots drive, and a client reads all lasers.
std::vector<shm::Iface> drive_and_listen() {
  std::vector<shm::Iface> open;
  for (const auto& found : shm::find_segments(ServerProcess::id())) {
    const auto type = found.name.type;
    if (type != shm::IfaceType::laser && type != shm::IfaceType::position2d) continue;
    open.push_back(shm::Iface::open(ServerProcess::id(), type, found.name.iface).value());
    if (type == shm::IfaceType::laser ? !open.back().subscribe() : !open.back().command_velocity(0.3, 0, 0.5)) std::abort();
  }
  return open;
}

std::string arena_text(int robots) {
  std::string world = "<sdf version='1.9'><world name='arena'><physics type='ode'><max_step_size>0.005</max_step_size></physics>";
  world += "<include><uri>model://ground_plane</uri></include>";
  const int side = static_cast<int>(std::ceil(std::sqrt(robots)));
  const double half = 2.0 * side;
  const auto add_static = [&](const std::string& name, double x, double y, const std::string& shape) {
    world += text("<model name='%s'><static>true</static><pose>%g %g 0.3 0 0 0</pose><link name='l'><collision name='c'><geometry>",
                  name.c_str(), x, y) +
             shape + "</geometry></collision></link></model>";
  };
  for (const double s : {-1.0, 1.0}) {
    add_static(text("wall_x%g", s), s * half, 0, text("<box><size>.2 %g .6</size></box>", 2 * half));
    add_static(text("wall_y%g", s), 0, s * half, text("<box><size>%g .2 .6</size></box>", 2 * half));
  }
  for (int i = 0; i < 50; ++i) {
    const double angle = 2.4 * i, r = half * std::sqrt(i / 50.0);
    const double x = 4 * std::round(r * std::cos(angle) / 4), y = 4 * std::round(r * std::sin(angle) / 4);
    if (side % 2 == 0)
      add_static(text("box_%d", i), x, y, "<box><size>.3 .3 .6</size></box>");
    else
      add_static(text("box_%d", i), x + 2, y + 2, "<box><size>.3 .3 .6</size></box>");
  }
  for (int i = 0; i < robots; ++i) {
    world += text("<include><uri>model://pioneer2dx_hokuyo</uri><name>robot_%d</name><pose>%g %g 0 0 0 %d</pose></include>", i,
                  (i % side + 0.5) * 4 - half, (i / side + 0.5) * 4 - half, i % 6);
  }
  return world + "</world></sdf>";
}

void bench_robots_of(int robots, double limit) {
  const auto file = std::filesystem::temp_directory_path() / ("sim_bench-" + std::to_string(getpid()) + ".sdf");
  std::ofstream(file) << arena_text(robots);
  const auto world = std::move(load_world(file, ModelPath::from_environment({}, std::string(RTMSIM_SOURCE_DIR) + "/worlds")).value().world);
  BareSteps steps(world);
  steps.drive((0.3 - 0.5 * 0.165) / 0.0825, (0.3 + 0.5 * 0.165) / 0.0825);
  TriangleCache triangles;
  BareRays rays(world, triangles);
  rays.aim(682, -2.08621, 2.09235, 5.6F);
  std::vector<float> ranges(682);

  ServerProcess process({file, "-u", "--rtf", "0"});
  auto line = process.line();
  const auto open = drive_and_listen();
  if (open.size() != 2 * static_cast<std::size_t>(robots)) std::abort();
  const int count = robots > 300 ? 40 : std::max(200, 8000 / robots);
  std::vector<double> ours, theirs, worked;
  for (int block = 0; block < 12; ++block) {
    const double before = process.processor_time();
    auto start = Clock::now();
    if (const auto reply = line.ask(shm::StepRequest{count}, 100s); !reply || reply->status != shm::RequestStatus::ok) std::abort();
    ours.push_back(us_since(start) / count);
    worked.push_back((process.processor_time() - before) * 1e6 / count);
    start = Clock::now();
    for (int i = 0; i < count; ++i) {
      steps.step();
      if (i % 20 != 0) continue;
      for (std::size_t r = 0; r < steps.robots(); ++r) {
        Eigen::Isometry3d place = steps.pose(r);
        place.translation().z() = 0.285;
        rays.trace(place, ranges);
      }
    }
    theirs.push_back(us_since(start) / count);
  }
  std::filesystem::remove(file);
  const double a = least(ours), b = least(theirs);
  std::printf("  %d robots: %.0f us of processor time a step\n", robots, least(worked));
  print(text("%d robots, 10 Hz lasers, 5 ms: bare loop %.0f times real time, server at %.2f of it", robots, 5000 / b, b / a), 5000 / a,
        "times", Goal::at_least, limit);
}

}  // namespace

void bench_robots() {
  bench_robots_of(1, 400);
  bench_robots_of(10, 80);
  bench_robots_of(100, 10);
  bench_robots_of(1000, 0.7);
}

void bench_load() {
  for (const auto& [name, seconds, megabytes] : {std::tuple{"obstacle_course", 0.5, 200.0}, {"hundred", 1.0, 300.0}}) {
    std::vector<double> times;
    double most = 0;
    for (int i = 0; i < 7; ++i) {
      ServerProcess process({std::string(RTMSIM_SOURCE_DIR) + "/worlds/" + name + ".sdf", "--duration", "0"});
      process.wait();
      times.push_back(process.took());
      most = std::max(most, process.megabytes());
    }
    print(text("load %s.sdf, from exec to the end of a run of 0 s", name), least(times), "s", Goal::at_most, seconds);
    print(text("  most memory"), most, "MiB", Goal::at_most, megabytes);
  }
  const std::string course = std::string(RTMSIM_SOURCE_DIR) + "/worlds/obstacle_course.sdf";
  for (const bool is_paused : {false, true}) {
    ServerProcess process(is_paused ? std::vector<std::string>{course, "-u"} : std::vector<std::string>{course});
    (void)process.line();
    std::this_thread::sleep_for(1s);
    std::vector<double> shares;
    for (int i = 0; i < 4; ++i) {
      const double before = process.processor_time();
      const auto start = Clock::now();
      std::this_thread::sleep_for(2s);
      shares.push_back(100 * (process.processor_time() - before) / (us_since(start) * 1e-6));
    }
    print(is_paused ? "obstacle course, paused: of a core" : "obstacle course, 1000 steps/s in real time, no subscriber: of a core",
          least(shares), "%", Goal::at_most, is_paused ? 0.5 : 4);
  }
}

// Steps with a laser and a drive that publish in every step to subscribers who do not wait, under strace.
void bench_calls() {
  const auto folder = std::filesystem::temp_directory_path();
  const auto report = folder / ("sim_bench-" + std::to_string(getpid()) + ".calls");
  ServerProcess process({std::string(RTMSIM_SOURCE_DIR) + "/worlds/obstacle_course.sdf", "-u", "--rtf", "0", "--threads", "1"});
  auto line = process.line();
  const auto open = drive_and_listen();
  auto pose = shm::Iface::open(ServerProcess::id(), shm::IfaceType::position2d, "pioneer2dx::position2d").value();
  if (!pose.subscribe()) std::abort();
  const pid_t tracer = fork();
  if (tracer == 0) {
    if (std::freopen("/dev/null", "w", stderr) == nullptr) _exit(1);
    execlp("strace", "strace", "-f", "-c", "-o", report.c_str(), "-p", std::to_string(process.pid()).c_str(), nullptr);
    _exit(127);
  }
  std::this_thread::sleep_for(1s);
  if (waitpid(tracer, nullptr, WNOHANG) != 0) {
    std::printf("system calls are not counted: strace is not there or may not attach\n");
    return;
  }
  const auto before = pose.sequence();
  constexpr int count = 20000;
  if (!line.ask(shm::StepRequest{count}, 100s)) std::abort();
  const auto published = static_cast<double>(pose.sequence() - before);
  kill(tracer, SIGINT);
  waitpid(tracer, nullptr, 0);
  std::ifstream file(report);
  double calls = 0;
  for (std::string row; std::getline(file, row);) {
    if (row.find("total") == std::string::npos) continue;
    std::istringstream fields(row);
    double share = 0, seconds = 0, each = 0;
    fields >> share >> seconds >> each >> calls;
  }
  std::filesystem::remove(report);
  // The counted calls are wake-ups of the request and of strace itself, and the heartbeat, ten times a second.
  print(text("system calls of %d steps that published %.0f odometries: %.0f; a publication", count, published, calls), calls / published,
        "calls", Goal::at_most, 0.01);
}

}  // namespace sim::bench
