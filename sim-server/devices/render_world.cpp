#include "devices/render_world.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <unordered_set>
#include <utility>

#include "base/log.h"
#include "base/text.h"

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

bool needs_files(const GeometryDef& geometry) {
  return std::holds_alternative<MeshShape>(geometry) || std::holds_alternative<HeightmapShape>(geometry);
}
bool needs_files(const VisualDef& visual) {
  const auto& material = visual.material;
  return needs_files(visual.geometry) || (visual.heat && !visual.heat->signature.empty()) ||
         (material && !(material->texture.empty() && material->normal_map.empty() && material->emissive_map.empty()));
}
bool needs_files(const ModelDef& model, Scene::Content content) {
  return std::ranges::any_of(model.links, [&](const LinkDef& link) {
    if (content == Scene::Content::visuals) return std::ranges::any_of(link.visuals, [](const auto& v) { return needs_files(v); });
    return std::ranges::any_of(link.collisions, [](const auto& c) { return needs_files(c.geometry); });
  });
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
  built.read.clear();
  built.has_actors = true;
  ++built.version;
  for (const auto& complaint : assets_.take_complaints()) base::log(base::Level::warn, "render", "{}", complaint);
}

RenderWorld::Unread RenderWorld::unread(Scene::Content content) {
  Unread files{content, {}, {}};
  const Built& built = of(content);
  std::unordered_set<const ModelDef*> known;
  for (const auto* models : {&built.defs, &built.read})
    for (const auto& model : *models) known.insert(model.get());
  for (ModelId id = 0; id < physics_.model_slots(); ++id) {
    if (!physics_.exists(id) || known.contains(&physics_.def(id)) || !needs_files(physics_.def(id), content)) continue;
    files.models.push_back(physics_.shared_def(id));
  }
  for (const auto& actor : world_.actors)
    if (!built.has_actors) files.actors.push_back(&actor);
  return files;
}

void RenderWorld::start_reading(Unread files) {
  Scene::Parts parts{world_.scene, {}, {}, files.actors};
  for (const auto& model : files.models) parts.models.push_back(model.get());
  std::packaged_task<Assets()> task([parts = std::move(parts), content = files.content, path = world_.model_path] {
    Assets assets(path);
    (void)Scene::build(parts, assets, content);
    return assets;
  });
  result_ = task.get_future();
  reading_ = std::move(files);  // keeps the models of `parts`
  thread_ = std::jthread([task = std::move(task), call = on_read_]() mutable {
    task();
    if (call) call();
  });
}

void RenderWorld::take_read() {
  if (!reading_ || result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  const Unread files = *std::exchange(reading_, std::nullopt);
  try {
    assets_.adopt(result_.get());
  } catch (const std::exception& e) {  // such as a lack of memory
    base::log(base::Level::error, "render", "files of meshes and images: {}", base::in_quotes(e.what()));
  }
  Built& built = of(files.content);
  built.read.insert(built.read.end(), files.models.begin(), files.models.end());
  built.has_actors = built.has_actors || !files.actors.empty();
}

bool RenderWorld::prepare(Scene::Content content) {
  if (is_current(of(content))) return true;
  take_read();
  if (reading_) return false;
  Unread files = unread(content);
  if (files.models.empty() && files.actors.empty()) return true;
  start_reading(std::move(files));
  return false;
}

void RenderWorld::on_read(std::function<void()> call) {
  if (thread_.joinable()) thread_.join();
  on_read_ = std::move(call);
}

void RenderWorld::has_read(ModelId model, Scene::Content content) {
  auto& read = of(content).read;
  std::erase_if(read, [](const auto& def) { return def.use_count() == 1; });  // deleted since
  read.push_back(physics_.shared_def(model));
}

std::vector<Scene::Content> RenderWorld::contents() const {
  std::vector<Scene::Content> contents;
  for (const auto content : {Scene::Content::visuals, Scene::Content::collisions}) {
    const Built& built = content == Scene::Content::visuals ? visuals_ : collisions_;
    if (built.scene || (reading_ && reading_->content == content)) contents.push_back(content);
  }
  return contents;
}

Snapshot RenderWorld::snapshot(std::chrono::nanoseconds time, Scene::Content content) {
  Built& built = of(content);
  if (!is_current(built)) {
    if (reading_) result_.wait();
    take_read();
    build(built, content);
  }
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
