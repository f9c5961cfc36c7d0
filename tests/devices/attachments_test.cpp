// What models hold by welds: detachable joints from the start, grippers when they are asked to, in simulated time.
#include <gtest/gtest.h>

#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;

const std::string floor_and_box =
    "<model name='floor'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link></model>"
    "<model name='box'><pose>0 0 0.05 0 0 0</pose><link name='body'><inertial><mass>0.5</mass><inertia><ixx>0.001</ixx><iyy>0.001</iyy>"
    "<izz>0.001</izz></inertia></inertial><collision name='c'><geometry><box><size>0.1 0.1 "
    "0.1</size></box></geometry></collision></link></model>";

// A hand over the box, whose two fingers slide along y. `grip`: in its <gripper>.
std::string hand(const std::string& grip, const std::string& more = {}) {
  const auto finger = [](const std::string& name, double y, const char* axis) {
    return "<link name='" + name + "'><pose>0 " + std::to_string(y) +
           " 0.06 0 0 0</pose><inertial><mass>0.1</mass><inertia><ixx>0.0001</ixx><iyy>0.0001</iyy><izz>0.0001</izz></inertia></inertial>"
           "<collision name='c'><geometry><box><size>0.06 0.02 0.06</size></box></geometry></collision></link><joint name='" +
           name + "_joint' type='prismatic'><parent>palm</parent><child>" + name + "</child><axis><xyz>" + axis +
           "</xyz><limit><lower>0</lower><upper>0.05</upper><effort>10</effort><velocity>0.2</velocity></limit></axis></joint>";
  };
  return "<model name='hand'><link name='palm'><pose>0 0 0.3 0 0 0</pose><inertial><mass>1</mass></inertial></link>"
         "<joint name='lift' type='prismatic'><parent>world</parent><child>palm</child><axis><xyz>0 0 1</xyz><limit><lower>0</lower>"
         "<upper>1</upper><effort>100</effort><velocity>0.5</velocity></limit></axis></joint>" +
         finger("left", 0.08, "0 -1 0") + finger("right", -0.08, "0 1 0") +
         "<gripper name='grip'><palm_link>palm</palm_link><gripper_link>left</gripper_link>" + "<gripper_link>right</gripper_link>" + grip +
         "</gripper>" + more + "</model>";
}

struct Scene {
  explicit Scene(const std::string& content) : f(world_of_text(floor_and_box + content)) {}
  Simulation& simulation() { return *f.simulation; }
  LinkId link(std::string_view name) { return simulation().physics().find_link(name).value(); }
  Eigen::Vector3d box() { return simulation().physics().model_pose(simulation().physics().find("box").value()).translation(); }
  bool is_attached(std::string_view by = "hand::palm") { return simulation().physics().are_attached(link(by), link("box::body")); }
  // Of lift, left, right; those that are not given are left as they are.
  void command(std::vector<double> goals) {
    if (!hand) hand = f.open(shm::IfaceType::joints, "hand::joints");
    std::vector<double> values(RTMSIM_JOINT_VALUES * hand->count());
    for (std::size_t i = 0; i < goals.size(); ++i)
      values[RTMSIM_JOINT_VALUES * i] = RTMSIM_JOINT_POSITION, values[RTMSIM_JOINT_VALUES * i + 1] = goals[i];
    ASSERT_TRUE(hand->command(shm::CommandKind::joints, values));
  }
  std::string turn(std::string_view name, bool is_on) {
    const auto done = simulation().turn_attachment(name, is_on);
    return !done ? "unknown" : *done ? "" : done->error().message;
  }
  SimulationFixture f;
  std::optional<shm::Iface> hand;
};

TEST(Grippers, attach_nothing_unless_they_are_asked_to) {
  Scene scene(hand(""));
  scene.command({0, 0.03, 0.03});
  scene.f.run(2);
  EXPECT_FALSE(scene.is_attached());
  EXPECT_EQ(scene.turn("hand::grip", true), "");
  scene.f.run(0.15);
  EXPECT_FALSE(scene.is_attached()) << "twenty checks of 10 ms";
  scene.f.run(0.15);
  EXPECT_TRUE(scene.is_attached());
  scene.command({0.3, 0.03, 0.03});
  scene.f.run(2);
  EXPECT_GT(scene.box().z(), 0.3);
  EXPECT_EQ(scene.turn("hand::grip", false), "");
  EXPECT_FALSE(scene.is_attached());
}

