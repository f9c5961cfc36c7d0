// The <state> elements of a world that Gazebo classic saved: what was added, taken away and moved since its models were made, and how
// their links stood and moved. `apply` changes the XML before it is read; `move` sets the links of a model that was built from it.
// One thread.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>

#include "world/world_def.h"

namespace sim {

class SavedState {
 public:
  // Takes every <state> out of `world` and does to its other children what they say. A pose that cannot be read changes nothing.
  void apply(pugi::xml_node world);
  // Gives links of the model (whose name is the one in the world) their saved poses and velocities.
  void move(ModelDef& model) const;

 private:
  struct Link {
    std::string link;                       // with its scope
    std::optional<Eigen::Isometry3d> pose;  // in the world
    Eigen::Vector3d linear{0, 0, 0}, angular{0, 0, 0};
  };
  void collect_links(pugi::xml_node saved, const std::string& model, const std::string& scope);

  std::multimap<std::string, Link> links_;  // by model, in the order of the file
};

}  // namespace sim
