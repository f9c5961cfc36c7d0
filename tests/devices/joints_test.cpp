// The joints iface: which joints it has, and what commands make of them.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "devices/joints/joint_list.h"
#include "shm/joint_part.h"
#include "support/commanded_joints.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;
using testing::HasSubstr;

using Rig = CommandedJoints;

TEST(Joints, are_listed_with_limits_and_gains) {
  Rig rig(arm_world(arm_model(ur5()), 0.001));
  ASSERT_EQ(rig.iface.count(), 6U);
  EXPECT_STREQ(rig.info(1).name, "joint2");
  EXPECT_STREQ(rig.info(1).link, "link2");
  EXPECT_EQ(rig.info(1).parent, 1U);
  EXPECT_EQ(rig.info(0).parent, 0U);
  EXPECT_EQ(rig.info(1).max_effort, 150);
  EXPECT_NEAR(rig.info(1).upper, 2 * std::numbers::pi, 1e-12);
  EXPECT_THAT(rig.info(1).gains_from, HasSubstr("derived"));
  EXPECT_GT(rig.info(1).p, 0);
  rig.f.run(0.001);
  EXPECT_EQ(rig.state(1).mode, static_cast<std::uint32_t>(RTMSIM_JOINT_NONE));
}

TEST(Joints, that_nobody_commands_are_as_the_file_has_them_and_the_hash_is_that_of_a_world_without_the_iface) {
  Rig rig(arm_world(arm_model(ur5()), 0.001));
  const auto hash = rig.f.simulation->hash();
  rig.f.run(0.5);
  EXPECT_GT(std::abs(rig.state(1).position), 0.3) << "it falls";
  std::vector<std::string> notes;
  ASSERT_TRUE(rig.f.simulation->reset(notes));
  EXPECT_EQ(rig.f.simulation->hash(), hash);
}

TEST(Joints, an_arm_that_holds_five_kilograms_is_the_same_at_steps_of_one_and_five_milliseconds) {
  for (const bool is_known : {true, false}) {
    SCOPED_TRACE(is_known ? "payload of the last link" : "a weight at the tip that nobody has told");
    std::vector<std::vector<double>> at_steps;
    for (const double step : {0.001, 0.005}) {
      Rig rig(arm_world(arm_model(ur5(), is_known ? 5 : 0), step));
      rig.command_all(RTMSIM_JOINT_POSITION, reached);
      const LinkId tip{0, 6};
      if (!is_known) {
        ASSERT_TRUE(rig.f.simulation->add_wrench(tip, {0, 0, -5 * 9.81}, {0, 0, 0}, std::chrono::seconds(100)));
      }
      rig.f.run(6);
      at_steps.emplace_back();
      for (std::size_t i = 0; i < reached.size(); ++i) {
        at_steps.back().push_back(rig.state(i).position);
        EXPECT_NEAR(rig.state(i).position, reached[i], tenth_of_a_degree) << i << " step " << step;
        EXPECT_LT(std::abs(rig.state(i).velocity), 1e-3) << i;
        EXPECT_EQ(rig.state(i).status, static_cast<std::uint32_t>(RTMSIM_JOINT_IDLE)) << i;
      }
    }
    for (std::size_t i = 0; i < reached.size(); ++i) EXPECT_NEAR(at_steps[0][i], at_steps[1][i], tenth_of_a_degree);
  }
}

TEST(Joints, keep_their_highest_velocity_and_effort) {
  Rig rig(arm_world(arm_model(ur5(), 5), 0.001));
  rig.command_all(RTMSIM_JOINT_POSITION, {3, -3, 2.5, 1, -2, 6});
  for (int i = 0; i < 300; ++i) {
    rig.f.run((i + 1) * 0.01 - 0.001 * static_cast<double>(rig.f.simulation->steps()));
    for (std::size_t j = 0; j < 6; ++j) {
      ASSERT_LT(std::abs(rig.state(j).velocity), 1.1 * rig.info(j).max_velocity) << j;
      ASSERT_LT(std::abs(rig.state(j).effort), rig.info(j).max_effort * (1 + 1e-9)) << j;
    }
  }
}

