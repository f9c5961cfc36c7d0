// What the simulator costs, each number beside its limit and beside the bare libraries doing the same work in the same run. Prints a table.
//   sim_bench [rays] [steps] [robots] [vehicles] [load] [calls]      all of them when none is named
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "bare_loops.h"
#include "base/log.h"
#include "shm/request_board.h"
#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "support/usage.h"
#include "support/vehicles.h"
#include "support/worlds.h"
#include "world/world_loader.h"

namespace sim::bench {
namespace {

using namespace std::chrono_literals;
using namespace sim::test;
using Clock = std::chrono::steady_clock;

double us_since(Clock::time_point start) { return std::chrono::duration<double, std::micro>(Clock::now() - start).count(); }
double least(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }

enum class Goal { at_least, at_most };

void print(const std::string& what, double value, const char* unit, Goal goal, double limit) {
  const bool is_good = goal == Goal::at_least ? value >= limit : value <= limit;
  std::printf("%-84s %9.3f %-6s %s %8.2f  %s\n", what.c_str(), value, unit, goal == Goal::at_least ? ">=" : "<=", limit,
              is_good ? "ok" : "MISSED");
  std::fflush(stdout);
}

template <class... Values>
std::string text(const char* format, Values... values) {
  char line[200];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

// ---- rays ----

constexpr double reach = 30;  // of the lasers [m]

// Boxes on the floor of a walled hall, none where the robot drives.
WorldDef hall(int boxes) {
  WorldDef world;
  world.name = "hall";
  world.physics.step = 0.005;
  world.models.push_back(ground());
  const double half = std::sqrt(boxes) * 0.8;
  for (const auto& [x, y] : {std::pair{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}}) {
    world.models.push_back(
        fixed(text("wall_%g_%g", x, y), BoxShape{{x != 0 ? 0.2 : 2 * half, y != 0 ? 0.2 : 2 * half, 1}}, at(x * half, y * half, 0.5)));
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < boxes;) {
    const double x = half * any(random), y = half * any(random);
    if (std::hypot(x, y) < 1.5) continue;
    const Eigen::Vector3d size(0.35 + 0.15 * any(random), 0.35 + 0.15 * any(random), 0.8);
    world.models.push_back(fixed(text("box_%d", i++), BoxShape{size}, at(x, y, 0.4, 3 * any(random))));
  }
  return world;
}

// A rough wall of 100,000 triangles all around the robot.
WorldDef cave(const std::string& folder) {
  constexpr int around = 1000, up = 50;
  const std::string file = folder + "/cave.obj";
  std::ofstream out(file);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < around; ++i) {
    const double angle = 2 * std::numbers::pi * i / around, base = 6 + 2 * std::sin(5 * angle) + std::sin(17 * angle);
    for (int k = 0; k <= up; ++k) {
      const double r = base + 0.03 * any(random);
      out << "v " << r * std::cos(angle) << ' ' << r * std::sin(angle) << ' ' << 0.02 * k << '\n';
    }
  }
  for (int i = 0; i < around; ++i) {
    for (int k = 0; k < up; ++k) {
      const int a = i * (up + 1) + k + 1, b = (i + 1) % around * (up + 1) + k + 1;
      out << "f " << a << ' ' << b << ' ' << b + 1 << "\nf " << a << ' ' << b + 1 << ' ' << a + 1 << '\n';
    }
  }
  out.close();
  WorldDef world;
  world.name = "cave";
  world.physics.step = 0.005;
  world.models.push_back(ground());
  MeshShape mesh;
  mesh.path = file;
  world.models.push_back(fixed("cave", mesh, at(0, 0, 0)));
  return world;
}

// One robot that drives in a circle of 0.6 m and scans in every step, so that each scan is of another place; the bare loop scans from the
// same places. Server: moving bodies brought up to date, traced, marks set, published to a subscriber.
void bench_rays_in(const char* where, WorldDef world, int beams) {
  const double half_angle = beams == 181 ? std::numbers::pi / 2 : beams == 683 ? 2.0862 : 0.75 * std::numbers::pi;
  TriangleCache triangles;
  BareRays bare(world, triangles);
  bare.aim(beams, -half_angle, half_angle, reach);
  ModelDef robot = pioneer("robot", at(0, -0.6, 0));
  robot.links[0].sensors = {laser("laser", beams, -half_angle, half_angle, reach, at(0.1, 0, 0.15))};
  robot.links[0].sensors[0].update_rate = 0;
  world.models.push_back(robot);
  SimulationFixture server(std::move(world));
  auto scans = server.open(shm::IfaceType::laser, "robot::laser");
  auto wheels = server.open(shm::IfaceType::position2d, "robot::position2d");
  wheels.unsubscribe();
  if (!wheels.command_velocity(0.3, 0, 0.5)) std::abort();
  std::vector<float> ranges(static_cast<std::size_t>(beams));
  std::vector<double> ours, theirs;
  int differ = 0;
  for (int block = 0; block < 60; ++block) {
    constexpr int count = 20;
    std::vector<Eigen::Isometry3d> places;
    double spent = 0;
    for (int i = 0; i < count; ++i) {
      server.simulation->step(server.times);
      const auto start = Clock::now();
      server.simulation->sense(server.times);
      spent += us_since(start);
      if (!scans.read()) std::abort();
      places.push_back(from_pose(scans.sample<shm::LaserSample>().pose));
    }
    ours.push_back(spent / count);
    const auto start = Clock::now();
    for (const auto& place : places) bare.trace(place, ranges);
    theirs.push_back(us_since(start) / count);
    const auto seen = scans.laser_scan().ranges;
    for (std::size_t i = 0; i < ranges.size(); ++i) differ += std::abs(seen[i] - ranges[i]) > 0.005F ? 1 : 0;
  }
  const double a = least(ours), b = least(theirs);
  if (differ > static_cast<int>(ranges.size()) / 2)
    std::printf("  %d of %zu ranges differ from those of the bare loop\n", differ, 60 * ranges.size());
  print(text("rays, %s, %d beams: %.1f M/s, bare Embree %.1f M/s (%.1f and %.1f us a scan)", where, beams, beams / a, beams / b, a, b),
        100 * b / a, "%", Goal::at_least, 70);
}

// A scanner of 16 layers and 1800 columns, with noise, on the robot; the scan that a 10 Hz sensor of a VLP-16 is due.
void bench_rings_in(const char* where, WorldDef world, bool is_rolling) {
  SensorDef sensor = laser("lidar", 1800, -std::numbers::pi, std::numbers::pi, 130, at(0.1, 0, 0.4));
  auto& ray = std::get<RayDef>(sensor.data);
  ray.vertical = {16, 1, -0.2618, 0.2618};
  ray.noise.kind = NoiseDef::Kind::gaussian;
  ray.noise.stddev = 0.008;
  ray.is_rolling = is_rolling;
  sensor.update_rate = 0;
  ModelDef robot = pioneer("robot", at(0, -0.6, 0));
  robot.links[0].sensors = {sensor};
  world.models.push_back(robot);
  SimulationFixture server(std::move(world));
  auto scans = server.open(shm::IfaceType::laser, "robot::lidar");
  std::vector<double> spent;
  for (int block = 0; block < 30; ++block) {
    constexpr int count = 10;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
      server.simulation->step(server.times);
      const auto start = Clock::now();
      server.simulation->sense(server.times);
      sum += us_since(start);
      if (!scans.read()) std::abort();
    }
    spent.push_back(sum / count);
  }
  print(text("rays, %s, 28,800 of 16 layers with noise%s, a scan", where, is_rolling ? ", rolling" : ""), 1e-3 * least(spent), "ms",
        Goal::at_most, 1.5);
}

void bench_rays() {
  const auto folder = std::filesystem::temp_directory_path() / ("sim_bench-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  for (const int beams : {181, 683, 1081}) bench_rays_in("50 boxes", hall(50), beams);
  for (const int beams : {181, 683, 1081}) bench_rays_in("1000 boxes", hall(1000), beams);
  for (const int beams : {181, 683, 1081}) bench_rays_in("mesh of 100 k", cave(folder), beams);
  bench_rings_in("50 boxes", hall(50), false);
  bench_rings_in("1000 boxes", hall(1000), false);
  bench_rings_in("50 boxes", hall(50), true);
  std::filesystem::remove_all(folder);
}

// ---- steps ----

// N robots in an arena, with a pillar between each four.
WorldDef arena(int robots, double step) {
  WorldDef world;
  world.name = "arena";
  world.physics.step = step;
  world.models.push_back(ground());
  const int side = static_cast<int>(std::ceil(std::sqrt(robots)));
  const double half = 2.0 * side;
  for (int i = 0; i < 50; ++i) {
    const double angle = 2 * std::numbers::pi * i / 50, r = 1.5 * half + 2;
    world.models.push_back(fixed(text("box_%d", i), BoxShape{{0.5, 0.5, 0.5}}, at(r * std::cos(angle), r * std::sin(angle), 0.25, angle)));
  }
  for (int i = 0; i < robots; ++i) {
    world.models.push_back(pioneer(text("robot_%d", i), at((i % side + 0.5) * 4 - half, (i / side + 0.5) * 4 - half, 0, i)));
  }
  return world;
}

void bench_steps_of(int robots, double step) {
  const WorldDef world = arena(robots, step);
  BareSteps bare(world);
  // 0.3 m/s and 0.5 rad/s
  bare.drive((0.3 - 0.5 * 0.165) / 0.0825, (0.3 + 0.5 * 0.165) / 0.0825);
  SimulationFixture server(world);
  std::vector<shm::Iface> wheels;
  for (int i = 0; i < robots; ++i) {
    wheels.push_back(server.open(shm::IfaceType::position2d, text("robot_%d::position2d", i)));
    wheels.back().unsubscribe();
    if (!wheels.back().command_velocity(0.3, 0, 0.5)) std::abort();
  }
  const int count = std::max(10, 1000 / robots);
  std::vector<double> ours, theirs;
  for (int i = 0; i < 200; ++i) bare.step(), server.simulation->step(server.times);
  for (int block = 0; block < 60; ++block) {
    auto start = Clock::now();
    for (int i = 0; i < count; ++i) server.simulation->step(server.times), server.simulation->sense(server.times);
    ours.push_back(us_since(start) / count);
    start = Clock::now();
    for (int i = 0; i < count; ++i) bare.step();
    theirs.push_back(us_since(start) / count);
  }
  const double drift = (bare.pose(0).translation() - server.simulation->physics().model_pose(51).translation()).head<2>().norm();
  if (drift > 1) std::printf("  the bare robots drive elsewhere: %.2f m\n", drift);
  const double a = least(ours), b = least(theirs);
  print(text("steps of %g ms, %d robots: %.1f us, bare ODE %.1f us", step * 1000, robots, a, b), a / b, "times", Goal::at_most, 1.25);
}

void bench_steps() {
  for (const double step : {0.001, 0.005}) {
    for (const int robots : {1, 10, 100}) bench_steps_of(robots, step);
  }
}

// ---- the server as a process ----

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
  // Until it has ended by itself.
  void wait() {
    int status = 0;
    wait4(pid_, &status, 0, &usage_);
    took_ = us_since(start_) * 1e-6;
    pid_ = 0;
    if (status != 0) std::abort();
  }
  double took() const { return took_; }
  double megabytes() const { return static_cast<double>(usage_.ru_maxrss) / 1024; }
  // [s], of all threads. In nanoseconds, as the scheduler counts; the ticks of /proc/PID/stat see nothing of what sleeps between them.
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
  // Its line, once it answers.
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

// All robots drive and somebody reads all lasers.
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

void bench_robots() {
  bench_robots_of(1, 400);
  bench_robots_of(10, 80);
  bench_robots_of(100, 10);
  bench_robots_of(1000, 0.7);
}

// ---- load ----

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
    print(is_paused ? "obstacle course, paused: of a core" : "obstacle course, 1000 steps/s in real time, nobody listens: of a core",
          least(shares), "%", Goal::at_most, is_paused ? 0.5 : 4);
  }
}

