// Meshes, skins and animations from files: asks the reader of files, checks, and finds the pictures that they name.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "reader/asset_reader.h"
#include "render/mesh_arrays.h"
#include "world/triangle_arrays.h"

namespace sim {
namespace {

constexpr const char* no_image = "no_image";  // the reader's word for a COLLADA image without a file

// Where texture files of a mesh are found in the wild: beside it, in its model's usual folders, or where the author's disk had them.
std::string find_texture(const std::string& written, const std::filesystem::path& folder, const ModelPath& model_path) {
  namespace fs = std::filesystem;
  if (written == no_image) return {};
  std::string name = written;
  for (auto& c : name) c = c == '\\' ? '/' : c;
  if (name.find("://") != std::string::npos && !name.starts_with("file://")) {
    if (const auto found = model_path.find(name, folder)) return found->string();
    name.erase(0, name.find("://") + 3);
  }
  if (name.starts_with("file://")) name.erase(0, 7);
  const fs::path last = fs::path(name).filename();
  for (const fs::path& candidate : {folder / name, folder / last, folder / "../materials/textures" / last,
                                    folder / "materials/textures" / last, folder / "../textures" / last, folder / "textures" / last}) {
    std::error_code error;
    if (fs::is_regular_file(candidate, error)) return candidate.lexically_normal().string();
  }
  return (folder / name).lexically_normal().string();  // opening it will say that it is missing
}

// Textures inside the file keep their names.
void find_textures(MeshFile& file, const std::string& path, const ModelPath& model_path) {
  const auto folder = std::filesystem::path(path).parent_path();
  for (MeshPart& part : file.mesh.parts) {
    std::string& texture = part.material.texture;
    const auto is_same = [&](const EmbeddedImage& image) { return image.name == texture; };
    if (texture.empty() || std::any_of(file.images.begin(), file.images.end(), is_same)) continue;
    texture = find_texture(texture, folder, model_path);
  }
}

// Textures have the names that the file has for them.
AssetShelf<MeshFile>::Made ask_for_mesh(const AssetReader::Question& question, Skin* skin) {
  const auto answer = AssetReader::mine().ask(question);
  auto file = AssetReader::decoded<MeshFile>(question, answer, [&](ArrayReader& in, MeshFile& out) {
    if (!take(in, out, skin)) return false;
    finish(out.mesh);
    out.files = answer.files;
    return true;
  });
  return {std::move(file), answer.files, answer.result.size(), !answer.files.empty()};
}

AssetShelf<MeshFile>& mesh_file_shelf() {
  static auto& shelf = *new AssetShelf<MeshFile>(std::size_t{256} << 20U);  // never destroyed: as the reader
  return shelf;
}

}  // namespace

base::Result<MeshFile> read_mesh_file(const MeshShape& shape, const ModelPath& model_path) {
  ArrayWriter details;
  put(details, shape);
  const auto found = mesh_file_shelf().get(shape.path + '|' + details.bytes(), [&] {
    return ask_for_mesh({AssetKind::mesh, shape.path, "mesh", details.bytes()}, nullptr);
  });
  if (!found.value) return found.value.error();
  MeshFile file = **found.value;
  find_textures(file, shape.path, model_path);
  return file;
}

base::Result<SkinFile> read_skin_file(const std::string& path, double scale, const ModelPath& model_path) {
  ArrayWriter details;
  details.number(scale);
  SkinFile out;
  auto file = ask_for_mesh({AssetKind::skin, path, "mesh", details.bytes()}, &out.skin).value;
  if (!file) return file.error();
  find_textures(*file, path, model_path);
  out.files = std::move(file->files);
  out.mesh = std::move(file->mesh);
  out.images = std::move(file->images);
  return out;
}

}  // namespace sim
