// Keeps the rays' view of the world in step with the physics: one body for each rigid piece of each model. One thread at a time; tracing in
// scene() is for any number of threads between two updates.
#pragma once

#include <string>
#include <vector>

#include "physics/physics.h"
#include "rays/ray_scene.h"

namespace sim {

class RayWorld {
 public:
  RayWorld(const Physics& physics, TriangleCache& triangles);

  void add(ModelId model, std::vector<std::string>& notes);
  void remove(ModelId model);
  // Everything is where the physics has it now.
  void update();
  // The model's static pieces stand elsewhere.
  void moved(ModelId model);

  const RayScene& scene() const { return scene_; }
  // The sensor looks out of the shapes of its own rigid piece that enclose it.
  void look_out_of_casing(LinkId link, const Eigen::Isometry3d& pose_in_link, Beams& beams);

 private:
  struct Piece {
    ModelId model;
    std::uint32_t piece;
    RayBodyId body;
    bool is_moving;
  };
  std::vector<RayShape> shapes_of(ModelId model, std::uint32_t piece) const;

  const Physics& physics_;
  RayScene scene_;
  std::vector<Piece> pieces_;
};

}  // namespace sim