// ---- system calls ----

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
  // What there is comes from the wake-ups of the request and of strace itself, and from the heartbeat, ten times a second.
  print(text("system calls of %d steps that published %.0f odometries: %.0f; a publication", count, published, calls), calls / published,
        "calls", Goal::at_most, 0.01);
}

// ---- vehicles ----

// Fifty quadcopters that fly apart, each step of 1 ms.
void bench_vehicles() {
  std::string text = "<gravity>0 0 -9.81</gravity>";
  for (int i = 0; i < 50; ++i)
    text += quadcopter("c" + std::to_string(i), std::to_string(3 * (i % 10)) + " " + std::to_string(3 * (i / 10)) + " 5 0 0 0");
  SimulationFixture f(world_of_text(text), 1, static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 8U)));
  std::vector<shm::Iface> pilots;
  for (int i = 0; i < 50; ++i) {
    pilots.push_back(f.open(shm::IfaceType::position3d, "c" + std::to_string(i) + "::position3d"));
    (void)pilots.back().command(shm::CommandKind::velocity, std::array<double, 6>{0.5, 0.1, 0, 0, 0, 0.2});
  }
  std::vector<double> times;
  for (int round = 0; round < 5; ++round) {
    constexpr int steps = 500;
    const auto start = Clock::now();
    for (int i = 0; i < steps; ++i) f.simulation->step(f.times);
    times.push_back(us_since(start) / steps);
  }
  print("50 quadcopters, 1 ms: times real time", 1000 / least(times), "x", Goal::at_least, 3);
}

}  // namespace
}  // namespace sim::bench

int main(int argc, char** argv) {
  ::test::answer_help(
      argc, argv, "sim_bench [rays|steps|robots|vehicles|load|calls]...\nMeasures the simulator beside plain ODE and Embree (all parts).");
  base::set_log_level(base::Level::error);
  const std::pair<const char*, void (*)()> parts[] = {{"rays", sim::bench::bench_rays},     {"steps", sim::bench::bench_steps},
                                                      {"robots", sim::bench::bench_robots}, {"vehicles", sim::bench::bench_vehicles},
                                                      {"load", sim::bench::bench_load},     {"calls", sim::bench::bench_calls}};
  for (const auto& [name, part] : parts) {
    const bool is_wanted =
        argc == 1 || std::any_of(argv + 1, argv + argc, [&, name = name](const char* word) { return std::string_view(word) == name; });
    if (is_wanted) part();
  }
}
