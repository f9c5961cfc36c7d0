// URDF robots that people bring: what is wrong in one is said, and what the library would lose is kept.
#include <gtest/gtest.h>

#include <cmath>

#include "world/world_loader.h"

namespace sim {
namespace {

const std::string mass = "<inertial><mass value='1'/><inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial>";
const std::string no_mass = "<inertial><mass value='0'/><inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/></inertial>";
const std::string ends = "<parent link='a'/><child link='b'/>";

std::string link(const std::string& name, const std::string& content = mass) { return "<link name='" + name + "'>" + content + "</link>"; }
std::string joint(const std::string& type, const std::string& content) {
  return "<joint name='j' type='" + type + "'>" + content + "</joint>";
}

base::Result<LoadedModel> load(const std::string& content, const std::string& attributes = "name='r'") {
  return load_model("<robot " + attributes + ">" + content + "</robot>", "", std::nullopt, ModelPath{});
}

TEST(Urdf, that_is_refused_has_the_reason) {
  const std::string two = link("a") + link("b");
  struct Case {
    std::string content, reason, attributes = "name='r'";
  };
  for (const Case& each : {
           Case{two + joint("revolute", ends), "joint \"j\" is revolute and has no <limit>"},
           Case{two + joint("prismatic", ends + "<limit lower='0' upper='1' effort='1'/>"), "<limit> of joint \"j\" has no velocity"},
           Case{two + joint("fixed", ends), "the robot has no name", ""},
           Case{"<xacro:property name='w' value='1'/>" + two + joint("fixed", ends + "<origin xyz='${w} 0 0'/>"),
                "it must be expanded by xacro first, it has <xacro:property>", "name='r' xmlns:xacro='http://ros.org/wiki/xacro'"},
           Case{two + joint("fixed", "<parent link='none'/><child link='b'/>"), "parent \"none\" of joint \"j\" does not exist"},
           Case{two, "links \"a\" and \"b\" have no parent; one root is allowed"},
           Case{link("a") + link("a") + joint("fixed", ends), "link \"a\" appears twice"},
           Case{two + joint("hinge", ends), "joint \"j\" has the unknown type \"hinge\""},
           Case{two + joint("revolute", ends + "<limit effort='28,0' velocity='1'/>"),
                "effort of <limit> of joint \"j\" must be a number, got \"28,0\""},
           Case{two + joint("revolute", ends + "<limit effort='nan' velocity='1'/>"),
                "effort of <limit> of joint \"j\" must be a number, got \"nan\""},
           Case{two + joint("fixed", ends + "<origin xyz='0 0'/>"), "xyz of <origin> of joint \"j\" must be three numbers, got \"0 0\""},
       }) {
    const auto loaded = load(each.content, each.attributes);
    ASSERT_FALSE(loaded) << each.reason;
    EXPECT_NE(loaded.error().message.find(each.reason), std::string::npos) << loaded.error().message << "\nexpected: " << each.reason;
  }
}

TEST(Urdf, frames_without_mass_on_frames_without_mass_add_nothing) {
  const auto fixed = [](const std::string& name, const std::string& parent, const std::string& child) {
    return "<joint name='" + name + "' type='fixed'><parent link='" + parent + "'/><child link='" + child + "'/></joint>";
  };
  for (const std::string& inertial : {no_mass, std::string()}) {
    const auto loaded = load(link("base") + link("arm") +
                             "<joint name='j' type='revolute'><parent link='base'/><child link='arm'/><axis xyz='0 1 0'/>"
                             "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>" +
                             link("camera", inertial) + fixed("c", "arm", "camera") + link("optical", inertial) +
                             fixed("o", "camera", "optical") + link("last", inertial) + fixed("l", "optical", "last"));
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_NE(loaded->model.link("arm"), nullptr);
    EXPECT_NEAR(loaded->model.link("arm")->mass, 1, 1e-9);
    EXPECT_LT(loaded->model.link("arm")->center_of_mass.norm(), 1e-9);
    EXPECT_TRUE(loaded->findings.empty()) << loaded->findings.front().text();
  }
}

// As in Baxter, whose arms hang on mounts without mass.
TEST(Urdf, joints_on_frames_without_mass_hang_on_what_holds_the_frame) {
  const std::string limit = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
  const auto loaded = load(link("torso") + link("mount", "") + link("plate", no_mass) + link("arm") +
                           "<joint name='m' type='fixed'><parent link='torso'/><child link='mount'/><origin xyz='0 0.2 0.3' rpy='0 0 "
                           "1.5707963267948966'/></joint><joint name='p' type='fixed'><parent link='mount'/><child link='plate'/><origin "
                           "xyz='0.1 0 0'/></joint><joint name='j' type='revolute'><parent link='plate'/><child link='arm'/><origin "
                           "xyz='0.1 0 0' rpy='0.5 0 0'/><axis xyz='1 0 0'/>" +
                           limit + "</joint>");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(loaded->findings.empty()) << loaded->findings.front().text();
  const LinkDef* arm = loaded->model.link("arm");
  ASSERT_TRUE(arm != nullptr && loaded->model.joint("j") != nullptr);
  EXPECT_LT((arm->pose.translation() - Eigen::Vector3d(0, 0.4, 0.3)).norm(), 1e-9) << arm->pose.translation().transpose();
  EXPECT_LT((arm->pose.linear() * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(std::sin(0.5), 0, std::cos(0.5))).norm(), 1e-9);
  EXPECT_EQ(loaded->model.joint("j")->parent, "torso");
}

TEST(Urdf, links_that_move_and_have_no_mass_get_one_with_a_line) {
  const std::string limit = "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
  const auto chain = [&](const std::string& content) {
    return link("world", "") + link("base", content) + link("a", content) + link("b", content) +
           "<joint name='w' type='fixed'><parent link='world'/><child link='base'/></joint><joint name='one' "
           "type='revolute'><parent link='base'/><child link='a'/>" +
           limit + "<joint name='two' type='revolute'><parent link='a'/><child link='b'/>" + limit;
  };
  for (const std::string& content : {std::string(), no_mass}) {
    const auto loaded = load(chain(content));
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_EQ(loaded->findings.size(), 1U);
    EXPECT_NE(loaded->findings[0].text().find("link \"a\" and another link have no mass; 0.1 kg is taken for each"), std::string::npos)
        << loaded->findings[0].text();
    ASSERT_TRUE(loaded->model.link("a") != nullptr && loaded->model.link("b") != nullptr);
    EXPECT_NEAR(loaded->model.link("b")->mass, 0.1, 1e-12);
    EXPECT_EQ(loaded->model.joint("one")->parent, "");
    EXPECT_EQ(loaded->model.joint("two")->parent, "a");
  }
}

TEST(Urdf, an_inertial_that_is_no_number_is_ignored_with_a_line) {
  const auto moving =
      load(link("a") + link("b", "<inertial><mass value=''/></inertial>") + joint("continuous", ends + "<axis xyz='0 0 1'/>"));
  ASSERT_TRUE(moving) << moving.error().message;
  EXPECT_EQ(moving->findings.size(), 1U);
  EXPECT_NEAR(moving->model.link("b")->mass, 0.1, 1e-12);
  const auto loaded = load(link("a", "<inertial><mass value='1kg'/></inertial>") + link("b") + joint("fixed", ends));
  ASSERT_TRUE(loaded) << loaded.error().message;
  ASSERT_EQ(loaded->findings.size(), 1U);
  EXPECT_NE(loaded->findings[0].text().find("value of <mass> of link \"a\" must be a number, got \"1kg\"; its <inertial> is ignored"),
            std::string::npos)
      << loaded->findings[0].text();
  EXPECT_NEAR(loaded->model.link("a")->mass, 1, 1e-9) << "of b";
}

TEST(Urdf, impossible_numbers_of_a_joint_have_one_line_each_and_the_robot_stays) {
  struct Case {
    std::string content, line;
  };
  for (const Case& each :
       {Case{"<axis xyz='0 0 0'/><limit effort='1' velocity='1'/>",
             "xyz of <axis> of joint \"j\" must be three numbers that are not all zero, got \"0 0 0\"; 1 0 0 is taken"},
        Case{"<axis xyz='1e-9 0 0'/><limit effort='1' velocity='1'/>", "not all zero, got \"1e-9 0 0\"; 1 0 0 is taken"},
        Case{"<axis/><limit effort='1' velocity='1'/>", "not all zero, got \"\"; 1 0 0 is taken"},
        Case{"<axis xyz='0 0 nan'/><limit effort='1' velocity='1'/>", "not all zero, got \"0 0 nan\"; 1 0 0 is taken"},
        Case{"<limit effort='-50' velocity='1'/>", "effort of <limit> of joint \"j\" must not be negative, got -50; it is not limited"},
        Case{"<limit effort='1' velocity='-2'/>", "velocity of <limit> of joint \"j\" must not be negative, got -2; it is not limited"},
        Case{"<limit lower='2' upper='1' effort='1' velocity='1'/>",
             "lower and upper of <limit> of joint \"j\" must ascend, got 2 and 1; they are exchanged"},
        Case{"<limit effort='1' velocity='1'/><dynamics damping='-1'/>", "<damping>"},
        Case{"<limit effort='1' velocity='1'/><dynamics damping='1' friction='-1'/>", "<friction>"}}) {
    const auto loaded = load(link("a") + link("b") + joint("revolute", ends + each.content));
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_EQ(loaded->findings.size(), 1U) << each.line;
    EXPECT_NE(loaded->findings[0].text().find(each.line), std::string::npos) << loaded->findings[0].text();
    EXPECT_NE(loaded->model.joint("j"), nullptr) << each.line;
    EXPECT_NE(loaded->model.link("b"), nullptr) << each.line;
  }
}

TEST(Urdf, links_that_weigh_almost_nothing_stay_with_a_line) {
  const auto loaded_with = [](const std::string& kilograms) {
    return load(link("a") +
                link("b", "<inertial><mass value='" + kilograms +
                              "'/><inertia ixx='1e-9' iyy='1e-9' izz='1e-9' ixy='0' ixz='0' iyz='0'/></inertial>") +
                joint("continuous", ends + "<axis xyz='0 0 1'/>"));
  };
  for (const std::string kilograms : {"1e-12", "1e-6", "1.9e-6"}) {
    const auto loaded = loaded_with(kilograms);
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_EQ(loaded->findings.size(), 1U) << kilograms;
    EXPECT_NE(loaded->findings[0].text().find(" kg; 2e-06 kg, the least, is taken"), std::string::npos) << loaded->findings[0].text();
    ASSERT_NE(loaded->model.link("b"), nullptr) << kilograms;
  }
  const auto light = loaded_with("2e-6");
  ASSERT_TRUE(light && light->findings.empty());
  ASSERT_NE(light->model.link("b"), nullptr);
  EXPECT_NEAR(light->model.link("b")->mass, 2e-6, 1e-12);
}

TEST(Urdf, shapes_that_mean_nothing_are_left_out_with_one_line_each) {
  struct Case {
    std::string shape, line;
  };
  for (const Case& each :
       {Case{"<box size=''/>", "size of <box> of link \"a\" must be three numbers, got \"\"; the collision is left out"},
        Case{"<cylinder radius='1'/>", "<cylinder> of link \"a\" has no length; the collision is left out"},
        Case{"<sphere radius='nan'/>", "radius of <sphere> of link \"a\" must be a number, got \"nan\""},
        Case{"<sphere radius='0'/>", "must be a positive number, got \"0\"; the collision is left out"},
        Case{"<mesh/>", "<mesh> of link \"a\" has no filename; the collision is left out"},
        Case{"<torus radius='1'/>", "the collision of link \"a\" has the unknown shape <torus>; the collision is left out"},
        Case{"", "the collision of link \"a\" has no shape; the collision is left out"}}) {
    const auto loaded = load(link("a", mass + "<collision><geometry>" + each.shape + "</geometry></collision>"));
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_EQ(loaded->findings.size(), 1U) << each.line;
    EXPECT_NE(loaded->findings[0].text().find(each.line), std::string::npos) << loaded->findings[0].text();
    EXPECT_TRUE(loaded->model.link("a")->collisions.empty());
  }
}

TEST(Urdf, infinite_limits_are_none) {
  const auto loaded =
      load(link("a") + link("b") + joint("revolute", ends + "<limit lower='-inf' upper='inf' effort='inf' velocity='inf'/>"));
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(loaded->findings.empty()) << loaded->findings.front().text();
  EXPECT_GE(loaded->model.joint("j")->axes[0].upper, 1e15);
}

TEST(Urdf, impossible_numbers_of_a_mimic_have_a_line_and_the_robot_stays) {
  const auto load_with = [](const std::string& numbers) {
    return load(link("palm") + link("left") + link("right") +
                "<joint name='one' type='prismatic'><parent link='palm'/><child link='left'/><axis xyz='0 0 1'/><limit lower='0' upper='1' "
                "effort='1' velocity='1'/></joint><joint name='other' type='prismatic'><parent link='palm'/><child link='right'/><axis "
                "xyz='0 0 -1'/><limit lower='0' upper='1' effort='1' velocity='1'/><mimic joint='one' " +
                numbers + "/></joint>");
  };
  struct Case {
    std::string numbers, line;
    bool follows = true;
  };
  for (const Case& each :
       {Case{"multiplier=''", "the multiplier of the <mimic> of joint \"other\" must be a number up to 1e6, got \"\"; 1 is taken"},
        Case{"multiplier='one'", "the multiplier of the <mimic> of joint \"other\" must be a number up to 1e6, got \"one\"; 1 is taken"},
        Case{"offset='nan'", "the offset of the <mimic> of joint \"other\" must be a number up to 1e6, got \"nan\"; 0 is taken"},
        Case{"offset='3'", "joint \"one\": it would have to be at 3 to 4, beyond its limits 0 to 1; it moves on its own", false}}) {
    const auto loaded = load_with(each.numbers);
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_EQ(loaded->findings.size(), 1U) << each.numbers;
    EXPECT_NE(loaded->findings[0].text().find(each.line), std::string::npos) << loaded->findings[0].text();
    EXPECT_EQ(loaded->model.joint("other")->mimic.has_value(), each.follows);
  }
}

TEST(Urdf, joints_mimic_others) {
  const auto loaded =
      load(link("palm") + link("left") + link("right") +
           "<joint name='one' type='prismatic'><parent link='palm'/><child link='left'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' "
           "effort='1' velocity='1'/></joint><joint name='other' type='prismatic'><parent link='palm'/><child link='right'/><axis xyz='0 0 "
           "-1'/><limit lower='-1' upper='1' effort='1' velocity='1'/><mimic joint='one' multiplier='-2' offset='0.1'/></joint>");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(loaded->findings.empty()) << loaded->findings.front().text();
  const JointDef* other = loaded->model.joint("other");
  ASSERT_TRUE(other != nullptr && other->mimic);
  EXPECT_EQ(other->mimic->leader, "one");
  EXPECT_EQ(other->mimic->multiplier, -2);
  EXPECT_EQ(other->mimic->offset, 0.1);
}

constexpr const char* two_fingers =
    "<joint name='one' type='prismatic'><parent link='palm'/><child link='left'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' "
    "velocity='1'/></joint><joint name='other' type='prismatic'><parent link='palm'/><child link='right'/><axis xyz='0 0 -1'/><limit "
    "lower='-1' upper='1' effort='1' velocity='1'/></joint>";

TEST(Urdf, joints_start_where_ros2_control_says) {
  const auto control = [](const std::string& joint, const std::string& content) {
    return "<ros2_control name='s' type='system'><joint name='" + joint + "'>" + content + "</joint></ros2_control>";
  };
  const auto start = [&](const std::string& content, std::size_t findings = 0, const std::string& joint = "one") {
    const auto loaded = load(link("palm") + link("left") + link("right") + two_fingers + control(joint, content));
    if (!loaded) throw std::runtime_error(loaded.error().message);
    EXPECT_EQ(loaded->findings.size(), findings) << content << (loaded->findings.empty() ? "" : "\n" + loaded->findings.front().text());
    return loaded->model.joint("one")->axes[0].initial_position;
  };
  const auto state = [](const std::string& name, const std::string& value) {
    return "<state_interface name='" + name + "'><param name='initial_value'>" + value + "</param></state_interface>";
  };
  EXPECT_EQ(start("<command_interface name='position'><param name='min'>-1</param></command_interface>" + state("position", " 0.25 ")),
            0.25);
  EXPECT_EQ(start(state("velocity", "3") + state("position", "-0.5")), -0.5);
  EXPECT_EQ(start("<state_interface name='position'/><param name='initial_position'>0.75</param>"), 0.75) << "of simulated hardware";
  EXPECT_EQ(start(state("velocity", "0.5")), 0);
  EXPECT_EQ(start(state("position", "7"), 1), 1) << "the nearest limit";
  EXPECT_EQ(start(state("position", "nan"), 1), 0);
  EXPECT_EQ(start(state("position", "up"), 1), 0);
  EXPECT_EQ(start(state("position", "0.5"), 1, "nobody"), 0);
}

TEST(Urdf, joints_mimic_others_by_the_plugin_of_gazebo) {
  const auto load_with = [](const std::string& leader, const std::string& more = {}) {
    return load(link("palm") + link("left") + link("right") + two_fingers +
                "<gazebo><plugin filename='libroboticsgroup_upatras_gazebo_mimic_joint_plugin.so' name='m'><joint>" + leader +
                "</joint><mimicJoint>other</mimicJoint>" + more + "</plugin></gazebo>");
  };
  const auto loaded = load_with("one", "<multiplier>-2.0</multiplier><offset>0.1</offset>");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(loaded->findings.empty()) << loaded->findings.front().text();
  const JointDef* other = loaded->model.joint("other");
  ASSERT_TRUE(other != nullptr && other->mimic);
  EXPECT_EQ(other->mimic->leader, "one");
  EXPECT_EQ(other->mimic->multiplier, -2);
  EXPECT_EQ(other->mimic->offset, 0.1);
  const auto lost = load_with("nobody");
  ASSERT_TRUE(lost && lost->findings.size() == 1);
  EXPECT_NE(lost->findings[0].text().find("joint \"other\" does not mimic joint \"nobody\": one of them does not exist"), std::string::npos)
      << lost->findings[0].text();
  EXPECT_FALSE(lost->model.joint("other")->mimic);
}

TEST(Urdf, elements_of_ros_count_in_sdformat_too) {
  const auto loaded = load_model(
      "<sdf version='1.7'><model name='arm'><link name='a'/><link name='b'/><link name='c'/>"
      "<joint name='waist' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>"
      "<joint name='elbow' type='revolute'><parent>b</parent><child>c</child><axis><xyz>0 0 1</xyz></axis></joint>"
      "<ros2_control name='s' type='system'><joint name='waist'><state_interface name='position'><param "
      "name='initial_value'>0.5</param></state_interface></joint></ros2_control>"
      "<plugin filename='libgazebo_mimic_joint_plugin.so' "
      "name='m'><joint>waist</joint><mimicJoint>elbow</mimicJoint></plugin></model></sdf>",
      "", std::nullopt, ModelPath{});
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->model.joint("waist")->axes[0].initial_position, 0.5);
  ASSERT_TRUE(loaded->model.joint("elbow")->mimic);
  EXPECT_EQ(loaded->model.joint("elbow")->mimic->leader, "waist");
}

}  // namespace
}  // namespace sim
