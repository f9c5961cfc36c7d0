// Turning definitions into drawables.
#include "render/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "render/lights.h"

namespace sim {
namespace {

Material to_material(const MaterialDef& in, double transparency, Assets& assets) {
  Material out;
  const float alpha = in.diffuse.a * static_cast<float>(1 - std::clamp(transparency, 0.0, 1.0));
  out.albedo.head<3>() = linear(in.diffuse);
  out.albedo.w() = alpha;
  out.emissive = linear(in.emissive);
  out.specular = linear(in.specular);
  out.shininess = in.shininess;
  if (in.has_pbr) {
    // A rough equal of the metal and roughness model in terms of a Blinn-Phong lobe that keeps its energy.
    const float roughness = std::clamp(in.roughness, 0.08F, 1.0F);
    out.shininess = 2.0F / std::pow(roughness, 4.0F) - 2.0F;
    const float peak = (out.shininess + 8.0F) / 25.0F;
    const Eigen::Vector3f reflected =
        Eigen::Vector3f::Constant(0.04F) + in.metalness * (Eigen::Vector3f(out.albedo.head<3>()) - Eigen::Vector3f::Constant(0.04F));
    out.specular = reflected * std::min(peak, 20.0F);
    out.albedo.head<3>() *= 1.0F - 0.4F * in.metalness;  // what else is around is not mirrored, so all of it would be too dark
  }
  if (out.shininess <= 0) out.specular.setZero();
  if (!in.texture.empty()) out.texture = assets.texture(in.texture, in.has_alpha_texture);
  if (!in.normal_map.empty()) out.normal_map = assets.normal_map(in.normal_map);
  if (!in.emissive_map.empty()) {
    out.emissive_map = assets.texture(in.emissive_map);
    if (out.emissive.isZero()) out.emissive.setOnes();
  }
  // All maps of a surface lie on it as its colours do.
  if (!out.texture && (out.normal_map || out.emissive_map)) out.texture = assets.white();
  out.repeat = in.texture_scale.cast<float>();
  out.is_lit = in.lighting;
  out.is_double_sided = in.double_sided || (out.texture && out.texture->has_holes);
  out.is_transparent = alpha < 0.999F || (out.texture && out.texture->is_translucent);
  return out;
}

// A visual's own material replaces the mesh's; a missing mesh keeps its warning colour.
MaterialDef material_of(const VisualDef& visual, const Mesh& mesh, std::uint32_t part) {
  return visual.material && !mesh.is_stand_in ? *visual.material : mesh.parts[part].material;
}

constexpr double whole_plane = 200;  // [m] of an infinite one that are drawn

VisualDef as_visual(const CollisionDef& collision) {
  VisualDef visual;
  visual.name = collision.name;
  visual.pose = collision.pose;
  visual.geometry = collision.geometry;
  // Bodies stand on all of it, whatever is drawn of its visual.
  if (auto* plane = std::get_if<PlaneShape>(&visual.geometry)) plane->size = plane->size.cwiseMax(whole_plane);
  visual.material = MaterialDef{};
  visual.material->diffuse = {1.0F, 0.55F, 0.1F, 1};
  return visual;
}

class Builder {
 public:
  Builder(Assets& assets, Scene::Content content) : assets_(assets), content_(content) {}

  void add(const ModelDef& model) {
    SceneModel entry;
    entry.name = model.name;
    entry.first_link = entry.canonical_link = static_cast<std::uint32_t>(scene_.links.size());
    entry.link_count = static_cast<std::uint32_t>(model.links.size());
    objects_.clear();
    model_ = &model;
    first_link_ = entry.first_link;
    for (const auto& link : model.links) {
      const auto index = static_cast<std::uint32_t>(scene_.links.size());
      if (link.name == model.canonical_link) {
        entry.canonical_link = index;
        entry.frame = link.pose.inverse();
      }
      scene_.links.push_back({model.name + "::" + link.name, model.is_static, model.pose * link.pose});
      if (content_ == Scene::Content::visuals) {
        bool has_stand_in = false;
        for (const auto& visual : link.visuals) {
          if (assets_.mesh(visual.geometry)->is_stand_in) {
            add_stand_in(link, visual, index, has_stand_in);
          } else {
            add(visual, index);
          }
        }
      } else {
        for (const auto& collision : link.collisions) add(as_visual(collision), index);
      }
      for (const auto& light : link.lights) scene_.lights.push_back({light, static_cast<std::int32_t>(index)});
    }
    measure(entry);
    scene_.models.push_back(std::move(entry));
  }

