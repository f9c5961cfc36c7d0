// Controlled joints in the solver, without ifaces.
#include "physics/joint_control.h"

#include <gtest/gtest.h>

#include "physics/joint_dynamics.h"
#include "support/arms.h"
#include "support/physics_fixture.h"

namespace sim {
namespace {

using namespace test;

constexpr double tenth_of_a_degree = 0.1 * std::numbers::pi / 180;
const std::vector<double> reached{.3, -1.2, 1.5, -.9, -1.1, .7};

// The first model of a world, with a servo for each joint that is named.
class Rig {
 public:
  Rig(WorldDef world, std::vector<std::uint32_t> joints)
      : f(std::move(world)), joints_(std::move(joints)), dynamics_(f.physics.def(0), joints_), gravity_(joints_.size()) {
    const std::vector<double> start(joints_.size(), 0.0);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const AxisDef& axis = f.physics.def(0).joints[joints_[i]].axes[0];
      servos.emplace_back(JointServo::Setup{.gains = derived_gains(dynamics_.inertia(start, i)),
                                            .low = axis.lower,
                                            .high = axis.upper,
                                            .velocity = axis.velocity,
                                            .effort = axis.effort,
                                            .slides = dynamics_.body(i).slides,
                                            .is_compensated = true});
    }
  }
  JointState state(std::size_t i) const { return f.physics.joint_state({0, joints_[i]}); }
  void go_to(const std::vector<double>& goals) {
    for (std::size_t i = 0; i < goals.size(); ++i) servos[i].take({.mode = JointMode::position, .value = goals[i]}, state(i));
  }
  template <class Each>
  void run(double seconds, const Each& each) {
    const double dt = f.physics.step_length();
    for (int n = static_cast<int>(std::lround(seconds / dt)); n > 0; --n) {
      std::vector<double> positions;
      for (std::size_t i = 0; i < joints_.size(); ++i) positions.push_back(state(i).position);
      dynamics_.efforts(positions, {}, {}, {0, 0, -9.81}, gravity_);
      for (std::size_t i = 0; i < joints_.size(); ++i) {
        if (servos[i].is_active())
          f.physics.set_row({0, joints_[i]}, servos[i].row(state(i), servos[i].wants_gravity() ? gravity_[i] : 0, dt));
      }
      each();
      f.physics.step();
      for (std::size_t i = 0; i < joints_.size(); ++i) servos[i].follow(state(i), dt);
    }
  }
  void run(double seconds) {
    run(seconds, [] {});
  }

  PhysicsFixture f;
  std::vector<JointServo> servos;

 private:
  std::vector<std::uint32_t> joints_;
  JointDynamics dynamics_;
  std::vector<double> gravity_;
};

TEST(JointControl, an_arm_that_holds_five_kilograms_is_the_same_at_steps_of_one_and_five_milliseconds) {
  for (const bool is_known : {true, false}) {
    SCOPED_TRACE(is_known ? "payload of the last link" : "a weight at the last link that nobody has told");
    std::vector<std::vector<double>> at_steps;
    for (const double step : {0.001, 0.005}) {
      Rig rig(arm_world(arm_model(ur5(), is_known ? 5 : 0), step), {1, 2, 3, 4, 5, 6});
      rig.go_to(reached);
      rig.run(6, [&] {
        if (!is_known) {
          EXPECT_TRUE(rig.f.physics.add_wrench({0, 6}, {0, 0, -5 * 9.81}, {0, 0, 0}).ok());
        }
      });
      at_steps.emplace_back();
      for (std::size_t i = 0; i < reached.size(); ++i) {
        at_steps.back().push_back(rig.state(i).position);
        EXPECT_NEAR(rig.state(i).position, reached[i], tenth_of_a_degree) << i << " step " << step;
        EXPECT_LT(std::abs(rig.state(i).velocity), 1e-3) << i << " step " << step;
        EXPECT_EQ(rig.servos[i].status(), JointStatus::idle) << i << " step " << step;
      }
    }
    for (std::size_t i = 0; i < reached.size(); ++i) EXPECT_NEAR(at_steps[0][i], at_steps[1][i], tenth_of_a_degree);
  }
}

TEST(JointControl, keeps_the_highest_velocity_and_effort) {
  Rig rig(arm_world(arm_model(ur5(), 5), 0.001), {1, 2, 3, 4, 5, 6});
  rig.go_to({3, -3, 2.5, 1, -2, 6});
  double fastest = 0, strongest = 0;
  rig.run(3, [&] {
    for (std::size_t j = 0; j < 6; ++j) {
      fastest = std::max(fastest, std::abs(rig.state(j).velocity) / std::numbers::pi);
      strongest = std::max(strongest, std::abs(rig.servos[j].effort()) / ur5().efforts[j]);
    }
  });
  EXPECT_LT(fastest, 1.1);
  EXPECT_LT(strongest, 1 + 1e-9);
}

TEST(JointControl, brakes_hold_an_arm_where_it_stopped) {
  Rig rig(arm_world(arm_model(ur5(), 5), 0.001), {1, 2, 3, 4, 5, 6});
  rig.go_to(reached);
  rig.run(0.3);
  for (std::size_t i = 0; i < 6; ++i) rig.servos[i].take({.mode = JointMode::brake}, rig.state(i));
  rig.run(0.5);
  std::vector<double> stopped;
  for (std::size_t i = 0; i < 6; ++i) stopped.push_back(rig.state(i).position);
  rig.run(2);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(rig.state(i).position, stopped[i], 1e-4) << i;
    EXPECT_EQ(rig.servos[i].status(), JointStatus::braked) << i;
  }
}

