// Reading and keeping meshes and textures.
#include "render/assets.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "reader/asset_reader.h"
#include "render/mesh_arrays.h"
#include "world/reported_files.h"

namespace sim {
namespace {

constexpr int largest_texture = 4096;  // [pixel] a side; larger ones are halved

// sRGB byte -> gamma 2 byte.
std::array<std::uint8_t, 256> gamma2_table() {
  std::array<std::uint8_t, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i)
    table[i] = static_cast<std::uint8_t>(std::sqrt(to_linear(static_cast<float>(i) / 255.0F)) * 255.0F + 0.5F);
  return table;
}

Image to_gamma2(Image image) {
  static const auto table = gamma2_table();
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    for (std::size_t c = 0; c < 3; ++c) image.rgba[i + c] = table[image.rgba[i + c]];
  return image;
}

Texture make_texture(Image image) {
  Texture texture;
  // Cut-out pictures have few shades between open and closed: the smoothed edges.
  std::size_t open = 0, between = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) {
    texture.has_holes = texture.has_holes || image.rgba[i] < 128;
    open += image.rgba[i] < 16 ? 1 : 0;
    between += image.rgba[i] >= 16 && image.rgba[i] < 240 ? 1 : 0;
  }
  texture.is_translucent = between > open;
  texture.has_holes = texture.has_holes && !texture.is_translucent;
  while (image.width > 1 || image.height > 1) {
    Image smaller = halve(image);
    texture.levels.push_back(to_gamma2(std::move(image)));
    image = std::move(smaller);
  }
  texture.levels.push_back(to_gamma2(std::move(image)));
  return texture;
}

Image chequer() {
  Image image{64, 64, std::vector<std::uint8_t>(64 * 64 * 4)};
  for (std::size_t y = 0; y < 64; ++y)
    for (std::size_t x = 0; x < 64; ++x) {
      const bool is_dark = ((x / 16 + y / 16) & 1) != 0;
      const std::array<std::uint8_t, 4> pixel =
          is_dark ? std::array<std::uint8_t, 4>{20, 20, 20, 255} : std::array<std::uint8_t, 4>{255, 0, 255, 255};
      std::copy(pixel.begin(), pixel.end(), image.rgba.begin() + static_cast<std::ptrdiff_t>((y * 64 + x) * 4));
    }
  return image;
}

// "#rrggbb".
Image plain_picture(const std::string& color) {
  const auto rgb = static_cast<std::uint32_t>(std::strtoul(color.substr(std::min<std::size_t>(1, color.size())).c_str(), nullptr, 16));
  return {1, 1, {static_cast<std::uint8_t>(rgb >> 16U), static_cast<std::uint8_t>(rgb >> 8U), static_cast<std::uint8_t>(rgb), 255}};
}

std::string key_of(const MeshShape& shape) {
  return fmt::format("{}|{}|{}|{},{},{}|{}", shape.path, shape.submesh, shape.center_submesh, shape.scale.x(), shape.scale.y(),
                     shape.scale.z(), shape.version);
}
std::string key_of(const HeightmapShape& shape) {
  return fmt::format("{}|{},{},{}|{}", shape.path, shape.size.x(), shape.size.y(), shape.size.z(), shape.sampling);
}

// Between the points of a grid; u and v from 0 to 1, from its upper left corner.
double height_at(const HeightGrid& grid, double u, double v) {
  const double x = u * (grid.columns - 1), y = v * (grid.rows - 1);
  const int column = std::min(static_cast<int>(x), grid.columns - 2), row = std::min(static_cast<int>(y), grid.rows - 2);
  const auto at = [&](int c, int r) {
    return static_cast<double>(
        grid.heights[static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(c)]);
  };
  const double fx = x - column, fy = y - row;
  const double upper = at(column, row) + fx * (at(column + 1, row) - at(column, row));
  const double lower = at(column, row + 1) + fx * (at(column + 1, row + 1) - at(column, row + 1));
  return upper + fy * (lower - upper);
}

