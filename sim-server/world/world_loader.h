// Reads SDFormat worlds and models (and URDF models) into definitions. Never throws, never prints, ends in bounded time whatever the file
// holds: what is wrong becomes findings, and the rest of the world is there. One thread at a time (libsdformat has global state).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "world/found_files.h"
#include "world/model_path.h"
#include "world/world_def.h"

namespace sim {

struct LoadResult {
  WorldDef world;
  std::vector<Finding> findings;
  bool dropped = false;  // some finding is of severity `dropped`
  FoundFiles found;
};

// Fails only when there is no world at all: no such file, not XML, older than SDF, no <world> in it. The world's own folder is searched
// first.
base::Result<LoadResult> load_world(const std::filesystem::path& file, const ModelPath& model_path);
// The same from text; `folder` is where relative names are looked for, `name` stands for the file in findings.
base::Result<LoadResult> load_world_text(std::string_view text, const std::filesystem::path& folder, const std::string& name,
                                         const ModelPath& model_path);

struct LoadedModel {
  ModelDef model;
  std::vector<LightDef> lights;  // of an SDF file that holds lights besides the model
  std::vector<Finding> findings;
  bool dropped = false;
  FoundFiles found;  // with its own file
};

// A model to spawn: `what` is SDF or URDF text (begins with '<' after blanks), a file, a folder with a model.config, or a URI
// (model://name). An empty `instance_name` keeps the model's own name. The pose given replaces the one in the file. Fails when no model
// comes out of it.
base::Result<LoadedModel> load_model(std::string_view what, const std::string& instance_name, const std::optional<Eigen::Isometry3d>& pose,
                                     const ModelPath& model_path);

}  // namespace sim
