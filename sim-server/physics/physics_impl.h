// The parts of a physics world. Included by the files of Physics alone.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "physics/neighbours.h"
#include "physics/physics.h"
#include "physics/shard.h"
#include "physics/weld.h"

namespace sim {

inline bool is_sane(const Eigen::Vector3d& v, double limit) { return v.allFinite() && v.cwiseAbs().maxCoeff() <= limit; }

class Physics::Impl {
 public:
  Impl(std::shared_ptr<const WorldDef> world, WorkerPool& pool, TriangleCache& triangles)
      : world_(std::move(world)), pool_(pool), store_(triangles) {}

  void build(std::vector<std::string>& notes, std::vector<std::string>* dropped);
  void add(ModelId id, std::shared_ptr<const Blueprint> blueprint, std::vector<std::string>& lost);
  void step();
  void put_back_insane(Shard& shard);
  // After the poses or the number of static shapes changed: everybody looks round again.
  void refresh_statics();
  void partition();
  void let_roll(ModelInstance& model) const;
  void move_to(ModelInstance& model, int shard);
  void update_neighbourhood(ModelInstance& model);
  void share_out(std::vector<std::uint32_t>& parents);
  bool has_bodies(const ModelInstance& model) const { return !model.blueprint().is_static; }
  ModelInstance& at(ModelId id) const { return *models_[id]; }
  template <class Condition>
  void drop_welds(const Condition& condition);

  std::shared_ptr<const WorldDef> world_;
  WorkerPool& pool_;
  WorkerPool::Pace pace_;
  ShapeStore store_;
  std::vector<std::shared_ptr<const Blueprint>> initial_;  // by ModelId; null: cannot be simulated
  std::vector<std::unique_ptr<Shard>> shards_;             // outlive the models
  std::vector<std::unique_ptr<ModelInstance>> models_;
  std::vector<std::unique_ptr<Weld>> welds_;  // in the order in which they were made
  std::vector<ShapeInstance*> statics_;
  StaticIndex static_index_;
  Wind wind_{{}, 1};
  std::uint64_t steps_ = 0;
  std::uint32_t moves_ = 0;
  bool may_roll_ = false;
  bool is_crowding_told_ = false;
  std::vector<std::string> complaints_;
};

// Those that hold what has gone, or been put elsewhere. Both models notice.
template <class Condition>
void Physics::Impl::drop_welds(const Condition& condition) {
  std::erase_if(welds_, [&](const std::unique_ptr<Weld>& weld) {
    if (!condition(*weld)) return false;
    for (ModelInstance* model : {&weld->first(), &weld->second()}) {
      std::erase(model->welds, weld.get());
      if (has_bodies(*model)) model->wake();
    }
    return true;
  });
}

}  // namespace sim
