#include "render/gltf.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "render/glb_parts.h"

namespace sim {
namespace {

using glb::List;

constexpr int largest_side = 2048;  // [pixel]

std::string color(const Color& c) { return glb::vector3({c.r, c.g, c.b}); }
const char* yes_no(bool value) { return value ? "true" : "false"; }

// Ours are kept with gamma 2.
Image in_srgb(Image image) {
  static const auto table = [] {
    std::array<std::uint8_t, 256> out{};
    for (std::size_t i = 0; i < out.size(); ++i) {
      const float byte = static_cast<float>(i) / 255.0F;
      out[i] = static_cast<std::uint8_t>(std::clamp(sim::to_srgb(byte * byte), 0.0F, 1.0F) * 255.0F + 0.5F);
    }
    return out;
  }();
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    for (std::size_t c = 0; c < 3; ++c) image.rgba[i + c] = table[image.rgba[i + c]];
  return image;
}

// Where a light shines to, as glTF wants it: along -z of its node.
Eigen::Matrix3d looking_along(const Eigen::Vector3d& direction) {
  return Eigen::Quaterniond::FromTwoVectors(-Eigen::Vector3d::UnitZ(), direction).toRotationMatrix();
}

class Writer {
 public:
  explicit Writer(const GltfWorld& world) : world_(world), scene_(world.scene), children_(scene_.links.size()) {}

  base::Result<std::string> write();

 private:
  void add_shape(const Drawable& drawable);
  void add_light(const SceneLight& light);
  void add_sensor(const GltfSensor& sensor);
  void add_links();
  std::size_t mesh_of(const Drawable& drawable);
  std::string attributes_of(const Mesh& mesh);
  std::string weights_of(const Skin& skin);
  std::optional<std::size_t> skin_of(const Drawable& drawable);
  std::size_t material_of(const Material& material);
  std::string texture_of(const std::shared_ptr<const Texture>& texture, const Eigen::Vector2f& repeat, bool is_color);
  std::size_t picture_of(const Texture& texture, bool is_color);
  std::string look() const;
  const SceneActor* actor_of(const Mesh* mesh) const;

