// A world as the simulator loads it: models with footprints and masses, and the files that it is made of. Asks sim-server --check --json
// once; nothing here searches for models or interprets SDFormat. Values; any thread.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "campaign/rows/footprint.h"
#include "run/model_parts.h"

namespace campaign {

struct SurveyedModel {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Outline outline;  // empty: nothing of it collides, or nothing with an end (a plane, a mesh)
  bool is_static = false;
  double mass = 0;  // [kg]
  tools::ModelParts parts;
};

// Absolute names of files, by the folder of the file that names them and the URI in it. Of an include: the SDFormat file.
using FoundFiles = std::map<std::pair<std::string, std::string>, std::string>;

struct WorldSurvey {
  std::map<std::string, SurveyedModel> models;
  FoundFiles found;
  std::set<std::string> files;         // all of the world and of the spawned models, without doubles
  std::vector<std::string> not_found;  // of the models to spawn
};

// `spawned`: models that events add, as files, folders or model://NAME. Fails with the simulator's message for a world that it cannot load.
base::Result<WorldSurvey> survey_world(const std::string& world, const std::vector<std::string>& resource_paths,
                                       const std::vector<std::string>& spawned);

}  // namespace campaign