  void add(const ActorDef& actor) {
    SceneModel entry;
    entry.name = actor.name;
    entry.first_link = entry.canonical_link = static_cast<std::uint32_t>(scene_.links.size());
    entry.link_count = 1;
    const auto index = entry.first_link;
    scene_.links.push_back({actor.name, false, actor.pose});
    SceneActor seen;
    seen.link = index;
    seen.skin = actor.skin.empty() ? nullptr : assets_.skin(actor.skin, actor.skin_scale);
    if (seen.skin) add_skin(actor, seen);
    if (!actor.skin.empty() && !seen.skin && content_ == Scene::Content::visuals) {
      VisualDef missing;
      missing.geometry = MeshShape{missing_file, {}, false, Eigen::Vector3d::Ones()};
      add(missing, index);
    }
    objects_.clear();
    model_ = nullptr;
    for (auto visual : actor.visuals) {
      if (visual.label == 0) visual.label = actor.label;
      if (content_ == Scene::Content::visuals) add(visual, index);  // actors are met by nothing
    }
    entry.link_count = static_cast<std::uint32_t>(scene_.links.size()) - index;
    measure(entry);
    scene_.models.push_back(std::move(entry));
    scene_.actors.push_back(std::move(seen));
  }

  // A large level sheet of something static, with nothing below it, is ground: it could only shade itself.
  void mark_grounds() {
    constexpr double smallest = 20, thickest = 0.05, deepest = 0.5;  // [m]
    std::vector<Eigen::AlignedBox3d> boxes;
    double lowest = infinite;
    for (const auto& drawable : scene_.drawables) {
      boxes.push_back(drawable.bounds_at(scene_.links[drawable.link].start));
      if (!drawable.is_ground) lowest = std::min(lowest, boxes.back().min().z());
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Eigen::Vector3d size = boxes[i].sizes();
      if (scene_.links[scene_.drawables[i].link].is_static && std::min(size.x(), size.y()) >= smallest && size.z() <= thickest &&
          boxes[i].max().z() < lowest + deepest)
        scene_.drawables[i].is_ground = true;
      // What stands on it must be seen.
      if (scene_.drawables[i].is_ground && content_ == Scene::Content::collisions)
        scene_.drawables[i].material.albedo.head<3>() = linear({0.6F, 0.6F, 0.58F, 1});
    }
    rank_grounds(boxes);
  }

  Scene& scene() { return scene_; }

 private:
  void rank_grounds(const std::vector<Eigen::AlignedBox3d>& boxes) {
    constexpr int max_ranks = 8;
    std::vector<std::size_t> grounds;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (scene_.drawables[i].is_ground) grounds.push_back(i);
    }
    const auto area = [&](std::size_t i) { return boxes[i].sizes().x() * boxes[i].sizes().y(); };
    std::stable_sort(grounds.begin(), grounds.end(), [&](std::size_t a, std::size_t b) { return area(a) < area(b); });
    for (std::size_t i = 0; i < grounds.size(); ++i)
      scene_.drawables[grounds[i]].ground_rank = std::min(static_cast<int>(i) + 1, max_ranks);
  }

  // Of a link with meshes that cannot be read the shapes that bodies meet are drawn instead, in grey; a magenta box if there are none.
  void add_stand_in(const LinkDef& link, const VisualDef& visual, std::uint32_t index, bool& has_one) {
    const auto is_shape = [&](const CollisionDef& collision) { return !assets_.mesh(collision.geometry)->is_stand_in; };
    if (std::none_of(link.collisions.begin(), link.collisions.end(), is_shape)) return add(visual, index);
    if (std::exchange(has_one, true)) return;
    for (const auto& collision : link.collisions) {
      if (!is_shape(collision)) continue;
      VisualDef shape = as_visual(collision);
      shape.material->diffuse = {0.6F, 0.6F, 0.62F, 1};
      shape.visibility_flags = visual.visibility_flags;
      add(shape, index);
    }
  }

