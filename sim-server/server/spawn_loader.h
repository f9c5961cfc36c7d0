// Reads models that are to be spawned, in a thread of its own: their files can take as long as thousands of steps. The simulation
// continues meanwhile, except in lock step. The stepping thread only, but for what `on_done` does.
//
// States of an order: taken, read (its model and all that its shapes need, or an error), finished. Orders are read in the order in which
// they come. The stepping thread does not see data of the loader's thread before finished() returns it.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/guarded.h"
#include "render/assets.h"
#include "render/scene.h"
#include "shm/request_board.h"
#include "world/triangles.h"
#include "world/world_loader.h"

namespace sim {

class SpawnLoader {
 public:
  // Called on the loader's thread after each model.
  explicit SpawnLoader(std::function<void()> on_done);
  // Waits for the model that is being read: AssetReader::stop() before gives it up.
  ~SpawnLoader();
  SpawnLoader(const SpawnLoader&) = delete;
  SpawnLoader& operator=(const SpawnLoader&) = delete;

  struct Order {
    shm::RequestTicket ticket;
    std::string model;  // as load_model() takes it
    std::string name;   // empty: its own
    std::optional<Eigen::Isometry3d> pose;
    ModelPath model_path;
    ModelPath world_path;               // of pictures that mesh files name
    std::vector<Scene::Content> drawn;  // now: their files are read, too
    std::string gains{}, joints{};      // as in shm::SpawnRequest
  };
  void take(Order order);

  struct Done {
    shm::RequestTicket ticket;
    base::Result<LoadedModel> model;
    bool has_own_name = false;
    TriangleCache triangles;
    std::unique_ptr<Assets> pictures;   // null: nothing is drawn
    std::vector<Scene::Content> drawn;  // what the pictures are of
  };
  // One load when nothing is ordered.
  std::vector<Done> finished();
  // Orders that finished() has not handed over.
  std::size_t under_way() const { return under_way_; }

 private:
  struct State {
    std::vector<Order> orders;
    std::vector<Done> done;
    bool is_ending = false;
  };
  void run();

  std::function<void()> on_done_;
  std::size_t under_way_ = 0;
  base::Guarded<State, base::Rank::queue> state_;
  std::condition_variable changed_;
  std::jthread thread_;  // last: ends before what it uses
};

}  // namespace sim
