// A world as the renderer sees it: things to draw, each hanging on a link, and lights. Built from the definition of a world; afterwards it
// never changes and any thread may read it. The poses of the links come with every picture: one per link in the order of Scene::links.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/assets.h"
#include "render/skin.h"
#include "world/world_def.h"

namespace sim {

// Colours here are linear light.
struct Material {
  Eigen::Vector4f albedo{0.45F, 0.45F, 0.45F, 1};  // and opacity
  Eigen::Vector3f emissive{0, 0, 0};
  Eigen::Vector3f specular{0, 0, 0};
  float shininess = 0;
  std::shared_ptr<const Texture> texture, normal_map, emissive_map;  // may be null
  Eigen::Vector2f repeat{1, 1};                                      // of the texture along u and v
  bool is_lit = true;
  bool is_double_sided = false;
  bool is_transparent = false;  // drawn after all others, from far to near
};

struct Drawable {
  std::uint32_t visual = 0;                               // index into Scene::visuals
  std::uint32_t link = 0;                                 // index into Scene::links and into the poses
  Eigen::Affine3d in_link = Eigen::Affine3d::Identity();  // from the mesh to the link
  std::shared_ptr<const Mesh> mesh;
  std::uint32_t part = 0;  // of the mesh
  Material material;
  Eigen::Vector3d centre{0, 0, 0};  // of the bounding sphere, in the link
  double radius = 0;
  bool casts_shadow = true;
  bool is_ground = false;    // a plane or a large level sheet below everything: never in the shadow pass
  int ground_rank = 0;       // of a ground: 1 for the smallest; where two are in one plane, the lower rank is seen. 0: no ground
  bool has_grid = false;     // a plane: shows metre lines when a view asks for them
  bool is_mirrored = false;  // in_link turns the outside in
  std::uint32_t visibility_flags = 0xffffffff;

  Eigen::AlignedBox3d bounds() const;                                       // of the part, in the mesh
  Eigen::AlignedBox3d bounds_at(const Eigen::Isometry3d& link_pose) const;  // in the world, with its link there
};

// A visual with all its parts: what the marks of an image tell apart (render/marks.h).
struct SceneVisual {
  std::uint32_t object = 0;                  // 1 + index into Scene::objects; 0: it has no label
  bool has_heat = false;                     // else as warm as the air
  double lowest = 0, highest = 0;            // [K]
  std::shared_ptr<const Texture> signature;  // null: all of it has the lowest temperature
};

// What has a label: a model, nested model, visual or actor.
struct SceneObject {
  std::string name;          // scoped
  std::uint8_t label = 0;    // 1..255
  std::uint32_t number = 1;  // among those of its label, in the order of the scene
  std::uint32_t link = 0;    // that its frame is in
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  std::vector<std::uint32_t> drawables;
};

struct SceneLink {
  std::string name;  // model::link; an actor's name
  bool is_static = false;
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();  // pose in the world when the world begins
};

struct SceneLight {
  LightDef light;
  std::int32_t link = -1;  // -1: the pose of the light is in the world
};

struct SceneModel {
  std::string name;
  std::uint32_t first_link = 0, link_count = 0;
  std::uint32_t canonical_link = 0;                         // index into links
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();  // of the model in the canonical link
  double radius = 0;                                        // round the canonical link's origin, of all that is drawn
  double height = 0;                                        // of the highest point over that origin at the start
};

// The links after an actor's own are its bones.
struct SceneActor {
  std::uint32_t link = 0;                // its own
  std::shared_ptr<const SkinFile> skin;  // null: it has none that can be bent
  std::shared_ptr<const Mesh> mesh;      // the skin's, for this actor alone; its bounds hold all that its animations do
  std::vector<std::shared_ptr<const SkinAnimation>> animations;  // as in its definition; null: cannot be played
};

struct Scene {
  enum class Content { visuals, collisions };

  SceneDef look;
  std::vector<SceneLink> links;  // of models[0], models[1], ... in the order of their definitions, then each actor with its bones
  std::vector<SceneModel> models;
  std::vector<Drawable> drawables;
  std::vector<SceneVisual> visuals;
  std::vector<SceneObject> objects;
  std::vector<SceneLight> lights;
  std::vector<SceneActor> actors;

  // What it takes of a world; pointers must live during the call only.
  struct Parts {
    SceneDef look;
    std::vector<const LightDef*> lights;
    std::vector<const ModelDef*> models;
    std::vector<const ActorDef*> actors;
  };
  static std::shared_ptr<const Scene> build(const Parts& parts, Assets& assets, Content content = Content::visuals);
  static std::shared_ptr<const Scene> build(const WorldDef& world, Assets& assets, Content content = Content::visuals);

  std::vector<Eigen::Isometry3d> start_poses() const;
  // All that is drawn and is no ground, with the links at these poses.
  Eigen::AlignedBox3d bounds(std::span<const Eigen::Isometry3d> poses) const;
};

}  // namespace sim
