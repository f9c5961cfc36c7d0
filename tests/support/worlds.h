// Small worlds made by hand for tests and benchmarks of the simulator. Values; any thread.
#pragma once

#include <memory>
#include <numbers>
#include <string>

#include "world/world_def.h"

namespace sim::test {

inline Eigen::Isometry3d at(double x, double y, double z, double yaw = 0) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  pose.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  return pose;
}

inline Eigen::Isometry3d tilted(double x, double y, double z, double roll, double pitch, double yaw = 0) {
  Eigen::Isometry3d pose = at(x, y, z, yaw);
  pose.rotate(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()));
  return pose;
}

inline LinkDef link(const std::string& name, const GeometryDef& geometry, double mass, const Eigen::Isometry3d& pose) {
  LinkDef link;
  link.name = name;
  link.pose = pose;
  link.mass = mass;
  link.inertia = 0.1 * mass * Eigen::Matrix3d::Identity();
  if (const auto* box = std::get_if<BoxShape>(&geometry)) {
    const Eigen::Vector3d s = box->size.cwiseAbs2();
    link.inertia = (mass / 12 * Eigen::Vector3d(s.y() + s.z(), s.x() + s.z(), s.x() + s.y())).asDiagonal();
  } else if (const auto* sphere = std::get_if<SphereShape>(&geometry)) {
    link.inertia = 0.4 * mass * sphere->radius * sphere->radius * Eigen::Matrix3d::Identity();
  } else if (const auto* cylinder = std::get_if<CylinderShape>(&geometry)) {
    const double r2 = cylinder->radius * cylinder->radius, side = mass * (3 * r2 + cylinder->length * cylinder->length) / 12;
    link.inertia = Eigen::Vector3d(side, side, mass * r2 / 2).asDiagonal();
  }
  CollisionDef collision;
  collision.name = "collision";
  collision.geometry = geometry;
  link.collisions.push_back(collision);
  return link;
}

// A model of one link that has the model's pose.
inline ModelDef body(const std::string& name, const GeometryDef& geometry, const Eigen::Isometry3d& pose, double mass = 1) {
  ModelDef model;
  model.name = name;
  model.pose = pose;
  model.links.push_back(link("link", geometry, mass, Eigen::Isometry3d::Identity()));
  model.canonical_link = "link";
  return model;
}

inline ModelDef fixed(const std::string& name, const GeometryDef& geometry, const Eigen::Isometry3d& pose) {
  ModelDef model = body(name, geometry, pose);
  model.is_static = true;
  return model;
}

inline ModelDef ground() { return fixed("ground", PlaneShape{}, Eigen::Isometry3d::Identity()); }

inline SensorDef laser(const std::string& name, int beams, double from, double to, double range, const Eigen::Isometry3d& pose) {
  SensorDef sensor;
  sensor.name = name;
  sensor.kind = SensorKind::ray;
  sensor.type = "ray";
  sensor.pose = pose;
  sensor.update_rate = 10;
  RayDef ray;
  ray.horizontal = {beams, 1, from, to};
  ray.range_min = 0.02;
  ray.range_max = range;
  sensor.data = ray;
  return sensor;
}

inline ParameterNode node(const std::string& name, const std::string& text) { return {name, text, {}, {}}; }

// A Pioneer 2-DX with sphere wheels, a frictionless caster, a differential drive and a laser with 181 beams.
inline ModelDef pioneer(const std::string& name, const Eigen::Isometry3d& pose) {
  ModelDef model;
  model.name = name;
  model.pose = pose;
  model.canonical_link = "chassis";
  LinkDef chassis = link("chassis", BoxShape{{0.44, 0.33, 0.18}}, 6.6, at(-0.05, 0, 0.16));
  CollisionDef caster;
  caster.name = "caster";
  caster.geometry = SphereShape{0.04};
  caster.pose = at(-0.15, 0, -0.12);
  caster.surface.mu = caster.surface.mu2 = 0;
  chassis.collisions.push_back(caster);
  chassis.sensors.push_back(laser("laser", 181, -std::numbers::pi / 2, std::numbers::pi / 2, 8, at(0.1, 0, 0.15)));
  model.links.push_back(chassis);
  for (const double side : {1.0, -1.0}) {
    const std::string which = side > 0 ? "left" : "right";
    LinkDef wheel = link(which + "_wheel", SphereShape{0.0825}, 0.9, at(0, side * 0.165, 0.0825));
    wheel.inertia = Eigen::Vector3d(0.0017, 0.0031, 0.0017).asDiagonal();
    model.links.push_back(wheel);
    JointDef joint;
    joint.name = which + "_wheel_hinge";
    joint.kind = JointDef::Kind::continuous;
    joint.parent = "chassis";
    joint.child = which + "_wheel";
    joint.pose_in_model = at(0, side * 0.165, 0.0825);
    AxisDef axis;
    axis.xyz = {0, 1, 0};
    joint.axes.push_back(axis);
    model.joints.push_back(joint);
  }
  PluginDef drive;
  drive.name = "position2d";
  drive.filename = "libDiffDrivePlugin.so";
  drive.parameters.name = "plugin";
  drive.parameters.children = {node("left_joint", "left_wheel_hinge"), node("right_joint", "right_wheel_hinge"),
                               node("wheel_separation", "0.33"),       node("wheel_diameter", "0.165"),
                               node("max_wheel_torque", "5"),          node("max_wheel_acceleration", "1")};
  model.plugins.push_back(drive);
  return model;
}

}  // namespace sim::test
