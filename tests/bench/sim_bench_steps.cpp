// Steps of robots, beside ODE alone, and of quadcopters.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <thread>

#include "bare_loops.h"
#include "sim_bench.h"
#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "support/vehicles.h"
#include "support/worlds.h"

namespace sim::bench {
namespace {

using namespace sim::test;

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

}  // namespace

void bench_steps() {
  for (const double step : {0.001, 0.005}) {
    for (const int robots : {1, 10, 100}) bench_steps_of(robots, step);
  }
}

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

}  // namespace sim::bench
