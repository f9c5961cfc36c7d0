// The world as pictures see it: a scene that follows what comes and goes in the physics, and where everything is. The stepping thread only;
// what it hands out never changes and any thread may keep it.
#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include "devices/actor_motion.h"
#include "physics/physics.h"
#include "render/scene.h"

namespace sim {

// The world at one instant.
struct Snapshot {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const std::vector<Eigen::Isometry3d>> poses;  // of the scene's links
  std::vector<ModelId> models;                                  // of Scene::models; actors come after them
  std::uint64_t version = 0;                                    // of the scene: another one after models have come or gone
};

class RenderWorld {
 public:
  RenderWorld(const Physics& physics, const WorldDef& world);

  // The world as it is now. Builds the scene anew when models have come or gone; what could not be read is logged, once each.
  Snapshot snapshot(std::chrono::nanoseconds time, Scene::Content content = Scene::Content::visuals);

  // Whether a scene of this content has been built: then a model that is spawned should bring what is drawn of it.
  bool has_scene(Scene::Content content) const { return (content == Scene::Content::visuals ? visuals_ : collisions_).scene != nullptr; }
  // Read by another thread for a model that is to be spawned.
  void adopt(Assets&& assets) { assets_.adopt(std::move(assets)); }

  // True (lock step, as fast as possible): pictures are finished before time goes on. False: each camera draws in its own time.
  void set_synchronous(bool on) { is_synchronous_ = on; }
  bool is_synchronous() const { return is_synchronous_; }

 private:
  struct Built {
    std::shared_ptr<const Scene> scene;
    std::vector<ModelId> models;
    std::vector<std::shared_ptr<const ModelDef>> defs;
    std::uint64_t version = 0;
  };
  bool is_current(const Built& built) const;
  void build(Built& built, Scene::Content content);

  const Physics& physics_;
  const WorldDef& world_;
  std::vector<ActorMotion> motions_;  // of the actors
  Assets assets_;
  Built visuals_, collisions_;
  bool is_synchronous_ = false;
};

}  // namespace sim