  void add_skin(const ActorDef& actor, SceneActor& seen) {
    const Skin& skin = seen.skin->skin;
    for (const auto& animation : actor.animations) seen.animations.push_back(assets_.animation(animation.path, animation.scale, seen.skin));
    auto mesh = std::make_shared<Mesh>(seen.skin->mesh);
    hold_all(*mesh, skin, seen.animations, !actor.trajectories.empty());
    seen.mesh = mesh;
    const auto bones = bone_poses(skin, nullptr, 0, false);
    for (std::size_t i = 0; i < bones.size(); ++i)
      scene_.links.push_back({actor.name + "::" + skin.nodes[skin.bones[i].node].name, false, actor.pose * bones[i]});
    if (content_ != Scene::Content::visuals) return;
    objects_.clear();
    model_ = nullptr;
    VisualDef whole;
    whole.label = actor.label;
    add(whole, seen.link, mesh);
  }

  // Bounds that hold every pose of the animations.
  static void hold_all(Mesh& mesh, const Skin& skin, const std::vector<std::shared_ptr<const SkinAnimation>>& animations, bool stays) {
    constexpr int looks = 16;
    constexpr float room = 1.05F;
    std::vector<Vertex> bent;
    for (const auto& animation : animations) {
      for (int look = 0; look < looks && animation; ++look) {
        bend(skin, bone_poses(skin, animation.get(), animation->length * look / looks, stays), bent);
        for (auto& part : mesh.parts) {
          for (std::uint32_t i = 0; i < part.index_count; ++i)
            part.bounds.extend(Eigen::Map<const Eigen::Vector3f>(bent[mesh.indices[part.first_index + i]].position.data()));
        }
      }
    }
    for (auto& part : mesh.parts) {
      const Eigen::Vector3f middle = part.bounds.center(), half = 0.5F * room * part.bounds.sizes();
      part.bounds = Eigen::AlignedBox3f(Eigen::Vector3f(middle - half), Eigen::Vector3f(middle + half));
      part.is_faceted = false;
      mesh.bounds.extend(part.bounds);
    }
  }

  void add(const VisualDef& visual, std::uint32_t link) { add(visual, link, assets_.mesh(visual.geometry)); }

  void add(const VisualDef& visual, std::uint32_t link, const std::shared_ptr<const Mesh>& mesh) {
    const auto index = static_cast<std::uint32_t>(scene_.visuals.size());
    scene_.visuals.push_back(seen_as(visual, link));
    const auto* plane = std::get_if<PlaneShape>(&visual.geometry);
    const auto* heightmap = std::get_if<HeightmapShape>(&visual.geometry);
    for (std::uint32_t part = 0; part < mesh->parts.size(); ++part) {
      Drawable drawable;
      drawable.visual = index;
      drawable.link = link;
      drawable.in_link = Eigen::Affine3d(visual.pose.matrix()) * Assets::placement_of(visual.geometry);
      drawable.mesh = mesh;
      drawable.part = part;
      drawable.material = to_material(material_of(visual, *mesh, part), visual.transparency, assets_);
      if (heightmap != nullptr && content_ == Scene::Content::visuals) {
        if (auto texture = assets_.height_texture(*heightmap)) {
          drawable.material.texture = std::move(texture);
          if (!visual.material) drawable.material.albedo = {1, 1, 1, 1};
        }
      }
      drawable.casts_shadow = visual.cast_shadows && plane == nullptr && visual.transparency < 0.9;
      drawable.is_ground = drawable.has_grid = plane != nullptr;
      drawable.is_mirrored = drawable.in_link.linear().determinant() < 0;
      drawable.visibility_flags = visual.visibility_flags;
      const Eigen::AlignedBox3d box = drawable.bounds();
      drawable.centre = drawable.in_link * box.center();
      drawable.radius = (drawable.in_link.linear() * (0.5 * box.sizes()).asDiagonal()).rowwise().norm().norm();
      if (const auto object = scene_.visuals[index].object; object != 0)
        scene_.objects[object - 1].drawables.push_back(static_cast<std::uint32_t>(scene_.drawables.size()));
      scene_.drawables.push_back(std::move(drawable));
    }
  }

  SceneVisual seen_as(const VisualDef& visual, std::uint32_t link) {
    SceneVisual seen;
    if (visual.label != 0) seen.object = 1 + object_of(visual, link);
    if (!visual.heat) return seen;
    seen.has_heat = true;
    seen.lowest = visual.heat->lowest;
    seen.highest = visual.heat->highest;
    if (!visual.heat->signature.empty()) seen.signature = assets_.texture(visual.heat->signature, false);
    return seen;
  }

