// Materials of visuals: colours and textures as written, from OGRE material scripts, or from the colours that are built into Gazebo. One
// thread at a time.
#pragma once

#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "world/complaints.h"
#include "world/model_path.h"
#include "world/world_def.h"

namespace sim {

// The materials in the text of an OGRE script, by name, each with what it inherits from others of the same text. Textures stay as written.
// `faults` gets those that inherit in a circle, each with what to say of it.
std::map<std::string, MaterialDef> parse_material_script(const std::string& text, std::map<std::string, std::string>* faults = nullptr);

// The built-in material "Gazebo/..." as a plain colour; empty for names that Gazebo does not have.
std::optional<MaterialDef> built_in_material(std::string_view name);

// For a picture that Gazebo brings along ("file://media/materials/textures/grass.jpg") and that is not here: what stands for its path, in
// its colour. Empty for others.
std::string color_of_media(std::string_view uri);

class Materials {
 public:
  Materials(const ModelPath& model_path, Complaints& complaints);

  // Of a <material> element whose file names are absolute already.
  MaterialDef read(pugi::xml_node material);

 private:
  std::optional<MaterialDef> from_script(pugi::xml_node script, const std::string& name);
  const std::map<std::string, MaterialDef>& script_file(const std::string& path);

  const ModelPath& model_path_;
  Complaints& complaints_;
  std::map<std::string, std::map<std::string, MaterialDef>> scripts_;
  std::map<std::string, std::string> faults_;  // of materials that nobody has asked for yet
};

}  // namespace sim
