#include "devices/render_world.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"

namespace sim {
namespace {

// The actor, then its bones.
void add_poses(const SceneActor& seen, const ActorDef& actor, const ActorMoment& now, std::vector<Eigen::Isometry3d>& poses) {
  poses.push_back(now.pose);
  if (!seen.skin) return;
  const SkinAnimation* animation = now.animation ? seen.animations[*now.animation].get() : nullptr;
  double seconds = 0;
  if (animation != nullptr) {
    const bool by_distance = actor.animations[*now.animation].interpolate_x && animation->stride != 0 && !actor.trajectories.empty();
    seconds = by_distance ? time_at_distance(*animation, now.distance) : std::fmod(now.seconds, animation->length);
  }
  for (const auto& bone : bone_poses(seen.skin->skin, animation, seconds, !actor.trajectories.empty())) poses.push_back(now.pose * bone);
}

}  // namespace

RenderWorld::RenderWorld(const Physics& physics, const WorldDef& world) : physics_(physics), world_(world), assets_(world.model_path) {
  for (const auto& actor : world.actors) motions_.emplace_back(actor);
}

bool RenderWorld::is_current(const Built& built) const {
  if (!built.scene) return false;
  std::size_t count = 0;
  for (ModelId id = 0; id < physics_.model_slots(); ++id) {
    if (!physics_.exists(id)) continue;
    // The definition is compared too: after a reset an id may stand for another model.
    if (count >= built.models.size() || built.models[count] != id || built.defs[count].get() != &physics_.def(id)) return false;
    ++count;
  }
  return count == built.models.size();
}

void RenderWorld::build(Built& built, Scene::Content content) {
  built.models.clear();
  built.defs.clear();
  Scene::Parts parts{world_.scene, {}, {}, {}};
  for (const auto& light : world_.lights) parts.lights.push_back(&light);
  for (ModelId id = 0; id < physics_.model_slots(); ++id) {
    if (!physics_.exists(id)) continue;
    built.models.push_back(id);
    built.defs.push_back(physics_.shared_def(id));
    parts.models.push_back(built.defs.back().get());
  }
  for (const auto& actor : world_.actors) parts.actors.push_back(&actor);
  built.scene = Scene::build(parts, assets_, content);
  ++built.version;
  for (const auto& complaint : assets_.take_complaints()) base::log(base::Level::warn, "render", "{}", complaint);
}

Snapshot RenderWorld::snapshot(std::chrono::nanoseconds time, Scene::Content content) {
  Built& built = content == Scene::Content::visuals ? visuals_ : collisions_;
  if (!is_current(built)) build(built, content);
  auto poses = std::make_shared<std::vector<Eigen::Isometry3d>>();
  poses->reserve(built.scene->links.size());
  for (const auto id : built.models) {
    const auto links = static_cast<std::uint32_t>(physics_.def(id).links.size());
    for (std::uint32_t link = 0; link < links; ++link) poses->push_back(physics_.link_pose({id, link}));
  }
  const double seconds = std::chrono::duration<double>(time).count();
  for (std::size_t i = 0; i < motions_.size(); ++i) add_poses(built.scene->actors[i], world_.actors[i], motions_[i].at(seconds), *poses);
  return {built.scene, std::move(poses), built.models, built.version};
}

}  // namespace sim
