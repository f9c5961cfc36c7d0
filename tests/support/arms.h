// Arms made by hand for tests: those whose numbers everybody knows. Values; any thread.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "support/worlds.h"

namespace sim::test {

// One row of Denavit and Hartenberg's table.
struct DhRow {
  double d, a, alpha;
};
inline Eigen::Isometry3d dh_pose(const DhRow& row, double q) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(q, Eigen::Vector3d::UnitZ()));
  pose.translate(Eigen::Vector3d(row.a, 0, row.d));
  pose.rotate(Eigen::AngleAxisd(row.alpha, Eigen::Vector3d::UnitX()));
  return pose;
}

struct ArmNumbers {
  std::array<DhRow, 6> table;
  std::array<double, 6> masses, reaches, efforts;  // reach: of the centres of mass from the base axis, stretched
  double height;                                   // of the shoulder
};
inline ArmNumbers ur5() {
  constexpr double right = std::numbers::pi / 2;
  return {{{{.089159, 0, right}, {0, -.425, 0}, {0, -.39225, 0}, {.10915, 0, right}, {.09465, 0, -right}, {.0823, 0, 0}}},
          {3.7, 8.393, 2.275, 1.219, 1.219, .1879},
          {0, .2125, .54493, .81725, .81725, .81725},
          {150, 150, 150, 28, 28, 28},
          .089159};
}
inline ArmNumbers ur10() {
  constexpr double right = std::numbers::pi / 2;
  return {{{{.1273, 0, right}, {0, -.612, 0}, {0, -.5723, 0}, {.163941, 0, right}, {.1157, 0, -right}, {.0922, 0, 0}}},
          {7.778, 12.93, 3.87, 1.96, 1.96, .202},
          {0, .38757, .8104, 1.1843, 1.1843, 1.1843},
          {330, 330, 150, 56, 56, 56},
          .1273};
}

// On the ground of the world, without shapes; `payload`: at the reach of the wrist, in the last link.
inline ModelDef arm_model(const ArmNumbers& numbers, double payload = 0, bool is_limited = true) {
  ModelDef model;
  model.name = "arm";
  model.links.push_back(link("base", BoxShape{{0.1, 0.1, 0.02}}, 4, at(0, 0, 0)));
  model.links.back().collisions.clear();
  JointDef foot;
  foot.name = "foot", foot.kind = JointDef::Kind::fixed, foot.child = "base";
  model.joints.push_back(foot);
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < 6; ++i) {
    LinkDef moved;
    moved.name = "link" + std::to_string(i + 1);
    moved.pose.translation() = frame.translation();
    moved.mass = numbers.masses[i] + (i == 5 ? payload : 0);
    moved.center_of_mass = Eigen::Vector3d(-numbers.reaches[i], frame.translation().y(), numbers.height) - frame.translation();
    moved.inertia = moved.mass * 0.003 * Eigen::Matrix3d::Identity();
    JointDef joint;
    joint.name = "joint" + std::to_string(i + 1), joint.kind = JointDef::Kind::revolute;
    joint.parent = model.links.back().name, joint.child = moved.name;
    joint.pose_in_model = frame;
    joint.pose_in_child = moved.pose.inverse() * frame;
    AxisDef axis;
    if (is_limited) axis.effort = numbers.efforts[i];
    axis.velocity = std::numbers::pi;
    axis.lower = -2 * std::numbers::pi, axis.upper = 2 * std::numbers::pi;
    joint.axes.push_back(axis);
    model.links.push_back(moved);
    model.joints.push_back(joint);
    frame = frame * dh_pose(numbers.table[i], 0);
  }
  model.canonical_link = "base";
  return model;
}

inline WorldDef arm_world(ModelDef arm, double step) {
  WorldDef world;
  world.physics.step = step;
  world.physics.gravity = {0, 0, -9.81};
  world.models.push_back(std::move(arm));
  return world;
}

}  // namespace sim::test
