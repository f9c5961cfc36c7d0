#include "asset-reader/import.h"

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/DefaultLogger.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string_view>
#include <vector>

#include "asset-reader/mesh_io.h"
#include "asset-reader/ply_check.h"
#include "asset-reader/scene_check.h"
#include "base/text.h"

namespace sim {
namespace {

constexpr std::array<std::string_view, 8> extensions{"dae", "stl", "obj", "ply", "gltf", "glb", "fbx", "bvh"};

// In small letters, without the dot.
std::string extension_of(const std::string& path) {
  std::string extension = base::to_lower(std::filesystem::path(path).extension().string());
  return extension.empty() ? extension : extension.substr(1);
}

}  // namespace

Import::Import(std::string path, FileLog& files) : path_(std::move(path)), files_(files) {
  const std::string extension = extension_of(path_);
  is_known_ = std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
  std::vector<Assimp::BaseImporter*> others;
  for (std::size_t i = 0; i < importer_.GetImporterCount(); ++i) {
    std::set<std::string> own;
    importer_.GetImporter(i)->GetExtensionList(own);
    if (!own.contains(extension)) others.push_back(importer_.GetImporter(i));
  }
  for (auto* other : others) {
    importer_.UnregisterLoader(other);
    delete other;  // no longer the importer's
  }
  importer_.SetIOHandler(new MeshIo(files));  // the importer's from now on
  importer_.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  if (Assimp::DefaultLogger::isNullLogger()) Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
  Assimp::DefaultLogger::get()->attachStream(&losses_, Assimp::Logger::Warn);
}

Import::~Import() { Assimp::DefaultLogger::get()->detachStream(&losses_, Assimp::Logger::Warn); }

void Import::Losses::write(const char* message) {
  has_lost_faces = has_lost_faces || std::string_view(message).find("faces had out-of-range indices") != std::string_view::npos;
}

base::Result<const aiScene*> Import::read(unsigned flags) {
  if (!is_known_) {
    std::vector<std::string> known;
    for (const auto extension : extensions) known.push_back("." + std::string(extension));
    return base::Error{"is of no format that is read; expected " + base::join(known, ", ")};
  }
  if (extension_of(path_) == "ply") {
    if (const auto content = files_.read(path_, max_mesh_file); content) {
      if (const auto whole = check_ply(*content); !whole) return whole.error();
    }
  }
  const auto checked = [this](const aiScene* scene) -> base::Result<const aiScene*> {
    if (scene == nullptr || scene->mRootNode == nullptr) return base::Error{import_fault(importer_.GetErrorString())};
    if (losses_.has_lost_faces) return base::Error{"is damaged: a face names a vertex that is not there"};
    if (const auto whole = check_scene(*scene); !whole) return whole.error();
    return scene;
  };
  // Before the steps after it, which read by the indexes of the file, and for the callers once more.
  auto scene = checked(importer_.ReadFile(path_, 0));
  if (!scene || flags == 0) return scene;
  drop_empty_faces(**scene);
  return checked(importer_.ApplyPostProcessing(flags));
}

}  // namespace sim