// The weight of each layer at a height: a layer fades in over its distance from its minimum height on, and hides those below.
std::vector<double> layer_weights(const HeightmapShape& shape, double height) {
  std::vector<double> weights(shape.textures.size(), 0.0);
  weights[0] = 1;
  for (std::size_t i = 0; i < shape.blends.size() && i + 1 < weights.size(); ++i) {
    const auto& [start, fade] = shape.blends[i];
    const double share = std::clamp(fade > 0 ? (height - start) / fade : (height >= start ? 1.0 : 0.0), 0.0, 1.0);
    for (std::size_t k = 0; k <= i; ++k) weights[k] *= 1 - share;
    weights[i + 1] = share;
  }
  return weights;
}

}  // namespace

Assets::Assets(ModelPath model_path)
    : model_path_(std::move(model_path)),
      box_(std::make_shared<Mesh>(make_box())),
      sphere_(std::make_shared<Mesh>(make_sphere())),
      cylinder_(std::make_shared<Mesh>(make_cylinder())),
      plane_(std::make_shared<Mesh>(make_plane())) {
  Mesh missing = make_box();
  for (auto& vertex : missing.vertices)
    for (auto& coordinate : vertex.position) coordinate *= 0.3F;
  finish(missing);
  missing.parts[0].material.diffuse = {1, 0, 1, 1};
  missing.is_stand_in = true;
  missing_mesh_ = std::make_shared<Mesh>(std::move(missing));
  missing_texture_ = std::make_shared<Texture>(make_texture(chequer()));
  white_ = std::make_shared<Texture>(Texture{{Image{1, 1, {255, 255, 255, 255}}}, false});
  flat_normals_ = std::make_shared<Texture>(Texture{{Image{1, 1, {128, 128, 255, 255}}}, false});
}

std::shared_ptr<const Mesh> Assets::mesh(const GeometryDef& geometry) {
  struct Visitor {
    Assets& assets;
    std::shared_ptr<const Mesh> operator()(const BoxShape&) { return assets.box_; }
    std::shared_ptr<const Mesh> operator()(const SphereShape&) { return assets.sphere_; }
    std::shared_ptr<const Mesh> operator()(const EllipsoidShape&) { return assets.sphere_; }
    std::shared_ptr<const Mesh> operator()(const CylinderShape&) { return assets.cylinder_; }
    std::shared_ptr<const Mesh> operator()(const PlaneShape&) { return assets.plane_; }
    std::shared_ptr<const Mesh> operator()(const CapsuleShape& shape) {
      auto& kept = assets.meshes_[fmt::format("capsule|{}|{}", shape.radius, shape.length)];
      if (!kept) kept = std::make_shared<Mesh>(make_capsule(shape.radius, shape.length));
      return kept;
    }
    std::shared_ptr<const Mesh> operator()(const ConeShape& shape) {
      auto& kept = assets.meshes_[fmt::format("cone|{}|{}", shape.radius, shape.length)];
      if (!kept) kept = std::make_shared<Mesh>(make_cone(shape.radius, shape.length));
      return kept;
    }
    std::shared_ptr<const Mesh> operator()(const MeshShape& shape) { return assets.load(shape); }
    std::shared_ptr<const Mesh> operator()(const HeightmapShape& shape) { return assets.load(shape); }
    std::shared_ptr<const Mesh> operator()(const PolylineShape& shape) { return assets.load(shape); }
  };
  return std::visit(Visitor{*this}, geometry);
}

Eigen::Affine3d Assets::placement_of(const GeometryDef& geometry) {
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  if (const auto* box = std::get_if<BoxShape>(&geometry)) {
    out.scale(box->size);
  } else if (const auto* sphere = std::get_if<SphereShape>(&geometry)) {
    out.scale(2 * sphere->radius);
  } else if (const auto* ellipsoid = std::get_if<EllipsoidShape>(&geometry)) {
    out.scale(Eigen::Vector3d(2 * ellipsoid->radii));
  } else if (const auto* cylinder = std::get_if<CylinderShape>(&geometry)) {
    out.scale(Eigen::Vector3d(2 * cylinder->radius, 2 * cylinder->radius, cylinder->length));
  } else if (const auto* plane = std::get_if<PlaneShape>(&geometry)) {
    out.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), plane->normal).toRotationMatrix();
    out.scale(Eigen::Vector3d(plane->size.x(), plane->size.y(), 1));
  } else if (const auto* map = std::get_if<HeightmapShape>(&geometry)) {
    out.translation() = map->position;
  }
  return out;
}

