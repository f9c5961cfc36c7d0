// Kinds of plugins in model files that the simulator supports, from any simulator that they were written for. Any thread.
#pragma once

#include "world/world_def.h"

namespace sim {

enum class PluginKind {
  differential_drive,   // two driven wheels
  skid_steer_drive,     // several driven wheels on each side
  car_drive,            // two steered wheels
  velocity_control,     // the model moves as it is told, without wheels
  trajectory_follower,  // the model follows way points
  joint_controller,     // joints keep the position or speed that it starts with until they are commanded
  detachable_joint,     // a link of the model holds one of another model
  unsupported_drive,    // drives with other wheels or none
  buoyancy,             // of the world
  battery,              // drives the motors of the model until it is empty
  label,                // of a model, visual or actor: what cameras that segment call it
  thermal,              // of a visual: its temperature
  thermal_sensor,       // of a thermal camera: how it counts
  fiducial,             // of a model: a mark that detectors recognise
  hydrodynamics,        // damping and added mass of a link in water
  lift_drag,            // a wing, sail, fin or blade
  advanced_lift_drag,   // an aeroplane by its stability derivatives
  lighter_than_air,     // the hull of an airship
  floating_hull,        // round hulls of a boat, by points on them
  buoyancy_engine,      // a bladder that lifts and sinks an underwater vehicle
  thruster,             // a propeller in water, on a joint
  rotor,                // a propeller in air, on a joint
  multicopter_control,  // turns rotors as a commanded velocity needs
  joint_force,          // a joint that clients command by its effort
  link_wrench,          // of the world: forces that stay
  wind_effects,         // of the world: how its wind rises and swings
  // On land.
  mecanum_drive,          // four wheels with rollers at 45 degrees
  omni_drive,             // wheels with rollers that stand square to them, wherever they are
  tricycle_drive,         // one wheel is driven and steered
  tracked_vehicle,        // tracks on both sides
  track_controller,       // of a track of a vehicle, or of a belt
  wheel_slip,             // wheels slip the more the faster they turn
  odometry_publisher,     // the true pose, with noise
  joint_state_publisher,  // angles of joints that nobody commands
  implied,                // what it does is done by the simulator anyway (sensors, physics, clock, user interface of Gazebo)
  unknown,
};

// By file name first ("libDiffDrivePlugin.so", "gz-sim-diff-drive-system", "ignition-gazebo-...", with or without "lib", ".so" and
// version), then by the class in the name ("gz::sim::systems::DiffDrive").
PluginKind kind_of(const PluginDef& plugin);
PluginKind kind_of_plugin(std::string_view filename, std::string_view name);

// Those with an iface position2d.
bool is_wheel_drive(PluginKind kind);

// Of the world; others mean a model, or what is in it. Nothing: it may stand in both, or is not known.
std::optional<bool> is_of_world(PluginKind kind);

// Of a car drive: it steers, and controllers of single joints turn the wheels.
bool is_steering_only(const PluginDef& plugin);
// Of gz-sim's JointController without force commands: its motor turns the joint as told, whatever that takes.
bool turns_as_told(const PluginDef& plugin);
// Propellers: their joints take commands like others, and push.
bool is_propeller(PluginKind kind);
// Of a model: false for a controller of a track that a vehicle's own plugin drives, which only gives limits.
bool has_own_drive(const ModelDef& model, const PluginDef& plugin);
// The links that a vehicle's plugin calls so (left_track, right_track): of gz-sim in an element <link>, of Gazebo classic as the text.
std::vector<std::string> tracks_of(const PluginDef& vehicle, std::string_view side);

// What the iface of a drive plugin is called after model and scope: the plugin's name, or "position2d" when that is missing or the name of
// a class. Of a battery: its <battery_name>, or "battery".
std::string iface_own_name(const PluginDef& plugin);

}  // namespace sim