  // That of the model or actor which is being added.
  std::uint32_t object_of(const VisualDef& visual, std::uint32_t link) {
    const auto known = objects_.find(visual.labelled);
    if (known != objects_.end()) return known->second;
    const auto index = static_cast<std::uint32_t>(scene_.objects.size());
    SceneObject object;
    object.label = visual.label;
    object.number = ++numbers_[visual.label];
    object.link = link;
    const std::string& owner = model_ != nullptr ? model_->name : scene_.links[link].name;
    object.name = visual.labelled.empty() ? owner : owner + "::" + visual.labelled;
    if (model_ != nullptr) place(object, visual);
    objects_.emplace(visual.labelled, index);
    scene_.objects.push_back(std::move(object));
    return index;
  }

  // Of the model itself, a nested one, or a visual.
  void place(SceneObject& object, const VisualDef& visual) const {
    if (visual.labelled.empty()) {
      const LinkDef* canonical = model_->link(model_->canonical_link);
      object.link = first_link_ + static_cast<std::uint32_t>(canonical != nullptr ? canonical - model_->links.data() : 0);
      object.frame = (canonical != nullptr ? *canonical : model_->links.front()).pose.inverse();
      return;
    }
    for (const NestedDef& nested : model_->nested) {
      if (nested.name != visual.labelled) continue;
      object.link = first_link_ + nested.link;
      object.frame = nested.pose;
      return;
    }
    object.frame = visual.pose;
  }

  void measure(SceneModel& model) const {
    const Eigen::Isometry3d& origin = scene_.links[model.canonical_link].start;
    for (const auto& drawable : scene_.drawables) {
      if (drawable.link < model.first_link || drawable.link >= model.first_link + model.link_count || drawable.is_ground) continue;
      const Eigen::Isometry3d& pose = scene_.links[drawable.link].start;
      model.radius = std::max(model.radius, (pose * drawable.centre - origin.translation()).norm() + drawable.radius);
      const Eigen::Matrix3d turned = pose.linear() * drawable.in_link.linear();
      const double half = (turned * (0.5 * drawable.bounds().sizes()).asDiagonal()).row(2).cwiseAbs().sum();
      model.height = std::max(model.height, (pose * drawable.centre - origin.translation()).z() + half);
    }
  }

  Assets& assets_;
  Scene::Content content_;
  Scene scene_;
  const ModelDef* model_ = nullptr;               // that is being added; null: an actor
  std::uint32_t first_link_ = 0;                  // of it
  std::map<std::string, std::uint32_t> objects_;  // its own, by VisualDef::labelled
  std::array<std::uint32_t, 256> numbers_{};      // objects so far, by label
};

}  // namespace

Eigen::AlignedBox3d Drawable::bounds() const { return mesh->parts[part].bounds.cast<double>(); }

Eigen::AlignedBox3d Drawable::bounds_at(const Eigen::Isometry3d& link_pose) const {
  const Eigen::Vector3d middle = link_pose * centre;
  const Eigen::Vector3d half = (link_pose.linear() * in_link.linear() * (0.5 * bounds().sizes()).asDiagonal()).cwiseAbs().rowwise().sum();
  return {Eigen::Vector3d(middle - half), Eigen::Vector3d(middle + half)};
}

std::shared_ptr<const Scene> Scene::build(const Parts& parts, Assets& assets, Content content) {
  Builder builder(assets, content);
  builder.scene().look = parts.look;
  for (const auto* light : parts.lights) builder.scene().lights.push_back({*light, -1});
  for (const auto* model : parts.models) builder.add(*model);
  for (const auto* actor : parts.actors) builder.add(*actor);
  builder.mark_grounds();
  return std::make_shared<Scene>(std::move(builder.scene()));
}

std::shared_ptr<const Scene> Scene::build(const WorldDef& world, Assets& assets, Content content) {
  Parts parts{world.scene, {}, {}, {}};
  for (const auto& light : world.lights) parts.lights.push_back(&light);
  for (const auto& model : world.models) parts.models.push_back(&model);
  for (const auto& actor : world.actors) parts.actors.push_back(&actor);
  return build(parts, assets, content);
}

std::vector<Eigen::Isometry3d> Scene::start_poses() const {
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(links.size());
  for (const auto& link : links) poses.push_back(link.start);
  return poses;
}

Eigen::AlignedBox3d Scene::bounds(std::span<const Eigen::Isometry3d> poses) const {
  Eigen::AlignedBox3d box;
  for (const auto& drawable : drawables) {
    if (drawable.is_ground || drawable.link >= poses.size()) continue;
    box.extend(drawable.bounds_at(poses[drawable.link]));
  }
  return box;
}

}  // namespace sim