  const GltfWorld& world_;
  const Scene& scene_;
  glb::Parts parts_;
  std::vector<std::vector<std::size_t>> children_;  // nodes that hang on each link
  std::vector<std::size_t> roots_;                  // lights of the world
  std::vector<std::size_t> link_nodes_;
  std::map<const Mesh*, std::string> attributes_;
  std::map<std::string, std::size_t> meshes_, materials_, textures_;
  std::map<std::pair<const Texture*, bool>, std::size_t> pictures_;
  std::set<std::string> extensions_;
  std::optional<base::Error> error_;
};

const SceneActor* Writer::actor_of(const Mesh* mesh) const {
  const auto found = std::find_if(scene_.actors.begin(), scene_.actors.end(), [&](const SceneActor& a) { return a.mesh.get() == mesh; });
  return found == scene_.actors.end() || !found->skin ? nullptr : &*found;
}

// What bends comes as the skin has it; the bones carry it to its place and size.
std::string Writer::attributes_of(const Mesh& mesh) {
  const SceneActor* actor = actor_of(&mesh);
  const auto& vertices = actor != nullptr ? actor->skin->skin.vertices : mesh.vertices;
  std::vector<float> places, normals, uvs;
  Eigen::AlignedBox3f box;
  for (const auto& vertex : vertices) {
    places.insert(places.end(), vertex.position.begin(), vertex.position.end());
    Eigen::Vector3f normal(vertex.normal[0], vertex.normal[1], vertex.normal[2]);
    normal = normal.norm() > 1e-6F ? Eigen::Vector3f(normal.normalized()) : Eigen::Vector3f::UnitZ();
    normals.insert(normals.end(), normal.data(), normal.data() + 3);
    uvs.insert(uvs.end(), vertex.uv.begin(), vertex.uv.end());
    box.extend(Eigen::Vector3f(vertex.position[0], vertex.position[1], vertex.position[2]));
  }
  const auto corner = [](const Eigen::Vector3f& c) { return fmt::format("[{},{},{}]", c.x(), c.y(), c.z()); };
  const auto add = [&](const std::vector<float>& values, const char* type, const std::string& limits) {
    return parts_.add_accessor(glb::octets_of(values), glb::Target::vertices, glb::Component::f32, type, vertices.size(), limits);
  };
  const auto place = add(places, "VEC3", fmt::format(R"(,"min":{},"max":{})", corner(box.min()), corner(box.max())));
  const auto normal = add(normals, "VEC3", "");
  const auto uv = add(uvs, "VEC2", "");
  return fmt::format(R"("POSITION":{},"NORMAL":{},"TEXCOORD_0":{}{})", place, normal, uv,
                     actor != nullptr ? weights_of(actor->skin->skin) : "");
}

std::string Writer::weights_of(const Skin& skin) {
  std::vector<std::uint16_t> joints;
  std::vector<float> shares;
  for (const auto& weights : skin.weights) {
    for (std::size_t k = 0; k < 4; ++k) joints.push_back(weights.shares[k] > 0 ? weights.bones[k] : std::uint16_t{0});
    shares.insert(shares.end(), weights.shares.begin(), weights.shares.end());
  }
  const auto joint = parts_.add_accessor(glb::octets_of(joints), glb::Target::vertices, glb::Component::u16, "VEC4", skin.weights.size());
  const auto share = parts_.add_accessor(glb::octets_of(shares), glb::Target::vertices, glb::Component::f32, "VEC4", skin.weights.size());
  return fmt::format(R"(,"JOINTS_0":{},"WEIGHTS_0":{})", joint, share);
}

std::size_t Writer::mesh_of(const Drawable& drawable) {
  const Mesh& mesh = *drawable.mesh;
  const auto material = material_of(drawable.material);
  const std::string key = fmt::format("{}|{}|{}", static_cast<const void*>(&mesh), drawable.part, material);
  if (const auto kept = meshes_.find(key); kept != meshes_.end()) return kept->second;
  auto& attributes = attributes_[&mesh];
  if (attributes.empty()) attributes = attributes_of(mesh);
  const MeshPart& part = mesh.parts[drawable.part];
  const auto used = std::span(mesh.indices).subspan(part.first_index, part.index_count);
  std::size_t accessor = 0;
  if (mesh.vertices.size() < 65535) {
    const std::vector<std::uint16_t> small(used.begin(), used.end());
    accessor = parts_.add_accessor(glb::octets_of(small), glb::Target::indices, glb::Component::u16, "SCALAR", small.size());
  } else {
    accessor = parts_.add_accessor(std::as_bytes(used), glb::Target::indices, glb::Component::u32, "SCALAR", used.size());
  }
  return meshes_[key] = parts_.add(List::meshes, fmt::format(R"({{"primitives":[{{"attributes":{{{}}},"indices":{},"material":{}}}]}})",
                                                             attributes, accessor, material));
}

std::size_t Writer::picture_of(const Texture& texture, bool is_color) {
  const auto [kept, is_new] = pictures_.try_emplace({&texture, is_color});
  if (!is_new) return kept->second;
  auto level = texture.levels.begin();
  while (std::max(level->width, level->height) > largest_side && level + 1 != texture.levels.end()) ++level;
  const auto png = encode_png(is_color ? in_srgb(*level) : *level);
  if (!png) {
    error_ = png.error();
    return 0;
  }
  const auto view = parts_.add_octets(glb::octets_of(*png));
  return kept->second = parts_.add(List::images, fmt::format(R"({{"bufferView":{},"mimeType":"image/png"}})", view));
}

std::string Writer::texture_of(const std::shared_ptr<const Texture>& texture, const Eigen::Vector2f& repeat, bool is_color) {
  if (parts_.count(List::samplers) == 0) parts_.add(List::samplers, R"({"magFilter":9729,"minFilter":9987,"wrapS":10497,"wrapT":10497})");
  const std::string object = fmt::format(R"({{"sampler":0,"source":{}}})", picture_of(*texture, is_color));
  const auto [kept, is_new] = textures_.try_emplace(object);
  if (is_new) kept->second = parts_.add(List::textures, object);
  if (repeat == Eigen::Vector2f(1, 1)) return fmt::format(R"({{"index":{}}})", kept->second);
  extensions_.insert("KHR_texture_transform");
  return fmt::format(R"({{"index":{},"extensions":{{"KHR_texture_transform":{{"scale":[{},{}]}}}}}})", kept->second, repeat.x(),
                     repeat.y());
}

std::size_t Writer::material_of(const Material& m) {
  std::string pbr = fmt::format(R"("baseColorFactor":[{},{},{},{}],"metallicFactor":0,"roughnessFactor":{})", std::min(1.0F, m.albedo[0]),
                                std::min(1.0F, m.albedo[1]), std::min(1.0F, m.albedo[2]), std::clamp(m.albedo[3], 0.0F, 1.0F),
                                m.shininess > 0 ? std::pow(2.0F / (m.shininess + 2.0F), 0.25F) : 1.0F);
  if (m.texture) pbr += ",\"baseColorTexture\":" + texture_of(m.texture, m.repeat, true);
  std::string out = "{\"pbrMetallicRoughness\":{" + pbr + "}";
  if (m.normal_map) out += ",\"normalTexture\":" + texture_of(m.normal_map, m.repeat, false);
  if (m.emissive_map) out += ",\"emissiveTexture\":" + texture_of(m.emissive_map, m.repeat, true);
  const Eigen::Vector3d glow = m.emissive.cwiseMin(1).cwiseMax(0).cast<double>();
  if (!glow.isZero()) out += ",\"emissiveFactor\":" + glb::vector3(glow);
  if (m.is_transparent) out += ",\"alphaMode\":\"BLEND\"";
  if (!m.is_transparent && m.texture && m.texture->has_holes) out += ",\"alphaMode\":\"MASK\"";
  if (m.is_double_sided) out += ",\"doubleSided\":true";
  if (!m.is_lit) {
    extensions_.insert("KHR_materials_unlit");
    out += R"(,"extensions":{"KHR_materials_unlit":{}})";
  }
  out += fmt::format(R"(,"extras":{{"specular":{},"shininess":{}}}}})", glb::vector3(m.specular.cast<double>()), m.shininess);
  const auto [kept, is_new] = materials_.try_emplace(out);
  if (is_new) kept->second = parts_.add(List::materials, out);
  return kept->second;
}

void Writer::add_shape(const Drawable& drawable) {
  if (drawable.mesh->parts[drawable.part].index_count < 3 || drawable.link >= children_.size()) return;
  const bool is_skin = actor_of(drawable.mesh.get()) != nullptr;
  const std::string extras = fmt::format(R"("extras":{{"casts_shadow":{},"ground":{},"grid":{}}})", yes_no(drawable.casts_shadow),
                                         yes_no(drawable.is_ground), yes_no(drawable.has_grid));
  std::string node = fmt::format(R"({{"mesh":{},{})", mesh_of(drawable), extras);
  if (is_skin) node += fmt::format(R"(,"skin":{})", *skin_of(drawable));
  if (!is_skin && !drawable.in_link.isApprox(Eigen::Affine3d::Identity())) node += ",\"matrix\":" + glb::matrix(drawable.in_link.matrix());
  children_[drawable.link].push_back(parts_.add(List::nodes, node + "}"));
}

// Bones are the links after the actor's own. Nodes of links come first, in their order.
std::optional<std::size_t> Writer::skin_of(const Drawable& drawable) {
  const SceneActor* actor = actor_of(drawable.mesh.get());
  if (actor == nullptr) return std::nullopt;
  const auto& bones = actor->skin->skin.bones;
  std::vector<float> matrices;
  std::vector<std::size_t> joints;
  for (std::size_t i = 0; i < bones.size(); ++i) {
    const Eigen::Matrix4f m = bones[i].from_mesh.matrix().cast<float>();
    matrices.insert(matrices.end(), m.data(), m.data() + 16);
    joints.push_back(link_nodes_[actor->link + 1 + i]);
  }
  const auto accessor = parts_.add_accessor(glb::octets_of(matrices), glb::Target::none, glb::Component::f32, "MAT4", bones.size());
  return parts_.add(List::skins, fmt::format(R"({{"inverseBindMatrices":{},"joints":{}}})", accessor, glb::indices(joints)));
}

void Writer::add_light(const SceneLight& hung) {
  const LightDef& light = hung.light;
  if (!light.is_on) return;
  extensions_.insert("KHR_lights_punctual");
  const Eigen::Vector3d shine(light.diffuse.r, light.diffuse.g, light.diffuse.b);
  const double strongest = std::max(1e-6, shine.maxCoeff());
  const char* kind = light.kind == LightDef::Kind::directional ? "directional" : light.kind == LightDef::Kind::spot ? "spot" : "point";
  std::string json = fmt::format(R"({{"name":{},"type":"{}","color":{},"intensity":{})", glb::text(light.name), kind,
                                 glb::vector3(shine / strongest), std::max(0.0, light.intensity * strongest));
  const bool is_near = light.kind != LightDef::Kind::directional;
  if (is_near && std::isfinite(light.range) && light.range > 0) json += fmt::format(",\"range\":{}", light.range);
  if (light.kind == LightDef::Kind::spot) {
    const double outer = std::clamp(0.5 * light.outer_angle, 1e-3, 1.57);
    json += fmt::format(R"(,"spot":{{"innerConeAngle":{},"outerConeAngle":{}}})", std::clamp(0.5 * light.inner_angle, 0.0, 0.999 * outer),
                        outer);
  }
  json +=
      fmt::format(R"(,"extras":{{"diffuse":{},"specular":{},"intensity":{},"attenuation":[{},{},{}],"falloff":{},"casts_shadow":{}}}}})",
                  color(light.diffuse), color(light.specular), light.intensity, light.constant_attenuation, light.linear_attenuation,
                  light.quadratic_attenuation, light.falloff, yes_no(light.cast_shadows));
  const auto index = parts_.add(List::lights, json);
  const auto node = parts_.add(
      List::nodes, fmt::format(R"({{"name":{},"translation":{},"rotation":{},"extensions":{{"KHR_lights_punctual":{{"light":{}}}}}}})",
                               glb::text(light.name), glb::vector3(light.pose.translation()),
                               glb::quaternion(light.pose.linear() * looking_along(light.direction)), index));
  (hung.link < 0 ? roots_ : children_[static_cast<std::size_t>(hung.link)]).push_back(node);
}

void Writer::add_sensor(const GltfSensor& sensor) {
  if (sensor.link >= children_.size()) return;
  std::string extras = fmt::format(R"("iface":{},"kind":{})", glb::text(sensor.iface), glb::text(sensor.kind));
  for (const auto& [name, value] : sensor.numbers) {
    if (std::isfinite(value)) extras += fmt::format(",{}:{}", glb::text(name), value);
  }
  children_[sensor.link].push_back(
      parts_.add(List::nodes, fmt::format(R"({{"name":{},"translation":{},"rotation":{},"extras":{{{}}}}})", glb::text(sensor.iface),
                                          glb::vector3(sensor.in_link.translation()), glb::quaternion(sensor.in_link.linear()), extras)));
}

std::string Writer::look() const {
  const SceneDef& look = scene_.look;
  std::string out = fmt::format(R"("ambient":{},"background":{},"shadows":{},"grid":{})", color(look.ambient), color(look.background),
                                yes_no(look.shadows), yes_no(look.grid));
  if (look.sky) out += fmt::format(R"(,"sky":{{"time":{},"sunrise":{},"sunset":{}}})", look.sky->time, look.sky->sunrise, look.sky->sunset);
  if (look.fog) {
    out += fmt::format(R"(,"fog":{{"type":{},"color":{},"start":{},"end":{},"density":{}}})", glb::text(look.fog->type),
                       color(look.fog->color), look.fog->start, look.fog->end, look.fog->density);
  }
  if (world_.camera) {
    out += fmt::format(R"(,"camera":{{"position":{},"rotation":{}}})", glb::vector3(world_.camera->translation()),
                       glb::quaternion(world_.camera->linear()));
  }
  return out;
}

// One root, then models, then links; what hangs on a link comes after all of them.
base::Result<std::string> Writer::write() {
  const std::size_t first_link = 1 + scene_.models.size();
  for (std::size_t i = 0; i < scene_.links.size(); ++i) link_nodes_.push_back(first_link + i);
  // Their text needs the numbers of their children, and children theirs: places are kept free.
  for (std::size_t i = 0; i < first_link + scene_.links.size(); ++i) parts_.add(List::nodes, "");
  for (const auto& drawable : scene_.drawables) add_shape(drawable);
  for (const auto& light : scene_.lights) add_light(light);
  for (const auto& sensor : world_.sensors) add_sensor(sensor);
  if (error_) return *error_;
  std::vector<std::size_t> top;
  for (std::size_t i = 0; i < scene_.models.size(); ++i) {
    const SceneModel& model = scene_.models[i];
    const auto links = std::span(link_nodes_).subspan(model.first_link, model.link_count);
    const bool is_static = model.link_count > 0 && scene_.links[model.first_link].is_static;
    parts_.set(List::nodes, 1 + i,
               fmt::format(
                   R"({{"name":{}{},"extras":{{"model":true,"static":{},"radius":{},"height":{},"link":{},"position":{},"rotation":{}}}}})",
                   glb::text(model.name), links.empty() ? "" : ",\"children\":" + glb::indices(links), yes_no(is_static), model.radius,
                   model.height, model.canonical_link, glb::vector3(model.frame.translation()), glb::quaternion(model.frame.linear())));
    top.push_back(1 + i);
  }
  add_links();
  top.insert(top.end(), roots_.begin(), roots_.end());
  const double half = std::sqrt(0.5);
  parts_.set(
      List::nodes, 0,
      fmt::format(R"({{"name":"world","rotation":[{},0,0,{}]{}}})", -half, half, top.empty() ? "" : ",\"children\":" + glb::indices(top)));
  std::vector<std::string> extensions;
  for (const auto& name : extensions_) extensions.push_back(glb::text(name));
  return parts_.finish(
      fmt::format(R"({{"nodes":[0],"extras":{{"links":{},"version":{},{}}}}})", glb::indices(link_nodes_), world_.version, look()),
      extensions);
}

void Writer::add_links() {
  for (std::size_t i = 0; i < scene_.links.size(); ++i) {
    const Eigen::Isometry3d& pose = world_.poses[i];
    parts_.set(List::nodes, link_nodes_[i],
               fmt::format(R"({{"name":{},"translation":{},"rotation":{}{},"extras":{{"link":{}}}}})", glb::text(scene_.links[i].name),
                           glb::vector3(pose.translation()), glb::quaternion(pose.linear()),
                           children_[i].empty() ? "" : ",\"children\":" + glb::indices(children_[i]), i));
  }
}

}  // namespace

base::Result<std::string> write_glb(const GltfWorld& world) {
  if (world.poses.size() != world.scene.links.size())
    return base::Error{fmt::format("export: {} poses for {} links", world.poses.size(), world.scene.links.size())};
  return Writer(world).write();
}

}  // namespace sim