std::shared_ptr<const Mesh> Assets::load(const MeshShape& shape) {
  if (shape.path == missing_file) return missing_mesh_;
  auto& kept = meshes_[key_of(shape)];
  if (kept) return kept;
  auto file = read_mesh_file(shape, model_path_);
  if (!file) {
    if (is_first_report(shape.path)) complaints_.push_back(file.error().message + "; a stand-in is drawn");
    return kept = missing_mesh_;
  }
  keep_images(std::move(file->images), file->files);
  return kept = std::make_shared<Mesh>(std::move(file->mesh));
}

void Assets::keep_images(std::vector<EmbeddedImage>&& images, const FileStamps& files) {
  for (auto& image : images) embedded_[image.name] = {std::move(image.bytes), files};
}

std::shared_ptr<const SkinFile> Assets::skin(const std::string& path, double scale) {
  if (path == missing_file) return nullptr;
  const auto [kept, is_new] = skins_.try_emplace(fmt::format("{}|{}", path, scale));
  if (!is_new) return kept->second;
  auto file = read_skin_file(path, scale, model_path_);
  if (!file) {
    complaints_.push_back(file.error().message + "; a stand-in is drawn");
    return nullptr;
  }
  keep_images(std::move(file->images), file->files);
  return kept->second = std::make_shared<SkinFile>(std::move(*file));
}

std::shared_ptr<const SkinAnimation> Assets::animation(const std::string& path, double scale, const std::shared_ptr<const SkinFile>& skin) {
  const auto name = std::find_if(skins_.begin(), skins_.end(), [&](const auto& entry) { return entry.second == skin; });
  const auto [kept, is_new] = animations_.try_emplace(fmt::format("{}|{}|{}", path, scale, name->first));
  if (!is_new) return kept->second;
  auto file = read_skin_animation(path, scale, skin->skin);
  if (!file) {
    complaints_.push_back(file.error().message + "; the limbs keep still");
    return nullptr;
  }
  return kept->second = std::make_shared<SkinAnimation>(std::move(*file));
}

std::shared_ptr<const Mesh> Assets::load(const HeightmapShape& shape) {
  if (shape.path == missing_file) return missing_mesh_;
  auto& kept = meshes_[key_of(shape)];
  if (kept) return kept;
  auto grid = triangles_.heights(shape);
  if (!grid) {
    if (is_first_report(shape.path)) complaints_.push_back(grid.error().message + "; a stand-in is drawn");
    return kept = missing_mesh_;
  }
  const HeightGrid& g = **grid;
  return kept = std::make_shared<Mesh>(make_height_grid(g.columns, g.rows, g.width, g.depth, g.heights));
}

std::shared_ptr<const Mesh> Assets::load(const PolylineShape& shape) {
  auto triangles = triangles_.triangles(shape);
  if (!triangles) {
    complaints_.push_back(triangles.error().message + "; a stand-in is drawn");
    return missing_mesh_;
  }
  return std::make_shared<Mesh>(make_flat((*triangles)->vertices, (*triangles)->triangles));
}

base::Result<Image> Assets::image(const std::string& path, int largest_side, FileStamps& files) {
  if (path.starts_with(color_file)) return plain_picture(path.substr(std::string_view(color_file).size()));
  const auto inside = embedded_.find(path);
  if (inside == embedded_.end()) return read_image(path, largest_side, &files);
  files = inside->second.files;
  return decode_image(inside->second.bytes, path, largest_side);
}

base::Result<std::shared_ptr<const Texture>> Assets::shelved(const std::string& key, const std::string& path, int largest_side,
                                                             const std::function<Texture(Image)>& make) {
  static auto& shelf = *new AssetShelf<Texture>(std::size_t{256} << 20U);  // never destroyed: as the reader
  return shelf
      .get(key,
           [&]() -> AssetShelf<Texture>::Made {
             FileStamps files;
             auto picture = image(path, largest_side, files);
             if (!picture) return {picture.error(), files, 0, !files.empty()};
             const std::size_t bytes = picture->size_bytes() * 4 / 3;
             return {make(std::move(*picture)), std::move(files), bytes};
           })
      .value;
}

