// Meshes and textures in memory, each file read once. Files are read by a process of its own (reader/asset_reader.h). What cannot be read
// gets a visible stand-in (a magenta and black chequer, a small box) and one line of complaint. The cache is for one thread at a time; what
// it hands out never changes and any thread may read it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "render/image.h"
#include "render/mesh.h"
#include "render/skin.h"
#include "world/triangles.h"
#include "world/world_def.h"

namespace sim {

// An image with its smaller copies, ready for GL. Colours are stored with gamma 2 (the square of a byte is linear light): decoding is one
// multiplication in the shader, and no shade that sRGB tells apart is lost.
struct Texture {
  std::vector<Image> levels;
  bool has_holes = false;       // some alpha is below one half: drawn with the holes cut out
  bool is_translucent = false;  // most of what is not opaque is neither open: mixed with what is behind
};

class Assets {
 public:
  // Of a world: where files are looked for that mesh files name.
  explicit Assets(ModelPath model_path = {});

  // Never null. Unit box, sphere, cylinder and plane are shared: scale_of() tells how to scale them.
  std::shared_ptr<const Mesh> mesh(const GeometryDef& geometry);
  // Of an actor. Null when it cannot be read; animations also when they do not fit to the skin.
  std::shared_ptr<const SkinFile> skin(const std::string& path, double scale);
  std::shared_ptr<const SkinAnimation> animation(const std::string& path, double scale, const std::shared_ptr<const SkinFile>& skin);
  // From the mesh that mesh() returns to the shape.
  static Eigen::Affine3d placement_of(const GeometryDef& geometry);

  // Never null. Without its alpha all of it is opaque.
  std::shared_ptr<const Texture> texture(const std::string& path, bool has_alpha = true);
  // Bumps: bytes are used as they are.
  std::shared_ptr<const Texture> normal_map(const std::string& path);
  // One white pixel.
  std::shared_ptr<const Texture> white() const { return white_; }
  // The layers of a height map blended by height into one picture that covers it; null when it has no readable layer.
  std::shared_ptr<const Texture> height_texture(const HeightmapShape& shape);

  // Takes what another one has read, in another thread: its pictures replace those of the same names. What this one has handed out stays as
  // it is.
  void adopt(Assets&& other);

  // What could not be read since the last call, one line each.
  std::vector<std::string> take_complaints();

 private:
  std::shared_ptr<const Mesh> load(const MeshShape& shape);
  std::shared_ptr<const Mesh> load(const HeightmapShape& shape);
  std::shared_ptr<const Mesh> load(const PolylineShape& shape);
  base::Result<Image> image(const std::string& path, int largest_side, FileStamps& files);
  void keep_images(std::vector<EmbeddedImage>&& images, const FileStamps& files);
  // By a key, through the shelf that all share.
  base::Result<std::shared_ptr<const Texture>> shelved(const std::string& key, const std::string& path, int largest_side,
                                                       const std::function<Texture(Image)>& make);

  ModelPath model_path_;
  std::shared_ptr<const Mesh> box_, sphere_, cylinder_, plane_, missing_mesh_;
  std::shared_ptr<const Texture> missing_texture_, flat_normals_, white_;
  TriangleCache triangles_;
  std::map<std::string, std::shared_ptr<const Mesh>> meshes_;
  std::map<std::string, std::shared_ptr<const Texture>> textures_;
  std::map<std::string, std::shared_ptr<const SkinFile>> skins_;
  std::map<std::string, std::shared_ptr<const SkinAnimation>> animations_;
  struct Embedded {
    std::vector<std::uint8_t> bytes;
    FileStamps files;  // that it is a part of
  };
  std::map<std::string, Embedded> embedded_;
  std::vector<std::string> complaints_;
};

}  // namespace sim
