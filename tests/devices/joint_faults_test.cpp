// Joints that are out of order on purpose; where gains come from, and what joints are for people who command them.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "devices/joints/joint_groups.h"
#include "devices/joints/joint_list.h"
#include "support/commanded_joints.h"
#include "support/paths.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;
using testing::HasSubstr;
using Rig = CommandedJoints;

TEST(Joints, take_gains_from_a_file_that_is_named_before_those_of_the_file_beside_the_model) {
  auto def = arm_model(ur5());
  def.gains = {{"joint2", 1000, 0, 20, -infinite, infinite, false, "beside.yaml:3"},
               {"joint2", 2000, 0, 40, -infinite, infinite, true, std::string(100, 'x') + "/named.yaml:7"},
               {"joint3", 500, 2, 10, -infinite, infinite, false, "beside.yaml:4"}};
  Rig rig(arm_world(def, 0.001));
  EXPECT_EQ(rig.info(1).p, 2000);
  EXPECT_EQ(rig.info(1).d, 40);
  EXPECT_THAT(rig.info(1).gains_from, testing::AllOf(testing::StartsWith("..."), testing::EndsWith("/named.yaml:7")));
  EXPECT_EQ(rig.info(2).p, 500);
  EXPECT_STREQ(rig.info(2).gains_from, "beside.yaml:4");
  EXPECT_EQ(rig.info(2).compensated, 0U);
  EXPECT_THAT(rig.info(3).gains_from, HasSubstr("derived"));
}

// --- groups

TEST(JointGroups, are_what_people_command_and_nothing_that_hangs_free) {
  const auto groups = [](const std::string& model) {
    auto loaded = load_world(std::string(paths::source_dir) + "/" + model, ModelPath{});
    if (!loaded) throw std::runtime_error(loaded.error().message);
    std::string text;
    for (const ModelDef& def : loaded->world.models) {
      for (const JointGroup& group : joint_groups(def, commandable_joints(def))) {
        text += def.name + " " + group.kind + (group.name.empty() ? "" : " " + group.name) + ":";
        for (const auto& joint : group.joints) text += " " + joint;
        text += group.field_of_view > 0 ? fmt::format(" {:.1f}\n", group.field_of_view) : "\n";
      }
    }
    return text;
  };
  EXPECT_EQ(groups("worlds/arm.sdf"),
            "arm array: waist shoulder elbow roll pitch twist\narm chain: waist shoulder elbow roll pitch twist\n"
            "arm gripper gripper: left_finger right_finger\neye array: pan tilt\neye pan_tilt: pan tilt 1.0\n");
  EXPECT_EQ(groups("worlds/obstacle_course.sdf"), "") << "wheels have a drive, and casters hang free";
}

// --- faults

struct FaultyArm : Rig {
  FaultyArm() : Rig(arm_world(arm_model(ur5(), 5), 0.002)) {
    command_all(RTMSIM_JOINT_POSITION, std::vector<double>(6, 0.0));
    f.run(1);
  }
  void put(shm::FaultKind kind, double amount = 0, double duration = 0, const std::string& of = "arm::joints") {
    const auto now = f.simulation->time();
    const auto until = duration > 0 ? now + std::chrono::nanoseconds(std::llround(duration * 1e9)) : std::chrono::nanoseconds::max();
    const auto added = f.simulation->add_fault({of, kind, amount, now, until});
    ASSERT_TRUE(added) << added.error().message;
  }
  std::string refusal(shm::FaultKind kind, const std::string& of) {
    const auto added = f.simulation->add_fault({of, kind, 1, f.simulation->time()});
    return added ? "" : added.error().message;
  }
  // The joint that welds the base to the world comes first.
  double true_position(std::uint32_t joint) const { return f.simulation->physics().joint_state({0, joint + 1}).position; }
};

TEST(JointFaults, a_weak_joint_sinks_under_its_load_and_the_others_hold) {
  FaultyArm arm;
  arm.put(shm::FaultKind::weak, 0.2, 0, "arm::joints::joint2");
  double deepest = 0;
  for (int i = 0; i < 20; ++i) {
    arm.f.run(0.1);
    deepest = std::max(deepest, std::abs(arm.state(1).position));
    ASSERT_LT(std::abs(arm.state(1).effort), 30 * (1 + 1e-9)) << "of the 150 that it has";
    ASSERT_NEAR(arm.state(2).position, 0, 0.05);
  }
  EXPECT_GT(deepest, 0.2) << "it needs 91 N m";
  EXPECT_EQ(arm.f.simulation->end_faults("arm::joints::joint2", std::nullopt), 1U);
  arm.f.run(6);
  EXPECT_NEAR(arm.state(1).position, 0, tenth_of_a_degree);
}

TEST(JointFaults, a_halted_joint_does_what_it_was_told_last_and_afterwards_what_it_was_told_meanwhile) {
  FaultyArm arm;
  arm.put(shm::FaultKind::halted, 0, 1, "arm::joints::joint6");
  arm.command(4, RTMSIM_JOINT_POSITION, 0.5);
  arm.command(5, RTMSIM_JOINT_POSITION, 0.5);
  arm.f.run(0.9);
  EXPECT_NEAR(arm.state(5).position, 0, tenth_of_a_degree);
  EXPECT_NEAR(arm.state(4).position, 0.5, tenth_of_a_degree);
  arm.f.run(1.1);
  EXPECT_NEAR(arm.state(5).position, 0.5, tenth_of_a_degree);
}

