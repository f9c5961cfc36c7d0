// The plan of a model in ODE, computed once and used whenever the model is built: links that are joined rigidly form one assembly, which is
// one body. Constant after creation; any thread.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "world/airframe_defs.h"
#include "world/body_force_defs.h"
#include "world/world_def.h"

namespace sim {

struct Assembly {
  std::vector<std::uint32_t> links;  // indexes into the model's links; the first gives the body its axes
  bool is_anchored = false;          // joined to the world, or of a static model: never moves
  bool is_kinematic = false;
  bool has_gravity = true;
  double mass = 0;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity();       // about the body's origin, which is the centre of mass
  Eigen::Isometry3d in_model = Eigen::Isometry3d::Identity();  // the body's frame at the start
  double linear_damping = 0, angular_damping = 0;
  double wind_mass = 0;  // of its links that the wind takes along
  // Joints with an initial position or a saved state move it, within the model, from where the file has it.
  std::optional<Eigen::Isometry3d> moved_at_start;
  Eigen::Vector3d start_linear{0, 0, 0}, start_angular{0, 0, 0};  // of its first link's origin, in the world
};

struct Blueprint {
  std::shared_ptr<const ModelDef> model;
  std::vector<Assembly> assemblies;
  std::vector<std::uint32_t> assembly_of_link;
  std::vector<Eigen::Isometry3d> link_in_body;
  std::vector<std::uint32_t> joints;  // those that are more than a weld, indexes into the model's joints
  std::uint32_t canonical = 0;        // link
  bool is_static = false;             // no assembly moves
  bool is_joined_to_world = false;    // has a joint that is not fixed between a link and the world
  std::vector<HydrodynamicsDef> hydrodynamics;
  std::vector<WingDef> wings;
  std::vector<AirframeDef> airframes;
  std::vector<AirshipDef> airships;
  std::vector<FloatingHullDef> hulls;
  std::vector<std::string> notes;     // one line each: what is simulated in another way than written
  std::vector<std::string> left_out;  // the same of what is not simulated

  // Fails when a number is not finite or a mass or size cannot be simulated.
  static base::Result<std::shared_ptr<const Blueprint>> of(std::shared_ptr<const ModelDef> model);
};

// Points in the model on the axes about which a gearbox turns its parent and its child: those of the joints that hold them.
std::pair<Eigen::Vector3d, Eigen::Vector3d> gear_anchors(const ModelDef& model, const JointDef& gearbox);

}  // namespace sim