TEST(Joints, the_spring_of_a_position_gives_way_as_a_spring_whatever_the_step) {
  for (const double step : {0.001, 0.005}) {
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
    hub.axes[0].effort = 100;
    model.joints = {foot, hub};
    PluginDef plugin;
    plugin.filename = "gz-sim-joint-position-controller-system";
    plugin.name = "gz::sim::systems::JointPositionController";
    plugin.source = "file:7";
    plugin.parameters.children = {node("joint_name", "hub"), node("p_gain", "2000"), node("d_gain", "20"), node("i_gain", "0")};
    model.plugins = {plugin};
    Rig rig(arm_world(model, step));
    EXPECT_STREQ(rig.info(0).gains_from, "file:7");
    EXPECT_EQ(rig.info(0).p, 2000);
    rig.command(0, RTMSIM_JOINT_POSITION, 0);
    ASSERT_TRUE(rig.f.simulation->add_wrench({0, 1}, {0, 0, 0}, {0, 0, 10}, std::chrono::seconds(100)));
    rig.f.run(1);
    EXPECT_NEAR(rig.state(0).position, 0.005, 1e-5) << step;
    EXPECT_NEAR(rig.state(0).effort, -10, 0.01) << step;
    // With half of its gains it gives way twice as far, with none it is pushed along, and without a word of them they are whole again.
    const auto with_gain = [](std::uint32_t percent) { return RTMSIM_JOINT_POSITION | (percent + 1) << shm::joint_gain_shift; };
    rig.command(0, with_gain(50), 0);
    rig.f.run(1);
    EXPECT_NEAR(rig.state(0).position, 0.01, 2e-5) << step;
    EXPECT_EQ(rig.state(0).mode, RTMSIM_JOINT_POSITION);
    rig.command(0, with_gain(0), 0);
    rig.f.run(0.03);
    EXPECT_GT(rig.state(0).position, 0.3) << step;
    rig.command(0, RTMSIM_JOINT_POSITION, 0);
    rig.f.run(20);
    EXPECT_NEAR(rig.state(0).position, 0.005, 1e-4) << step;
    rig.command(0, with_gain(shm::max_joint_gain + 1), 1);
    rig.f.run(1);
    EXPECT_NEAR(rig.state(0).position, 0.005, 1e-4) << "not a command";
  }
}

TEST(Joints, turn_with_a_velocity_push_with_an_effort_and_run_free) {
  Rig rig(arm_world(arm_model(ur5()), 0.001));
  rig.command_all(RTMSIM_JOINT_POSITION, std::vector<double>(6, 0.0));
  rig.command(0, RTMSIM_JOINT_VELOCITY, 0.5);
  rig.f.run(2);
  EXPECT_NEAR(rig.state(0).velocity, 0.5, 0.01);
  EXPECT_NEAR(rig.state(0).position, 1, 0.05);
  const double before = rig.state(0).position;
  rig.command(0, RTMSIM_JOINT_EFFORT, -5);
  rig.f.run(0.5);
  EXPECT_LT(rig.state(0).velocity, 0);
  EXPECT_NEAR(rig.state(0).effort, -5, 1e-9);
  rig.command(0, RTMSIM_JOINT_FREE, 0);
  rig.f.run(1);
  EXPECT_LT(rig.state(0).position, before) << "it goes on";
  EXPECT_EQ(rig.state(0).effort, 0);
}

TEST(Joints, float_with_the_effort_that_gravity_needs) {
  Rig floating(arm_world(arm_model(ur5()), 0.001));
  floating.command_all(RTMSIM_JOINT_EFFORT | RTMSIM_JOINT_COMPENSATED, std::vector<double>(6, 0.0));
  floating.f.run(1);
  for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(floating.state(j).position, 0, 1e-3) << j;
}

TEST(Joints, count_whole_turns) {
  Rig rig(arm_world(arm_model(ur5()), 0.005));
  rig.command_all(RTMSIM_JOINT_POSITION, std::vector<double>(6, 0.0));
  rig.command(5, RTMSIM_JOINT_POSITION, 6.2);
  rig.f.run(4);
  EXPECT_NEAR(rig.state(5).position, 6.2, tenth_of_a_degree);
  rig.command(5, RTMSIM_JOINT_POSITION, -6.2);
  rig.f.run(6);
  EXPECT_NEAR(rig.state(5).position, -6.2, tenth_of_a_degree);
}

TEST(Joints, brake_when_their_client_goes) {
  Rig rig(arm_world(arm_model(ur5(), 5), 0.001));
  auto client = std::make_unique<shm::Iface>(rig.f.open(shm::IfaceType::joints, "arm::joints"));
  std::vector<double> values(RTMSIM_JOINT_VALUES * 6, 0.0);
  for (std::size_t j = 0; j < 6; ++j) values[4 * j] = RTMSIM_JOINT_POSITION, values[4 * j + 1] = reached[j];
  ASSERT_TRUE(client->command(shm::CommandKind::joints, values));
  rig.f.run(0.3);
  testing::internal::CaptureStderr();
  client.reset();
  rig.f.run(0.5);
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_THAT(log, HasSubstr("the client that commanded 6 of 6 joints has exited or detached: they brake"));
  EXPECT_EQ(log.find("they brake"), log.rfind("they brake")) << "once";
  const double stopped = rig.state(1).position;
  EXPECT_EQ(rig.state(1).status, static_cast<std::uint32_t>(RTMSIM_JOINT_BRAKED));
  rig.f.run(2);
  EXPECT_NEAR(rig.state(1).position, stopped, 1e-4);
}

