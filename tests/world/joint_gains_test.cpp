// Gains from the YAML files of ros_control and ros2_control: where they stand in them, how the files are found, what is left out.
#include "world/joint_gains.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "world/world_loader.h"

namespace sim {
namespace {

namespace fs = std::filesystem;

class JointGains : public testing::Test {
 protected:
  JointGains() : folder_(fs::path(testing::TempDir()) / ("gains-" + std::to_string(getpid()))) { fs::create_directories(folder_); }
  ~JointGains() override { fs::remove_all(folder_); }
  std::string file(const std::string& name, const std::string& content) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << content;
    return (folder_ / name).string();
  }
  // "JOINT P I D LOW HIGH", a line each.
  std::string read(const std::string& content) {
    left_out_.clear();
    const auto gains = read_gains(file("g.yaml", content), left_out_);
    if (!gains) return gains.error().message.substr(gains.error().message.find("g.yaml"));
    std::string text;
    for (const GainsDef& one : *gains) {
      text += one.joint;
      for (const double value : {one.p, one.i, one.d, one.i_low, one.i_high}) text += " " + std::to_string(value);
      text += "\n";
    }
    return text;
  }
  // Of a model with the joints "elbow" and "waist", loaded from the folder.
  LoadedModel model(const std::string& parameters) const {
    const auto path = file("arm/model.sdf",
                           "<sdf version='1.9'><model name='arm'><link name='a'/><link name='b'/><link name='c'/>"
                           "<joint name='waist' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>"
                           "<joint name='elbow' type='revolute'><parent>b</parent><child>c</child><axis><xyz>0 0 1</xyz></axis></joint>"
                           "<plugin filename='libgazebo_ros2_control.so' name='control'><parameters>" +
                               parameters + "</parameters></plugin></model></sdf>");
    auto loaded = load_model(path, "", std::nullopt, ModelPath({folder_ / "packages"}));
    if (!loaded) throw std::runtime_error(loaded.error().message);
    return std::move(*loaded);
  }
  static std::string findings(const LoadedModel& loaded) {
    std::string text;
    for (const Finding& finding : loaded.findings) text += finding.text() + "\n";
    return text;
  }

