#include "server/deleted_models.h"

#include <algorithm>

namespace sim {

void DeletedModels::keep(const Physics& physics, ModelId model) {
  constexpr std::size_t most = 32;
  ModelDef def = physics.def(model);
  def.pose = physics.model_pose(model);
  for (std::uint32_t i = 0; i < def.links.size() && !physics.is_static(model); ++i) {
    LinkDef& link = def.links[i];
    const Eigen::Isometry3d place = def.pose.inverse() * physics.link_pose({model, i});
    link.start_pose.reset();
    if (!place.isApprox(link.pose, 1e-6)) link.start_pose = place;
    const Twist twist = physics.link_twist({model, i});
    link.start_linear = twist.linear;
    link.start_angular = twist.angular;
  }
  if (models_.size() == most) models_.erase(models_.begin());
  models_.push_back(std::move(def));
}

const ModelDef* DeletedModels::find(std::string_view name) const {
  const auto found = std::find_if(models_.rbegin(), models_.rend(), [&](const ModelDef& model) { return model.name == name; });
  return found == models_.rend() ? nullptr : &*found;
}

}  // namespace sim
