#include "world/unseen_models.h"

#include <algorithm>

#include "base/text.h"

namespace sim {

namespace {

bool has_visual_lidar(const ModelDef& model) {
  return std::any_of(model.links.begin(), model.links.end(), [](const LinkDef& link) {
    return std::any_of(link.sensors.begin(), link.sensors.end(),
                       [](const SensorDef& sensor) { return sensor.kind == SensorKind::ray && sensor.type.starts_with("gpu_"); });
  });
}

bool is_only_seen(const ModelDef& model) {
  const auto has_visuals = [](const LinkDef& link) { return !link.visuals.empty(); };
  const auto has_collisions = [](const LinkDef& link) { return !link.collisions.empty(); };
  return std::any_of(model.links.begin(), model.links.end(), has_visuals) &&
         std::none_of(model.links.begin(), model.links.end(), has_collisions);
}

}  // namespace

void tell_of_unseen_models(const WorldDef& world, Complaints& complaints) {
  const auto seer = std::find_if(world.models.begin(), world.models.end(), has_visual_lidar);
  if (seer == world.models.end()) return;
  const auto unseen = std::find_if(world.models.begin(), world.models.end(), is_only_seen);
  if (unseen == world.models.end()) return;
  const auto count = std::count_if(unseen, world.models.end(), is_only_seen);
  complaints.add(Finding::Severity::note, {unseen->source, 0},
                 "lidars meet collisions, not visuals: that of model " + base::in_quotes(seer->name) + " does not see model " +
                     base::in_quotes(unseen->name) + ", which has none" +
                     (count > 1 ? ", nor " + std::to_string(count - 1) + " other" + (count > 2 ? "s" : "") + " like it" : std::string()));
}

}  // namespace sim
