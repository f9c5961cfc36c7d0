// Worlds that are heavy for physics: a robot of 49 links, thousands of things that lie about. Values; any thread.
#pragma once

#include <string>

#include "support/worlds.h"

namespace sim::test {

// A base on four swivel casters of two wheels each, a torso that rises, a head and two arms with hands: 49 links, 48 joints.
class ManyLinks {
 public:
  explicit ManyLinks(const std::string& name, const Eigen::Isometry3d& pose) {
    model_ = body(name, BoxShape{{0.6, 0.6, 0.2}}, pose, 80);
    model_.links[0].name = "base";
    model_.canonical_link = "base";
    model_.links[0].pose = at(0, 0, 0.26);
    for (const double x : {-0.22, 0.22}) {
      for (const double y : {-0.22, 0.22}) caster(x, y);
    }
    add("torso", "base", BoxShape{{0.3, 0.3, 0.5}}, at(0, 0, 0.7), at(0, 0, 0.5), JointDef::Kind::prismatic, {0, 0, 1}, 20);
    add("head_pan", "torso", BoxShape{{0.2, 0.2, 0.1}}, at(0, 0, 1.05), at(0, 0, 1), JointDef::Kind::revolute, {0, 0, 1}, 3);
    add("head_tilt", "head_pan", BoxShape{{0.2, 0.2, 0.1}}, at(0, 0, 1.2), at(0, 0, 1.1), JointDef::Kind::revolute, {0, 1, 0}, 2);
    for (const double side : {-1.0, 1.0}) arm(side);
    add("laser_tilt", "torso", BoxShape{{0.1, 0.1, 0.1}}, at(0.2, 0, 0.85), at(0.2, 0, 0.85), JointDef::Kind::revolute, {0, 1, 0}, 0.5);
  }
  const ModelDef& model() const { return model_; }

 private:
  void add(const std::string& name, const std::string& parent, const GeometryDef& shape, const Eigen::Isometry3d& pose,
           const Eigen::Isometry3d& place, JointDef::Kind kind, const Eigen::Vector3d& axis, double mass) {
    model_.links.push_back(link(name, shape, mass, pose));
    JointDef joint;
    joint.name = name + "_joint";
    joint.kind = kind;
    joint.parent = parent;
    joint.child = name;
    joint.pose_in_model = place;
    AxisDef def;
    def.xyz = axis;
    joint.axes = {def};
    model_.joints.push_back(joint);
  }
  void caster(double x, double y) {
    const std::string name = "caster" + std::to_string(model_.links.size());
    add(name, "base", BoxShape{{0.05, 0.05, 0.05}}, at(x, y, 0.13), at(x, y, 0.13), JointDef::Kind::continuous, {0, 0, 1}, 2);
    for (const double side : {-0.05, 0.05}) {
      const Eigen::Isometry3d pose = tilted(x - 0.03, y + side, 0.079, std::numbers::pi / 2, 0);
      add(name + (side < 0 ? "_r" : "_l"), name, CylinderShape{0.079, 0.03}, pose, at(x - 0.03, y + side, 0.079),
          JointDef::Kind::continuous, {0, 1, 0}, 0.5);
    }
  }
  void arm(double side) {
    std::string parent = "torso";
    const std::string name = side < 0 ? "right" : "left";
    double x = 0.1;
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector3d axis = i % 3 == 0 ? Eigen::Vector3d(0, 0, 1) : i % 3 == 1 ? Eigen::Vector3d(0, 1, 0) : Eigen::Vector3d(1, 0, 0);
      const std::string next = name + std::to_string(i);
      add(next, parent, BoxShape{{0.1, 0.06, 0.06}}, at(x + 0.05, 0.3 * side, 0.8), at(x, 0.3 * side, 0.8), JointDef::Kind::revolute, axis,
          1.5 - 0.1 * i);
      parent = next;
      x += 0.1;
    }
    for (int i = 0; i < 6; ++i) {
      add(name + "_finger" + std::to_string(i), i < 2 ? parent : name + "_finger" + std::to_string(i - 2), BoxShape{{0.04, 0.01, 0.02}},
          at(x + 0.02 + 0.04 * (i / 2), 0.3 * side + (i % 2 == 0 ? -0.03 : 0.03), 0.8),
          at(x + 0.04 * (i / 2), 0.3 * side + (i % 2 == 0 ? -0.03 : 0.03), 0.8), JointDef::Kind::revolute, {0, 0, 1}, 0.1);
    }
  }
  ModelDef model_;
};

// A torso with limbs of turning joints, `bodies` in all: a humanoid with hands. It stands in the ground up to `depth` [m] of its height.
inline ModelDef humanoid(int bodies, double depth) {
  ModelDef model = body("humanoid", BoxShape{{0.3, 0.4, 0.6}}, at(0, 0, -depth), 20);
  model.links[0].name = model.canonical_link = "torso";
  model.links[0].pose = at(0, 0, 1.2);
  struct Tip {
    std::string link;
    Eigen::Vector3d place, step;
  };
  // Arms and legs hang down, a head stands up; fingers and toes are what comes when they are long enough.
  std::vector<Tip> tips = {{"torso", {0, 0.25, 1.4}, {0, 0.02, -0.09}},
                           {"torso", {0, -0.25, 1.4}, {0, -0.02, -0.09}},
                           {"torso", {0, 0.12, 0.9}, {0, 0, -0.07}},
                           {"torso", {0, -0.12, 0.9}, {0, 0, -0.07}},
                           {"torso", {0, 0, 1.5}, {0, 0, 0.05}}};
  for (int i = 1; i < bodies; ++i) {
    Tip& tip = tips[static_cast<std::size_t>(i) % (i < 20 ? 5 : 4)];
    const std::string name = "link" + std::to_string(i);
    model.links.push_back(
        link(name, BoxShape{{0.05, 0.05, 0.05}}, 0.5, at(tip.place.x(), tip.place.y(), tip.place.z() + 0.5 * tip.step.z())));
    JointDef joint;
    joint.name = name + "_joint";
    joint.kind = JointDef::Kind::revolute;
    joint.parent = tip.link, joint.child = name;
    joint.pose_in_model = at(tip.place.x(), tip.place.y(), tip.place.z());
    AxisDef axis;
    axis.xyz = Eigen::Vector3d::Unit(i / 4 % 3);
    axis.lower = -1.5, axis.upper = 1.5;
    axis.damping = 0.1;
    joint.axes = {axis};
    model.joints.push_back(joint);
    tip.link = name;
    tip.place += tip.step;
  }
  return model;
}

// Boxes, balls and cans side by side on the ground, near enough to be looked at in pairs.
inline WorldDef resting_shapes(int count, double apart = 0.6) {
  WorldDef world;
  world.physics.step = 0.001;
  world.models.push_back(ground());
  const int side = static_cast<int>(std::ceil(std::sqrt(count)));
  for (int i = 0; i < count; ++i) {
    const double x = apart * (i % side), y = apart * (i / side);
    const GeometryDef shape = i % 3 == 0   ? GeometryDef(BoxShape{{0.3, 0.3, 0.3}})
                              : i % 3 == 1 ? GeometryDef(SphereShape{0.15})
                                           : GeometryDef(CylinderShape{0.15, 0.3});
    world.models.push_back(body("thing" + std::to_string(i), shape, at(x, y, 0.15), 2));
  }
  return world;
}

}  // namespace sim::test
