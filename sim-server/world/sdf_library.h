// The only neighbour of libsdformat. Three things are asked of it, none of them with a whole world in its hands (its element tree costs
// megabytes per model): translate a document of an older SDFormat version or URDF to the current one, say what the specification allows,
// and resolve frames. One thread at a time.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "world/complaints.h"

namespace sim {

inline constexpr const char* current_sdf_version = "1.9";

struct ResolvedJoint {
  std::string parent, child;                               // links, scoped as seen from the model; empty: the world
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the model
  std::vector<Eigen::Vector3d> axes;                       // unit, in the joint's frame
};
struct ResolvedModel {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the world, or in the model around it
  std::string canonical_link;                              // scoped as seen from this model
  std::map<std::string, Eigen::Isometry3d> links;          // in this model
  std::map<std::string, Eigen::Isometry3d> frames;         // in this model
  std::map<std::string, ResolvedJoint> joints;
  std::map<std::string, ResolvedModel> models;
};
struct ResolvedWorld {
  std::map<std::string, Eigen::Isometry3d> frames;
  std::map<std::string, ResolvedModel> models;
};

class SdfLibrary {
 public:
  SdfLibrary();
  ~SdfLibrary();
  SdfLibrary(const SdfLibrary&) = delete;
  SdfLibrary& operator=(const SdfLibrary&) = delete;

  // The document (its <sdf> element) in a later version; the marks are kept.
  base::Result<pugi::xml_document> translate(pugi::xml_node sdf, const std::string& version = current_sdf_version);
  // A URDF robot as an SDFormat document; without marks.
  base::Result<pugi::xml_document> translate_urdf(const std::string& text);

  // Removes what the specification does not know (a warning each) and values that are of another type than it says; gives unnamed things
  // names. `entity` is a <world>, <model>, <actor> or <light> of the current version.
  void check(pugi::xml_node entity, Complaints& complaints);

  // Frames of a world that holds nothing but models, links, joints and frames. The errors of libsdformat when there are any.
  base::Result<ResolvedWorld> resolve(pugi::xml_node sdf);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sim
