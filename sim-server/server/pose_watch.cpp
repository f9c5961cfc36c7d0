#include "server/pose_watch.h"

#include <algorithm>

namespace sim {

void PoseWatch::look_at_contacts(double time, const Physics& physics, const std::vector<PoseSink*>& sinks) {
  std::set<std::pair<ModelId, ModelId>> now;
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id) || physics.is_static(id)) continue;
    for (const Contact& contact : physics.contacts(id)) {
      const ModelId other = contact.link.model == id ? contact.other.model : contact.link.model;
      if (other == id || !physics.exists(other)) continue;
      const auto pair = std::minmax(id, other);
      if (!now.insert(pair).second || touching_.contains(pair)) continue;
      for (auto* sink : sinks) sink->contact(time, id, other, physics);
    }
  }
  touching_ = std::move(now);
}

void PoseWatch::look(std::chrono::nanoseconds time, const Physics& physics, const std::vector<PoseSink*>& sinks) {
  const double seconds = static_cast<double>(time.count()) * 1e-9;
  look_at_contacts(seconds, physics, sinks);
  if (!schedule_.is_due(time)) return;
  schedule_.done(time);
  bool is_empty = true;
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id) || physics.is_static(id)) continue;
    is_empty = false;
    for (auto* sink : sinks) sink->pose(seconds, id, physics);
  }
  for (auto* sink : sinks) {
    if (is_empty) sink->still(seconds);
    sink->end_of_moment();
  }
}

}  // namespace sim
