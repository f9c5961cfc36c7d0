// The colliding shapes of a model, as corners in its frame. Planes, height fields and meshes are left out. Any thread.
#pragma once

#include <filesystem>
#include <pugixml.hpp>

#include "campaign/rows/footprint.h"
#include "campaign/rows/model_files.h"

namespace campaign {

// Of a <model> or <include> in a file of folder `at`.
Outline outline_of(pugi::xml_node node, const std::filesystem::path& at, const ModelFiles& files);

}  // namespace campaign