TEST(Joints, two_clients_command_each_its_own_joint_in_the_same_step) {
  Rig rig(arm_world(arm_model(ur5()), 0.001));
  auto other = rig.f.open(shm::IfaceType::joints, "arm::joints");
  std::vector<double> values(RTMSIM_JOINT_VALUES * 6, 0.0);
  values[4 * 5] = RTMSIM_JOINT_POSITION, values[4 * 5 + 1] = -0.5;
  rig.command_all(RTMSIM_JOINT_POSITION, {.1, .2, .3, .4, .5});
  ASSERT_TRUE(other.command(shm::CommandKind::joints, values));
  rig.f.run(2);
  const std::vector<double> wanted{.1, .2, .3, .4, .5, -.5};
  for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(rig.state(j).position, wanted[j], tenth_of_a_degree);
}

TEST(Joints, that_two_clients_take_from_each_other_again_and_again_have_one_line) {
  Rig rig(arm_world(arm_model(ur5()), 0.001));
  auto other = rig.f.open(shm::IfaceType::joints, "arm::joints");
  testing::internal::CaptureStderr();
  for (int i = 0; i < 10; ++i) {
    rig.command(0, RTMSIM_JOINT_POSITION, 0.1);
    rig.f.run(0.01);
    ASSERT_TRUE(other.command(shm::CommandKind::joints, std::vector<double>{RTMSIM_JOINT_POSITION, 0.2, 0, 0}));
    rig.f.run(0.01);
  }
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_THAT(log, HasSubstr("joint joint1: "));
  EXPECT_THAT(log, HasSubstr(" takes it from "));
  EXPECT_EQ(log.find("takes it from"), log.rfind("takes it from")) << log;
  rig.f.run(3);
  EXPECT_NEAR(rig.state(0).position, 0.2, tenth_of_a_degree) << "the later command counts";
}

TEST(Joints, a_target_outside_of_the_limits_is_one_line_and_nothing_else_moves) {
  Rig rig(arm_world(arm_model(ur5()), 0.001));
  testing::internal::CaptureStderr();
  rig.command_all(RTMSIM_JOINT_POSITION, std::vector<double>(6, 0.0));
  for (int i = 0; i < 10; ++i) {
    rig.command(5, RTMSIM_JOINT_POSITION, 100);
    rig.f.run(0.01);
  }
  rig.f.run(5);
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_THAT(log, HasSubstr("joint joint6: the command 100 is outside of"));
  EXPECT_EQ(log.find("is outside"), log.rfind("is outside"));
  EXPECT_NEAR(rig.state(5).position, 2 * std::numbers::pi, tenth_of_a_degree);
  for (std::size_t j = 0; j < 5; ++j) EXPECT_NEAR(rig.state(j).position, 0, tenth_of_a_degree);
  const double bad[] = {RTMSIM_JOINT_POSITION, std::nan("")};
  EXPECT_FALSE(rig.iface.command(shm::CommandKind::joints, bad));
  EXPECT_FALSE(rig.iface.command(shm::CommandKind::joints, std::vector<double>(25, 0.0)));
}

TEST(Joints, a_run_with_commands_repeats_after_a_reset) {
  Rig rig(arm_world(arm_model(ur5(), 5), 0.002));
  const auto run = [&] {
    rig.command_all(RTMSIM_JOINT_POSITION, reached);
    rig.f.run(1);
    rig.command(2, RTMSIM_JOINT_EFFORT, 3);
    rig.f.run(0.5);
    return rig.f.simulation->hash();
  };
  const auto first = run();
  std::vector<std::string> notes;
  ASSERT_TRUE(rig.f.simulation->reset(notes));
  EXPECT_EQ(run(), first);
  ASSERT_TRUE(rig.f.simulation->reset(notes));
  rig.f.run(1.5);
  EXPECT_NE(rig.f.simulation->hash(), first) << "no command of the run before counts";
}