TEST(JointFaults, a_halted_arm_brakes_after_the_fault_when_its_client_has_gone) {
  FaultyArm arm;
  auto client = std::make_unique<shm::Iface>(arm.f.open(shm::IfaceType::joints, "arm::joints"));
  std::vector<double> values(RTMSIM_JOINT_VALUES * 6, 0.0);
  values[0] = RTMSIM_JOINT_VELOCITY, values[1] = 0.5;
  ASSERT_TRUE(client->command(shm::CommandKind::joints, values));
  arm.f.run(0.1);
  arm.put(shm::FaultKind::halted, 0, 1);
  client.reset();
  arm.f.run(0.5);
  EXPECT_EQ(arm.state(0).mode, static_cast<std::uint32_t>(RTMSIM_JOINT_VELOCITY));
  arm.f.run(1);
  EXPECT_EQ(arm.state(0).mode, static_cast<std::uint32_t>(RTMSIM_JOINT_BRAKE));
  EXPECT_EQ(arm.state(1).mode, static_cast<std::uint32_t>(RTMSIM_JOINT_POSITION));
}

TEST(JointFaults, what_is_measured_of_one_joint_or_of_all_is_biased_stuck_or_late) {
  FaultyArm arm;
  arm.put(shm::FaultKind::bias, 0.25, 0, "arm::joints::joint6");
  arm.f.run(0.1);
  EXPECT_NEAR(arm.state(5).position, 0.25, tenth_of_a_degree);
  EXPECT_NEAR(arm.true_position(5), 0, tenth_of_a_degree) << "its controller has an encoder of its own";
  EXPECT_NEAR(arm.state(4).position, 0, tenth_of_a_degree);
  arm.put(shm::FaultKind::bias, -0.5);
  arm.f.run(0.1);
  EXPECT_NEAR(arm.state(5).position, -0.25, tenth_of_a_degree) << "of the joint and of all";
  EXPECT_NEAR(arm.state(4).position, -0.5, tenth_of_a_degree);
  EXPECT_EQ(arm.f.simulation->end_faults("arm::joints", shm::FaultKind::bias), 2U);

  arm.put(shm::FaultKind::stuck, 0, 0, "arm::joints::joint6");
  arm.put(shm::FaultKind::latency, 50, 0, "arm::joints::joint5");
  arm.command(4, RTMSIM_JOINT_VELOCITY, 0.5);
  arm.command(5, RTMSIM_JOINT_POSITION, 0.5);
  arm.f.run(1);
  EXPECT_NEAR(arm.state(5).position, 0, tenth_of_a_degree);
  EXPECT_NEAR(arm.state(5).target, 0.5, 1e-9) << "is not measured";
  EXPECT_NEAR(arm.true_position(5), 0.5, tenth_of_a_degree);
  EXPECT_NEAR(arm.true_position(4) - arm.state(4).position, 0.5 * 50 * 0.002, 0.002);
}

TEST(JointFaults, repeat_with_the_seed_and_end_with_a_reset) {
  FaultyArm arm;
  const auto run = [&] {
    arm.put(shm::FaultKind::weak, 0.3);
    arm.put(shm::FaultKind::noise, 0.1, 0, "arm::joints::joint1");
    arm.put(shm::FaultKind::halted, 0, 0.3, "arm::joints::joint3");
    arm.command_all(RTMSIM_JOINT_POSITION, reached);
    arm.f.run(0.5);
    EXPECT_TRUE(arm.iface.read());
    return std::pair(arm.f.simulation->hash(), arm.state(0).position);
  };
  std::vector<std::string> notes;
  ASSERT_TRUE(arm.f.simulation->reset(notes));
  const auto first = run();
  ASSERT_TRUE(arm.f.simulation->reset(notes));
  EXPECT_TRUE(arm.f.simulation->faults().empty());
  EXPECT_EQ(run(), first);
}

TEST(JointFaults, that_cannot_be_are_refused_with_the_names_that_there_are) {
  FaultyArm arm;
  EXPECT_EQ(arm.refusal(shm::FaultKind::weak, "arm::joints::elbow"),
            "fault weak of arm::joints: there is no joint \"elbow\", only joint1, joint2, joint3, joint4, joint5, joint6");
  EXPECT_EQ(arm.refusal(shm::FaultKind::off, "arm::joints::joint1"),
            "fault off of arm::joints::joint1: joints have one sample together: name arm::joints");
  EXPECT_EQ(arm.refusal(shm::FaultKind::missing, "arm::joints::joint1"),
            "fault missing of arm::joints::joint1: only lasers and sonars have beams");
  EXPECT_EQ(arm.refusal(shm::FaultKind::weak, "arm::joins"), "fault weak: the world has no iface arm::joins");
}

}  // namespace
}  // namespace sim
