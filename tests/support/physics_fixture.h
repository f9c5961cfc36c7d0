// A physics world for tests, stepped by hand. One thread.
#pragma once

#include <cmath>
#include <stdexcept>

#include "physics/physics.h"
#include "support/worlds.h"
#include "world/world_loader.h"

namespace sim::test {

struct PhysicsFixture {
  explicit PhysicsFixture(WorldDef def, int threads = 1)
      : pool(threads), world(std::make_shared<const WorldDef>(std::move(def))), physics(world, pool, triangles, notes, dropped) {}
  void run(double seconds) {
    const auto steps = static_cast<int>(std::lround(seconds / physics.step_length()));
    for (int i = 0; i < steps; ++i) physics.step();
  }
  ModelId id(std::string_view name) const { return physics.find(name).value(); }
  Eigen::Vector3d position(std::string_view name) const { return physics.model_pose(id(name)).translation(); }
  LinkId link(std::string_view name) const { return physics.find_link(name).value(); }
  JointId joint(std::string_view model, std::string_view name) const {
    const ModelDef& def = physics.def(id(model));
    for (std::uint32_t i = 0; i < def.joints.size(); ++i) {
      if (def.joints[i].name == name) return {id(model), i};
    }
    throw std::runtime_error("no joint " + std::string(name));
  }
  std::uint64_t hash() const {
    StateHash hash;
    physics.add_to(hash);
    return hash.value();
  }
  WorkerPool pool;
  TriangleCache triangles;
  std::vector<std::string> notes, dropped;
  std::shared_ptr<const WorldDef> world;
  Physics physics;
};

inline WorldDef world_of(std::vector<ModelDef> models, double step = 0.001) {
  WorldDef world;
  world.physics.step = step;
  world.models = std::move(models);
  return world;
}

// The content of a <world>; everything in it must load.
inline WorldDef world_of_text(const std::string& content, const std::string& version = "1.9") {
  auto loaded = load_world_text("<sdf version='" + version + "'><world name='w'>" + content + "</world></sdf>", {}, "w.sdf", ModelPath{});
  if (!loaded) throw std::runtime_error(loaded.error().message);
  if (!loaded->findings.empty()) throw std::runtime_error(loaded->findings.front().text());
  return std::move(loaded->world);
}

}  // namespace sim::test