TEST(Grippers, let_go_when_the_fingers_have_been_away_long_enough) {
  Scene scene(
      hand("<rtmsim:attach>true</rtmsim:attach><grasp_check><attach_steps>5</attach_steps><detach_steps>30</detach_steps></grasp_check>"));
  scene.command({0, 0.03, 0.03});
  scene.f.run(1.5);
  ASSERT_TRUE(scene.is_attached());
  scene.command({0.3, 0.03, 0.03});
  scene.f.run(2);
  scene.command({0.3, 0, 0});
  scene.f.run(0.2);
  EXPECT_TRUE(scene.is_attached()) << "not yet";
  scene.f.run(1.5);
  EXPECT_FALSE(scene.is_attached());
  EXPECT_LT(scene.box().z(), 0.06);
}

TEST(Grippers, attach_by_the_grasp_fix_plugin_of_gazebo) {
  Scene scene(hand("",
                   "<plugin name='fix' filename='libgazebo_grasp_fix.so'><arm><arm_name>hand</arm_name><palm_link>palm</palm_link>"
                   "<gripper_link>left</gripper_link><gripper_link>right</gripper_link></arm></plugin>"));
  scene.command({0, 0.03, 0.03});
  scene.f.run(2);
  EXPECT_TRUE(scene.is_attached());
}

TEST(Grippers, are_off_again_after_a_reset) {
  Scene scene(hand(""));
  const auto run = [&] {
    scene.command({0, 0.03, 0.03});
    scene.f.run(1.5);
    EXPECT_EQ(scene.turn("hand::grip", true), "");
    scene.f.run(0.5);
    EXPECT_TRUE(scene.is_attached());
    return scene.simulation().hash();
  };
  const auto first = run();
  std::vector<std::string> notes;
  ASSERT_TRUE(scene.simulation().reset(notes));
  EXPECT_FALSE(scene.simulation().attachments().states(scene.simulation().physics())[0].is_on);
  EXPECT_FALSE(scene.is_attached());
  EXPECT_EQ(run(), first);
}

std::string crane(const std::string& child_model = "box", const std::string& link = "body") {
  return "<model name='crane'><pose>0 0 1 0 0 0</pose><static>true</static><link name='hook'/><plugin "
         "filename='gz-sim-detachable-joint-system' "
         "name='gz::sim::systems::DetachableJoint'><parent_link>hook</parent_link><child_model>" +
         child_model + "</child_model><child_link>" + link + "</child_link><detach_topic>/drop</detach_topic></plugin></model>";
}

TEST(DetachableJoints, hold_from_the_start_until_they_are_told_to_let_go) {
  Scene scene(crane());
  std::vector<std::string> notes;
  const auto run = [&] {
    scene.f.run(0.1);
    EXPECT_TRUE(scene.is_attached("crane::hook"));
    EXPECT_EQ(scene.simulation().attachments().states(scene.simulation().physics())[0].holds, "box::body");
    EXPECT_EQ(scene.turn("crane::box", true), "") << "it does already";
    EXPECT_EQ(scene.turn("crane::box", false), "");
    EXPECT_FALSE(scene.is_attached("crane::hook"));
    scene.f.run(0.1);
    EXPECT_FALSE(scene.is_attached("crane::hook"));
    EXPECT_EQ(scene.turn("crane::box", true), "");
    EXPECT_TRUE(scene.is_attached("crane::hook")) << "at once";
    scene.f.run(0.1);
    return scene.simulation().hash();
  };
  const auto first = run();
  ASSERT_TRUE(scene.simulation().reset(notes));
  EXPECT_EQ(run(), first);
  EXPECT_EQ(scene.turn("crane::lorry", true), "unknown");
}

TEST(DetachableJoints, let_go_of_what_is_moved_or_deleted) {
  Scene scene(crane());
  scene.f.run(0.1);
  Eigen::Isometry3d there = Eigen::Isometry3d::Identity();
  there.translation() = Eigen::Vector3d(2, 0, 1);
  ASSERT_TRUE(scene.simulation().set_pose(scene.link("box").model, there));
  scene.f.run(1);
  EXPECT_FALSE(scene.is_attached("crane::hook"));
  EXPECT_LT(scene.box().z(), 0.06);
  EXPECT_EQ(scene.turn("crane::box", true), "");
  scene.simulation().remove(scene.link("box").model);
  scene.f.run(0.1);
  EXPECT_EQ(scene.turn("crane::box", true), "crane::box: there is no model \"box\"");
}

TEST(DetachableJoints, of_what_is_not_there_are_lines) {
  EXPECT_EQ(Scene(crane("box", "nose")).turn("crane::box", true), "crane::box: model box has no link \"nose\"");
  Scene wrong(crane("", "body"));
  ASSERT_EQ(wrong.f.dropped.size(), 1U);
  EXPECT_NE(wrong.f.dropped[0].find("child_model and child_link must name a link of another model; it attaches nothing"), std::string::npos)
      << wrong.f.dropped[0];
}

}  // namespace
}  // namespace sim