std::shared_ptr<const Texture> Assets::texture(const std::string& path, bool has_alpha) {
  if (path == missing_file) return missing_texture_;
  auto& kept = textures_[(has_alpha ? "" : "opaque|") + path];
  if (kept) return kept;
  auto texture = shelved((has_alpha ? "alpha|" : "opaque|") + path, path, largest_texture, [&](Image picture) {
    if (!has_alpha) {
      for (std::size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = 255;
    }
    return make_texture(std::move(picture));
  });
  if (texture) return kept = *texture;
  complaints_.push_back(texture.error().message + "; a chequer stands in");
  return kept = missing_texture_;
}

std::shared_ptr<const Texture> Assets::normal_map(const std::string& path) {
  auto& kept = textures_["normal|" + path];
  if (kept) return kept;
  auto texture = shelved("normal|" + path, path, largest_image, [](Image picture) {
    Texture levels;
    while (picture.width > 1 || picture.height > 1) {
      levels.levels.push_back(picture);
      picture = halve(picture);
    }
    levels.levels.push_back(std::move(picture));
    return levels;
  });
  if (texture) return kept = *texture;
  complaints_.push_back(texture.error().message + "; the surface stays smooth");
  return kept = flat_normals_;
}

std::shared_ptr<const Texture> Assets::height_texture(const HeightmapShape& shape) {
  if (shape.textures.empty()) return nullptr;
  std::string key = "height|" + key_of(shape);
  for (const auto& layer : shape.textures) key += fmt::format("|{},{}", layer.diffuse, layer.size);
  if (const auto kept = textures_.find(key); kept != textures_.end()) return kept->second;
  auto grid = triangles_.heights(shape);
  if (!grid) return textures_[key] = nullptr;
  std::vector<Image> layers;
  FileStamps files;
  for (const auto& layer : shape.textures) {
    auto picture = layer.diffuse.empty() || layer.diffuse == missing_file ? base::Result<Image>(chequer())
                                                                          : image(layer.diffuse, largest_image, files);
    if (!picture) complaints_.push_back(picture.error().message + "; a chequer stands in");
    layers.push_back(picture ? std::move(*picture) : chequer());
  }
  constexpr int side = 2048;
  Image out{side, side, std::vector<std::uint8_t>(static_cast<std::size_t>(side) * side * 4, 255)};
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const auto weights =
          layer_weights(shape, height_at(**grid, static_cast<double>(x) / (side - 1), static_cast<double>(y) / (side - 1)));
      std::array<double, 3> sum{};
      for (std::size_t k = 0; k < layers.size(); ++k) {
        if (weights[k] <= 0) continue;
        const double size = std::max(0.01, shape.textures[k].size);
        const auto wrap = [&](double metres, int pixels) {
          const double turns = metres / size;
          return static_cast<std::size_t>(std::clamp(static_cast<int>((turns - std::floor(turns)) * pixels), 0, pixels - 1));
        };
        const std::size_t u = wrap(x * shape.size.x() / side, layers[k].width);
        const std::size_t v = wrap(y * shape.size.y() / side, layers[k].height);
        const std::uint8_t* pixel = &layers[k].rgba[(v * static_cast<std::size_t>(layers[k].width) + u) * 4];
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weights[k] * pixel[c];
      }
      std::uint8_t* pixel = &out.rgba[(static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x)) * 4];
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(std::clamp(sum[c], 0.0, 255.0));
    }
  }
  return textures_[key] = std::make_shared<Texture>(make_texture(std::move(out)));
}

void Assets::adopt(Assets&& other) {
  const auto move_to = [](auto& mine, auto& theirs) {
    for (auto& [key, value] : theirs) mine.insert_or_assign(key, std::move(value));
  };
  // Shapes that both have made for themselves stay: what is drawn from them is shared.
  for (auto& [key, mesh] : other.meshes_) meshes_.try_emplace(key, std::move(mesh));
  for (auto& [key, skin] : other.skins_) skins_.try_emplace(key, std::move(skin));
  for (auto& [key, animation] : other.animations_) animations_.try_emplace(key, std::move(animation));
  move_to(textures_, other.textures_);
  move_to(embedded_, other.embedded_);
  triangles_.adopt(std::move(other.triangles_));
  complaints_.insert(complaints_.end(), other.complaints_.begin(), other.complaints_.end());
  other.complaints_.clear();
}

std::vector<std::string> Assets::take_complaints() { return std::exchange(complaints_, {}); }

}  // namespace sim