  const fs::path folder_;
  std::vector<std::string> left_out_;
};

constexpr const char* of_ros2 =
    "joint_trajectory_controller:\n  ros__parameters:\n    joints: [elbow, waist]\n    command_interfaces: [effort]\n"
    "    gains:\n      elbow: {p: 4000.0, i: 1, d: 200, i_clamp: 2}\n      waist: {p: 30}\n";

TEST_F(JointGains, stand_in_controllers_of_ros_2_and_ros_1_and_of_gazebo) {
  EXPECT_EQ(read(of_ros2), "elbow 4000.000000 1.000000 200.000000 -2.000000 2.000000\nwaist 30.000000 0.000000 0.000000 -inf inf\n");
  EXPECT_EQ(
      read("arm_controller:\n  type: effort_controllers/JointTrajectoryController\n  gains: {elbow: {p: 5, d: 1, i_clamp_min: -3}}\n"),
      "elbow 5.000000 0.000000 1.000000 -3.000000 inf\n");
  EXPECT_EQ(read("robot:\n  gazebo_ros_control/pid_gains:\n    elbow: {p: 100.0, i: 0.01, d: 10.0}\n"),
            "elbow 100.000000 0.010000 10.000000 -inf inf\n");
  EXPECT_EQ(read("gazebo_ros_control:\n  pid_gains:\n    elbow: {p: 7}\n"), "elbow 7.000000 0.000000 0.000000 -inf inf\n");
  EXPECT_EQ(read("elbow_controller: {type: effort_controllers/JointPositionController, joint: elbow, pid: {p: 8, i: 1, d: 2}}\n"),
            "elbow 8.000000 1.000000 2.000000 -inf inf\n");
  EXPECT_EQ(read("controller_manager: {ros__parameters: {update_rate: 100}}\n"), "");
  EXPECT_TRUE(left_out_.empty());
}

TEST_F(JointGains, of_other_units_and_impossible_ones_are_left_out_with_a_line) {
  EXPECT_EQ(read("c:\n  type: velocity_controllers/JointTrajectoryController\n  gains: {elbow: {p: 5}}\n"), "");
  ASSERT_EQ(left_out_.size(), 1U);
  EXPECT_NE(left_out_[0].find("g.yaml:2: the gains of a controller that does not command efforts are left out"), std::string::npos)
      << left_out_[0];
  EXPECT_EQ(read("gazebo_ros_control/pid_gains:\n  elbow: {p: much}\n  waist: {p: -1}\n  wrist: {p: 1, d: .nan}\n  hip: {p: 2}\n"),
            "hip 2.000000 0.000000 0.000000 -inf inf\n");
  ASSERT_EQ(left_out_.size(), 3U);
  EXPECT_NE(left_out_[0].find("g.yaml:2: gain p of joint \"elbow\" must be a number, got \"much\"; its gains are left out"),
            std::string::npos)
      << left_out_[0];
  EXPECT_NE(left_out_[1].find("g.yaml:3: the gains of joint \"waist\" must not be negative"), std::string::npos) << left_out_[1];
  EXPECT_NE(read("a: [1, 2\n").find("is no YAML: line"), std::string::npos);
  EXPECT_FALSE(read_gains(folder_ / "nothing.yaml", left_out_));
}

TEST_F(JointGains, come_from_the_file_that_a_plugin_names_wherever_it_was_installed) {
  file("packages/my_arm/config/control.yaml", of_ros2);
  for (const char* parameters :
       {"package://my_arm/config/control.yaml", "$(find my_arm)/config/control.yaml", "$(find-pkg-share my_arm)/config/control.yaml",
        "/home/somebody/ws/install/my_arm/share/my_arm/config/control.yaml"}) {
    const LoadedModel loaded = model(parameters);
    ASSERT_EQ(loaded.model.gains.size(), 2U) << parameters << "\n" << findings(loaded);
    EXPECT_EQ(loaded.model.gains[0].joint, "elbow");
    EXPECT_EQ(loaded.model.gains[0].p, 4000);
    EXPECT_NE(loaded.model.gains[0].source.find("control.yaml:6"), std::string::npos) << loaded.model.gains[0].source;
  }
  file("arm/config/beside.yaml", of_ros2);
  EXPECT_EQ(model("/home/somebody/beside.yaml").model.gains.size(), 2U);
}

TEST_F(JointGains, of_a_file_that_is_not_there_are_missed_in_one_line) {
  const LoadedModel loaded = model("/home/somebody/elsewhere.yaml");
  EXPECT_TRUE(loaded.model.gains.empty());
  const std::string text = findings(loaded);
  const std::string line =
      "gains: the file \"/home/somebody/elsewhere.yaml\" is not found; the gains of its joints are derived, or name it with --gains";
  EXPECT_NE(text.find(line), std::string::npos) << text;
  EXPECT_EQ(text.find(line), text.rfind(line));
}

TEST_F(JointGains, and_positions_can_be_given_to_a_model_that_is_spawned) {
  auto loaded = model("");
  std::vector<std::string> left_out;
  ASSERT_TRUE(add_named_gains(of_ros2, loaded.model, left_out));
  ASSERT_EQ(loaded.model.gains.size(), 2U);
  EXPECT_TRUE(loaded.model.gains[0].is_named);
  EXPECT_EQ(loaded.model.gains[0].source, "--gains:6");
  EXPECT_EQ(add_named_gains("pid_gains: {nose: {p: 1}}", loaded.model, left_out).error().message,
            "gains: they are of no joint of model arm");
  EXPECT_EQ(add_named_gains("arm: {type: x}", loaded.model, left_out).error().message, "gains: the file has no gains of joints");
  EXPECT_EQ(add_named_gains("pid_gains: {elbow: {p: fast}}", loaded.model, left_out).error().message,
            "gains: none of them can be used; --gains:1: gain p of joint \"elbow\" must be a number, got \"fast\"; its gains are left out");
  EXPECT_NE(add_named_gains("a: [1, 2", loaded.model, left_out).error().message.find("is no YAML: line"), std::string::npos);
  ASSERT_TRUE(set_initial_positions("elbow=0.5\nwaist=-1", loaded.model));
  EXPECT_EQ(loaded.model.joint("elbow")->axes[0].initial_position, 0.5);
  EXPECT_EQ(loaded.model.joint("waist")->axes[0].initial_position, -1);
  EXPECT_EQ(set_initial_positions("nose=1", loaded.model).error().message,
            "model arm has no joint \"nose\" that moves; it has waist, elbow");
  EXPECT_EQ(set_initial_positions("elbow=up", loaded.model).error().message, "joint \"elbow=up\": expected JOINT=NUMBER");
  EXPECT_EQ(set_initial_positions("elbow", loaded.model).error().message, "joint \"elbow\": expected JOINT=NUMBER");
}

}  // namespace
}  // namespace sim