TEST(Joints, of_drives_are_left_to_the_drive) {
  ModelDef model;
  model.name = "rover";
  for (const char* name : {"left", "right", "mast"}) {
    JointDef joint;
    joint.name = name, joint.kind = JointDef::Kind::revolute;
    joint.axes.emplace_back();
    model.joints.push_back(joint);
  }
  PluginDef drive;
  drive.filename = "gz-sim-diff-drive-system";
  drive.parameters.children = {node("left_joint", "left"), node("right_joint", "right")};
  model.plugins = {drive};
  EXPECT_THAT(commandable_joints(model), testing::ElementsAre(2U));
  model.is_static = true;
  EXPECT_THAT(commandable_joints(model), testing::IsEmpty());
}

// Two fingers on a palm that slide apart, the second as the first; a box lies between them.
LoadResult mimic_hand(const std::string& mimic) {
  const auto finger = [](const std::string& name, const std::string& y) {
    return "<link name='" + name + "'><pose>0 " + y +
           " 1 0 0 0</pose><inertial><mass>0.1</mass><inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz>"
           "</inertia></inertial><collision name='c'><geometry><box><size>0.05 0.01 0.05</size></box></geometry></collision></link>";
  };
  const auto slide = [](const std::string& name, const std::string& child, const std::string& axis, const std::string& more) {
    return "<joint name='" + name + "' type='prismatic'><parent>palm</parent><child>" + child + "</child><axis><xyz>" + axis +
           "</xyz><limit><lower>-0.05</lower><upper>0.05</upper><effort>20</effort></limit>" + more + "</axis></joint>";
  };
  const std::string text =
      "<sdf version='1.9'><world name='w'><gravity>0 0 -9.81</gravity><physics type='ode'><max_step_size>0.002</max_step_size></physics>"
      "<model name='arm'><link name='palm'><pose>0 0 1.1 0 0 0</pose></link><joint name='foot' "
      "type='fixed'><parent>world</parent><child>palm</child></joint>" +
      finger("left", "0.06") + finger("right", "-0.06") + slide("one", "left", "0 1 0", "") + slide("two", "right", "0 -1 0", mimic) +
      "</model></world></sdf>";
  auto loaded = load_world_text(text, std::filesystem::temp_directory_path(), "hand.sdf", ModelPath{});
  if (!loaded) throw std::runtime_error(loaded.error().message);
  return std::move(*loaded);
}

TEST(Joints, that_follow_others_are_bound_to_them_by_the_solver) {
  auto loaded = mimic_hand("<mimic joint='one'><multiplier>0.5</multiplier><offset>0.01</offset><reference>0.02</reference></mimic>");
  ASSERT_TRUE(loaded.findings.empty()) << loaded.findings.front().text();
  Rig rig(std::move(loaded.world));
  rig.command(0, RTMSIM_JOINT_POSITION, -0.03);
  rig.f.run(1);
  EXPECT_NEAR(rig.state(0).position, -0.03, 2e-4);
  EXPECT_NEAR(rig.state(1).position, 0.5 * (rig.state(0).position - 0.02) + 0.01, 1e-6);
  // A push on the follower moves the leader's spring.
  ASSERT_TRUE(rig.f.simulation->add_wrench({0, 2}, {0, -4, 0}, {0, 0, 0}, std::chrono::milliseconds(300)));
  rig.f.run(0.1);
  EXPECT_GT(rig.state(0).effort, -20);
  EXPECT_LT(rig.state(0).effort, -1);
  const double leader = rig.state(0).position;
  EXPECT_NEAR(rig.state(1).position, 0.5 * (leader - 0.02) + 0.01, 1e-4);
  testing::internal::CaptureStderr();
  rig.command(1, RTMSIM_JOINT_POSITION, 0.04);
  rig.f.run(1.5);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("joint two: follows joint one and takes no commands"));
  EXPECT_NEAR(rig.state(1).position, 0.5 * (rig.state(0).position - 0.02) + 0.01, 1e-4);
}