TEST(JointControl, an_effort_that_compensates_gravity_lets_an_arm_float) {
  Rig rig(arm_world(arm_model(ur5(), 5), 0.001), {1, 2, 3, 4, 5, 6});
  for (std::size_t i = 0; i < 6; ++i) rig.servos[i].take({.mode = JointMode::effort, .is_compensated = true}, rig.state(i));
  rig.run(1);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(rig.state(i).position, 0, 1e-3) << i;
}

// One wheel of 0.01 kg m^2.
WorldDef wheel_world(double step) {
  ModelDef model;
  model.name = "arm";
  model.links.push_back(link("base", BoxShape{}, 1, at(0, 0, 0)));
  model.links.push_back(link("wheel", SphereShape{0.05}, 1, at(0, 0, 1)));
  model.links.back().inertia = 0.01 * Eigen::Matrix3d::Identity();
  for (auto& each : model.links) each.collisions.clear();
  model.canonical_link = "base";
  JointDef foot, hub;
  foot.name = "foot", foot.child = "base";
  hub.name = "hub", hub.kind = JointDef::Kind::revolute, hub.parent = "base", hub.child = "wheel", hub.pose_in_model = at(0, 0, 1);
  hub.axes.emplace_back();
  model.joints = {foot, hub};
  return arm_world(model, step);
}

TEST(JointControl, a_spring_gives_way_alike_at_every_step) {
  for (const double step : {0.001, 0.005}) {
    PhysicsFixture f(wheel_world(step));
    JointServo servo({.gains = {.p = 2000, .d = 20}, .velocity = 10});
    const JointId hub{0, 1};
    servo.take({.mode = JointMode::position}, f.physics.joint_state(hub));
    for (int i = 0; i < 400; ++i) {
      f.physics.set_row(hub, servo.row(f.physics.joint_state(hub), 0, step));
      ASSERT_TRUE(f.physics.add_wrench({0, 1}, {0, 0, 0}, {0, 0, 10}).ok());
      f.physics.step();
      servo.follow(f.physics.joint_state(hub), step);
    }
    EXPECT_NEAR(f.physics.joint_state(hub).position, 0.005, 1e-5) << step;
    EXPECT_NEAR(servo.effort(), -10, 0.01) << step;
  }
}

TEST(JointControl, gains_beyond_what_an_explicit_controller_stands_are_stable) {
  PhysicsFixture f(wheel_world(0.005));
  JointServo servo({.gains = {.p = 1e6, .d = 1e4}, .velocity = 10, .effort = 1e6});
  const JointId hub{0, 1};
  servo.take({.mode = JointMode::position, .value = 1}, f.physics.joint_state(hub));
  for (int i = 0; i < 200; ++i) {
    f.physics.set_row(hub, servo.row(f.physics.joint_state(hub), 0, 0.005));
    f.physics.step();
    servo.follow(f.physics.joint_state(hub), 0.005);
    ASSERT_LT(f.physics.joint_state(hub).position, 1.001);
  }
  EXPECT_NEAR(f.physics.joint_state(hub).position, 1, 1e-4);
}

// Two fingers on a palm that slide apart, the second bound to the first.
WorldDef hand_world() {
  const auto finger = [](const std::string& name, const std::string& y) {
    return "<link name='" + name + "'><pose>0 " + y + " 1 0 0 0</pose><inertial><mass>0.1</mass><inertia><ixx>1e-4</ixx><iyy>1e-4</iyy>" +
           "<izz>1e-4</izz></inertia></inertial></link>";
  };
  const auto slide = [](const std::string& name, const std::string& child, const std::string& axis, const std::string& mimic) {
    return "<joint name='" + name + "' type='prismatic'><parent>palm</parent><child>" + child + "</child><axis><xyz>" + axis +
           "</xyz><limit><lower>-0.05</lower><upper>0.05</upper><effort>20</effort><velocity>1</velocity></limit>" + mimic +
           "</axis></joint>";
  };
  return world_of_text(
      "<gravity>0 0 -9.81</gravity><physics type='ode'><max_step_size>0.002</max_step_size></physics><model name='arm'><link name='palm'>"
      "<pose>0 0 1.1 0 0 0</pose></link><joint name='foot' type='fixed'><parent>world</parent><child>palm</child></joint>" +
      finger("left", "0.06") + finger("right", "-0.06") + slide("one", "left", "0 1 0", "") +
      slide("two", "right", "0 -1 0",
            "<mimic joint='one'><multiplier>0.5</multiplier><offset>0.01</offset><reference>0.02</reference></mimic>") +
      "</model>");
}

TEST(JointControl, a_joint_that_mimics_another_one_is_bound_to_it_in_both_directions) {
  Rig rig(hand_world(), {1});
  const auto follower = [&] { return rig.f.physics.joint_state({0, 2}).position; };
  rig.go_to({-0.03});
  rig.run(1);
  EXPECT_EQ(rig.f.physics.last_solver(0), StepSolver::tree);
  EXPECT_NEAR(rig.state(0).position, -0.03, 2e-4);
  EXPECT_NEAR(follower(), 0.5 * (rig.state(0).position - 0.02) + 0.01, 1e-6);
  // A push on the follower bends the leader's spring.
  rig.run(0.05, [&] { EXPECT_TRUE(rig.f.physics.add_wrench({0, 2}, {0, -4, 0}, {0, 0, 0}).ok()); });
  EXPECT_GT(rig.state(0).position, -0.0297);
  EXPECT_LT(rig.servos[0].effort(), -1);
  EXPECT_NEAR(follower(), 0.5 * (rig.state(0).position - 0.02) + 0.01, 1e-4);
}

}  // namespace
}  // namespace sim
