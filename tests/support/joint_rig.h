// One joint of any kind between two links, for tests. One thread.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "support/physics_fixture.h"

namespace sim::test {

inline constexpr double g = 9.8;  // [m/s^2] of worlds that do not say it

// A model whose link `arm` (1 kg, moments 0.02, 0.03, 0.04, no shape) hangs on `base`, which is welded to the world or free. The joint's
// frame is that of the arm, unless `pose` says otherwise.
struct JointRig {
  std::string kind = "revolute";
  std::string axes{};        // <axis> and more
  std::string joint_pose{};  // in the arm
  std::string arm_pose = "0 0 1 0 0 0";
  std::string center{};  // of mass in the arm
  std::string gravity = "0 0 0";
  std::string extra{};  // links and joints
  bool is_base_free = false;
  bool is_base_parent = true;
  std::string version = "1.9";
};

inline std::string inertial(const std::string& center = "0 0 0 0 0 0", double mass = 1, double scale = 1) {
  const auto n = [&](double v) { return std::to_string(v * scale); };
  return "<inertial><pose>" + center + "</pose><mass>" + std::to_string(mass) + "</mass><inertia><ixx>" + n(0.02) + "</ixx><iyy>" +
         n(0.03) + "</iyy><izz>" + n(0.04) + "</izz></inertia></inertial>";
}

inline PhysicsFixture make(const JointRig& rig) {
  const std::string base = rig.is_base_free ? "" : "<joint name='held' type='fixed'><parent>world</parent><child>base</child></joint>";
  const std::string parent = rig.is_base_parent ? "base" : "arm", child = rig.is_base_parent ? "arm" : "base";
  WorldDef world = world_of_text(
      "<gravity>" + rig.gravity + "</gravity><model name='m'><allow_auto_disable>false</allow_auto_disable><link name='base'>" +
          inertial("0 0 0 0 0 0", 2, 2) + "</link><link name='arm'><pose>" + rig.arm_pose + "</pose>" +
          inertial(rig.center.empty() ? "0 0 0 0 0 0" : rig.center) + "</link>" + base + "<joint name='j' type='" + rig.kind + "'>" +
          (rig.joint_pose.empty() ? "" : "<pose>" + rig.joint_pose + "</pose>") + "<parent>" + parent + "</parent><child>" + child +
          "</child>" + rig.axes + "</joint>" + rig.extra + "</model>",
      rig.version);
  return PhysicsFixture(std::move(world));
}

inline std::string axis(const std::string& xyz, const std::string& more = "", const std::string& name = "axis") {
  return "<" + name + "><xyz>" + xyz + "</xyz>" + more + "</" + name + ">";
}

inline void spin(PhysicsFixture& f, const Eigen::Vector3d& rate, const std::string& link = "m::arm") {
  const Eigen::Vector3d moments(0.02, 0.03, 0.04);
  ASSERT_TRUE(f.physics.add_wrench(f.link(link), {0, 0, 0}, moments.cwiseProduct(rate) / f.physics.step_length()));
  f.physics.step();
}

inline double rate_of(const PhysicsFixture& f, int axis = 0) { return f.physics.joint_state(f.joint("m", "j"), axis).velocity; }
inline double place_of(const PhysicsFixture& f, int axis = 0) { return f.physics.joint_state(f.joint("m", "j"), axis).position; }

}  // namespace sim::test