// A hand on a vertical slide above a shelf, with a box of 0.5 kg between its fingers; nothing of it falls asleep.
struct Grip {
  explicit Grip(double force) : rig(world()) {
    rig.command(0, RTMSIM_JOINT_POSITION, 0);
    for (const std::uint32_t finger : {1U, 2U}) rig.command(finger, RTMSIM_JOINT_VELOCITY, -0.1, 0, force);
    rig.f.run(2);
  }
  static WorldDef world() {
    const auto part = [](const std::string& name, const std::string& pose, const std::string& mass, const std::string& size) {
      return "<link name='" + name + "'><pose>" + pose + "</pose><inertial><mass>" + mass +
             "</mass><inertia><ixx>2e-4</ixx><iyy>2e-4</iyy><izz>2e-4</izz></inertia></inertial><collision name='c'><geometry><box><size>" +
             size +
             "</size></box></geometry><surface><friction><ode><mu>0.8</mu><mu2>0.8</mu2></ode></friction></surface></collision></link>";
    };
    const auto slide = [](const std::string& name, const std::string& parent, const std::string& child, const std::string& axis,
                          const std::string& limits) {
      return "<joint name='" + name + "' type='prismatic'><parent>" + parent + "</parent><child>" + child + "</child><axis><xyz>" + axis +
             "</xyz><limit>" + limits + "</limit></axis></joint>";
    };
    const std::string awake = "<allow_auto_disable>false</allow_auto_disable>";
    const std::string text =
        "<sdf version='1.9'><world name='w'><gravity>0 0 -9.81</gravity><physics type='ode'><max_step_size>0.002</max_step_size></physics>"
        "<model name='shelf'><static>true</static><pose>0 0 0.95 0 0 0</pose>" +
        part("l", "0 0 0 0 0 0", "1", "0.2 0.03 0.05") +
        "</model>"
        "<model name='arm'>" +
        awake + part("palm", "0 0 1.2 0 0 0", "1", "0.1 0.1 0.02") + part("left", "0 0.04 1 0 0 0", "0.1", "0.03 0.01 0.04") +
        part("right", "0 -0.04 1 0 0 0", "0.1", "0.03 0.01 0.04") +
        slide("lift", "world", "palm", "0 0 1", "<lower>-1</lower><upper>1</upper><velocity>2</velocity><effort>500</effort>") +
        slide("one", "palm", "left", "0 1 0", "<lower>-0.04</lower><upper>0.04</upper><effort>60</effort>") +
        slide("two", "palm", "right", "0 -1 0", "<lower>-0.04</lower><upper>0.04</upper><effort>60</effort>") +
        "</model>"
        "<model name='box'>" +
        awake + part("l", "0 0 1 0 0 0", "0.5", "0.05 0.05 0.05") + "</model></world></sdf>";
    auto loaded = load_world_text(text, std::filesystem::temp_directory_path(), "grip.sdf", ModelPath{});
    if (!loaded) throw std::runtime_error(loaded.error().message);
    return std::move(loaded->world);
  }
  double box() { return rig.f.simulation->physics().model_pose(2).translation().z(); }
  // Up with this acceleration for 0.2 s, and down to a stop as fast.
  void lift(double acceleration) {
    constexpr double step = 0.002;
    const double start = rig.f.simulation->time().count() * 1e-9;
    double height = 0, speed = 0;
    for (int i = 1; i <= 200; ++i) {
      speed += (i <= 100 ? 1 : -1) * acceleration * step;
      height += speed * step;
      rig.command(0, RTMSIM_JOINT_POSITION, height, i == 200 ? 0 : speed);
      rig.f.run(start + i * step - rig.f.simulation->time().count() * 1e-9);
    }
  }
  Rig rig;
};

TEST(Joints, fingers_hold_half_a_kilogram_with_15_newtons_for_a_minute_and_lift_it_at_5_metres_per_second_squared) {
  Grip grip(15);
  EXPECT_EQ(grip.rig.state(1).status, static_cast<std::uint32_t>(RTMSIM_JOINT_STALLED)) << "that is: it holds something";
  EXPECT_NEAR(std::abs(grip.rig.state(1).effort), 15, 0.5);
  const double before = grip.box();
  grip.lift(5);
  grip.rig.f.run(0.5);
  EXPECT_NEAR(grip.box() - before, 0.2, 0.002);
  const double held = grip.box();
  grip.rig.f.run(60);
  EXPECT_NEAR(grip.box(), held, 0.001);
}

TEST(Joints, fingers_that_press_with_2_5_newtons_let_it_slip) {
  Grip grip(2.5);
  const double before = grip.box();
  grip.lift(5);
  grip.rig.f.run(1);
  EXPECT_LT(grip.box() - before, 0.05);
}

TEST(Joints, of_a_slide_that_is_pushed_against_its_stop_stand_there) {
  Grip grip(15);
  grip.rig.command(1, RTMSIM_JOINT_EFFORT, 10);
  grip.rig.f.run(1);
  EXPECT_NEAR(grip.rig.state(1).position, 0.04, 0.001);
  EXPECT_LT(std::abs(grip.rig.state(1).velocity), 1e-6);
}

}  // namespace
}  // namespace sim
