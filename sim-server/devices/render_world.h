// The world for images: a scene that follows models as they are added and deleted, and their poses. The stepping thread only; its snapshots
// never change, and any thread may keep them.
//
// The files of meshes and images are read with the first image. They may take as long as thousands of steps, so a thread of its own reads
// them (prepare). States of a content, visuals or collisions:
//   unread    some file of its models has not been read. prepare() -> reading
//   reading   prepare() returns false. The thread calls on_read's function when it is done -> read
//   read      prepare() returns true; snapshot() reads no file, until a model is added that brings files -> unread
// snapshot() is right in each state: it waits for the thread, and reads the remaining files itself. So simulated time that waits for images
// (lock step) does not depend on how long files take. A file that cannot be read counts as read. Results of the thread are not visible
// before it is done.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <thread>
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

  // Whether snapshot() reads no file; else a thread begins to read them.
  bool prepare(Scene::Content content);
  // Called in the reading thread when it is done. Waits for that thread.
  void on_read(std::function<void()> call);

  // The world as it is now. Builds the scene anew when models have come or gone; what could not be read is logged, once each.
  Snapshot snapshot(std::chrono::nanoseconds time, Scene::Content content = Scene::Content::visuals);

  // The contents that somebody has asked for: a model that is spawned should bring what is drawn of it.
  std::vector<Scene::Content> contents() const;
  // Read by another thread for a model that is to be spawned; then all that is drawn of it has been read.
  void adopt(Assets&& assets) { assets_.adopt(std::move(assets)); }
  void has_read(ModelId model, Scene::Content content);

  // True (lock step, as fast as possible): pictures are finished before time goes on. False: each camera draws in its own time.
  void set_synchronous(bool on) { is_synchronous_ = on; }
  bool is_synchronous() const { return is_synchronous_; }

 private:
  struct Built {
    std::shared_ptr<const Scene> scene;
    std::vector<ModelId> models;
    std::vector<std::shared_ptr<const ModelDef>> defs;
    std::vector<std::shared_ptr<const ModelDef>> read;  // since the scene was built
    bool has_actors = false;                            // theirs were read
    std::uint64_t version = 0;
  };
  // Of which files are read in the thread.
  struct Unread {
    Scene::Content content;
    std::vector<std::shared_ptr<const ModelDef>> models;
    std::vector<const ActorDef*> actors;
  };
  Built& of(Scene::Content content) { return content == Scene::Content::visuals ? visuals_ : collisions_; }
  bool is_current(const Built& built) const;
  void build(Built& built, Scene::Content content);
  Unread unread(Scene::Content content);
  void start_reading(Unread files);
  // What the thread has read, if it is done.
  void take_read();

  const Physics& physics_;
  const WorldDef& world_;
  std::vector<ActorMotion> motions_;  // of the actors
  Assets assets_;
  Built visuals_, collisions_;
  bool is_synchronous_ = false;
  std::function<void()> on_read_;
  std::optional<Unread> reading_;
  std::future<Assets> result_;  // of reading_
  std::jthread thread_;         // last: ends before what it uses
};

}  // namespace sim
