// What heavy worlds cost physics, in processor time of one thread: simulated seconds for each, each number beside its limit. Prints a
// table.
#include <sys/resource.h>

#include <cstdio>
#include <vector>

#include "physics/body_forces.h"
#include "physics/joints.h"
#include "support/heavy_worlds.h"
#include "support/physics_fixture.h"
#include "support/usage.h"

namespace sim::bench {
namespace {

using namespace test;

double processor_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double max_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

// Simulated seconds for each second of processor time.
double speed(PhysicsFixture& f, double seconds) {
  const double before = processor_time();
  f.run(seconds);
  return seconds / std::max(processor_time() - before, 1e-9);
}

void print(const char* what, double value, const char* unit, double at_least) {
  std::printf("%-70s %10.2f %-6s >= %6.2f  %s\n", what, value, unit, at_least, value >= at_least ? "ok" : "MISSED");
  std::fflush(stdout);
}

double bench_robot(PhysicsDef::Solver solver, const char* row, double at_least) {
  WorldDef world = world_of({ground(), ManyLinks("robot", at(0, 0, 0)).model()});
  world.physics.solver = solver;
  for (auto& model : world.models) model.allow_auto_disable = false;
  PhysicsFixture f(std::move(world));
  for (std::uint32_t j = 0; j < f.physics.def(1).joints.size(); ++j) {
    if (f.physics.def(1).joints[j].name.find("caster") == std::string::npos) f.physics.set_motor({1, j}, 0, 0, 3000);
  }
  if (!f.physics.set_model_twist(1, {{0.3, 0, 0}, {0, 0, 0}})) std::abort();
  const double measured = speed(f, 1);
  print(row, measured, "times", at_least);
  return measured;
}

// The solver that is chosen beside the iterative one, while it lies in the ground.
void bench_humanoid(double depth, double at_least) {
  double speeds[2];
  std::uint32_t contacts = 0;
  for (const auto solver : {PhysicsDef::Solver::automatic, PhysicsDef::Solver::iterative}) {
    WorldDef world = world_of({ground(), humanoid(75, depth)});
    world.physics.solver = solver;
    PhysicsFixture f(std::move(world));
    f.run(0.001);
    contacts = std::max(contacts, f.physics.statistics().contacts);
    speeds[solver == PhysicsDef::Solver::iterative ? 1 : 0] = speed(f, 0.1);
  }
  char line[100];
  std::snprintf(line, sizeof line, "a humanoid of 75 bodies, %u contacts: speed by that with `quick`", contacts);
  print(line, speeds[0] / speeds[1], "", at_least);
}

void bench_resting() {
  PhysicsFixture f(resting_shapes(3003));
  print("3003 boxes, balls and cans on the ground, the first second", speed(f, 1), "times", 0.3);
  print("the same, later", speed(f, 2), "times", 5);
}

void bench_overlapping(int count, double at_least) {
  std::vector<ModelDef> models{ground()};
  for (int i = 0; i < count; ++i) models.push_back(body("box" + std::to_string(i), BoxShape{{0.3, 0.3, 0.3}}, at(0, 0, 0.15), 2));
  PhysicsFixture f(world_of(std::move(models)));
  char line[100];
  std::snprintf(line, sizeof line, "%d boxes in one place, 0.2 s (%.0f MiB of memory so far)", count, max_megabytes());
  print(line, speed(f, 0.2), "times", at_least);
}

// What a world pays that has no water, wings, propellers or wind: what asks for them in each step is asked once more for each robot.
void bench_hooks(double at_most) {
  constexpr int robots = 100, steps = 4000;
  std::vector<ModelDef> models{ground()};
  for (int i = 0; i < robots; ++i) {
    models.push_back(pioneer("robot_" + std::to_string(i), at(i % 10 * 2.0, i / 10 * 2.0, 0)));
    models.back().allow_auto_disable = false;
  }
  const auto seconds_of = [&](bool asks_again) {
    PhysicsFixture f(world_of(models));
    TriangleCache triangles;
    ShapeStore shapes(triangles);
    std::vector<std::string> lost;
    const PhysicsDef physics;
    std::vector<std::shared_ptr<const Blueprint>> plans;
    std::vector<BodyForces> hooks;
    hooks.reserve(robots);
    for (int i = 1; i <= robots; ++i) {
      plans.push_back(Blueprint::of(std::make_shared<const ModelDef>(models[static_cast<std::size_t>(i)])).value());
      hooks.emplace_back(*plans.back(), physics, shapes, lost);
    }
    const std::vector<ode::Body> bodies;
    const std::vector<JointInstance> joints;
    f.run(0.5);
    const double before = processor_time();
    for (int step = 0; step < steps; ++step) {
      for (BodyForces& hook : hooks) {
        if (asks_again) hook.apply(bodies, joints, physics, {});
      }
      f.physics.step();
    }
    return processor_time() - before;
  };
  double without = 1e9, with = 1e9;
  for (int i = 0; i < 3; ++i) without = std::min(without, seconds_of(false)), with = std::min(with, seconds_of(true));
  const double ratio = with / without;
  std::printf("%-70s %10.3f %-6s <= %6.2f  %s\n", "100 robots: processor time with / without the hooks of water and air", ratio, "",
              at_most, ratio <= at_most ? "ok" : "MISSED");
}

void bench_many() {
  const double before = processor_time();
  PhysicsFixture f(resting_shapes(20000));
  const double built = processor_time() - before;
  print("20000 moving models: made in a second of processor time", 20000 / built, "", 20000);
}

}  // namespace
}  // namespace sim::bench

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "physics_bench\nMeasures the physics with heavy worlds.");
  using Solver = sim::PhysicsDef::Solver;
  const double exact = sim::bench::bench_robot(Solver::automatic, "a robot of 49 links rolls", 2);
  const double quick = sim::bench::bench_robot(Solver::iterative, "the same with the iterative solver", 2);
  sim::bench::print("the first by the second", exact / quick, "", 1.3);
  for (const double depth : {0.1, 0.4, 0.7, 1.2}) sim::bench::bench_humanoid(depth, 0.3);
  sim::bench::bench_resting();
  sim::bench::bench_overlapping(300, 0.04);
  sim::bench::bench_overlapping(3000, 0.002);
  sim::bench::bench_many();
  sim::bench::bench_hooks(1.02);
  std::printf("most memory: %.0f MiB\n", sim::bench::max_megabytes());
}
