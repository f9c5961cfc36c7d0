// Scans of the simulator and of Embree alone.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "bare_loops.h"
#include "sim_bench.h"
#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "support/worlds.h"

namespace sim::bench {
namespace {

using namespace sim::test;

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
// same places. The server updates moving bodies, traces, sets marks, and publishes to a subscriber.
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

// A scanner of 16 layers and 1800 columns, with noise, on the robot: one scan of a VLP-16 at 10 Hz.
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

}  // namespace

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

}  // namespace sim::bench
