// Elements about joints that mean nothing: each has one line with the object, the value and what counts instead.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "world/world_loader.h"

namespace sim {
namespace {

namespace fs = std::filesystem;

class JointElements : public testing::Test {
 protected:
  JointElements() : folder_(fs::path(testing::TempDir()) / ("joint-elements-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~JointElements() override { fs::remove_all(folder_); }

  // A model with the joints "waist" and "elbow", in whose axes and after which these elements are.
  void load(const std::string& in_waist, const std::string& in_elbow, const std::string& after = "") {
    const auto path = folder_ / "model.sdf";
    const auto joint = [](const std::string& name, const std::string& parent, const std::string& child, const std::string& axis) {
      return "<joint name='" + name + "' type='revolute'><parent>" + parent + "</parent><child>" + child +
             "</child><axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper></limit>" + axis + "</axis></joint>";
    };
    std::ofstream(path) << "<sdf version='1.11'><model name='arm'><link name='a'/><link name='b'/><link name='c'/>"
                        << joint("waist", "a", "b", in_waist) << joint("elbow", "b", "c", in_elbow) << after << "</model></sdf>";
    auto loaded = load_model(path.string(), "", std::nullopt, ModelPath({folder_}));
    ASSERT_TRUE(loaded) << loaded.error().message;
    model_ = std::move(loaded->model);
    findings_.clear();
    for (const Finding& finding : loaded->findings) findings_ += finding.text() + "\n";
  }
  void expect_line(const std::string& line) const { EXPECT_NE(findings_.find(line), std::string::npos) << line << "\nin\n" << findings_; }
  const std::optional<MimicDef>& mimic_of_elbow() const { return model_.joints[1].mimic; }

  const fs::path folder_;
  ModelDef model_;
  std::string findings_;
};

TEST_F(JointElements, a_joint_that_mimics_one_that_is_not_there_moves_on_its_own_with_a_line) {
  load("", "<mimic joint='nose'/>");
  EXPECT_FALSE(mimic_of_elbow());
  expect_line("joint \"elbow\" of model \"arm\" does not mimic joint \"nose\": there is no such joint with one axis; it moves on its own");
}

TEST_F(JointElements, joints_that_mimic_themselves_or_each_other_are_set_free_with_a_line) {
  load("", "<mimic joint='elbow'/>");
  EXPECT_FALSE(mimic_of_elbow());
  expect_line("joint \"elbow\" of model \"arm\" does not mimic joint \"elbow\": it would follow itself; it moves on its own");
  load("<mimic joint='elbow'/>", "<mimic joint='waist'/>");
  EXPECT_FALSE(model_.joints[0].mimic);
  ASSERT_TRUE(mimic_of_elbow());
  EXPECT_EQ(mimic_of_elbow()->leader, "waist");
  expect_line("joint \"waist\" of model \"arm\" does not mimic joint \"elbow\": it would follow itself");
}

TEST_F(JointElements, impossible_numbers_of_a_mimic_have_a_line_and_the_defaults_count) {
  load("", "<mimic joint='waist'><multiplier>nan</multiplier><offset>1e200</offset><reference>0.5</reference></mimic>");
  ASSERT_TRUE(mimic_of_elbow());
  EXPECT_EQ(mimic_of_elbow()->multiplier, 1);
  EXPECT_EQ(mimic_of_elbow()->offset, 0);
  EXPECT_EQ(mimic_of_elbow()->reference, 0.5);
  expect_line("the multiplier of the <mimic> of joint \"elbow\"");
  expect_line("must be a number up to 1e6, got \"nan\"; 1 is taken");
  expect_line("must be a number up to 1e6, got \"1e200\"; 0 is taken");
}

constexpr const char* controller =
    "<plugin filename='gz-sim-joint-position-controller-system' name='gz::sim::systems::JointPositionController'>"
    "<joint_name>elbow</joint_name>";

TEST_F(JointElements, impossible_gains_of_a_controller_have_a_line_each) {
  load("", "", std::string(controller) + "<p_gain>-100</p_gain><i_gain>much</i_gain><d_gain>1e300</d_gain></plugin>");
  for (const char* wrong : {"<p_gain>", "<i_gain>", "<d_gain>"}) expect_line(wrong + std::string(" of plugin"));
  expect_line("must be a number from 0 to 1e12, got \"-100\"; its default is taken");
  expect_line("must be a number from 0 to 1e12, got \"much\"; its default is taken");
}

TEST_F(JointElements, an_impossible_gain_of_one_joint_leaves_those_of_the_next_joint_in_their_place) {
  load("", "",
       "<plugin filename='gz-sim-joint-trajectory-controller-system' name='gz::sim::systems::JointTrajectoryController'>"
       "<joint_name>waist</joint_name><joint_name>elbow</joint_name><position_p_gain>nan</position_p_gain>"
       "<position_p_gain>50</position_p_gain></plugin>");
  expect_line("must be a number from 0 to 1e12, got \"nan\"; 0 is taken");
  std::vector<std::string> gains;
  for (const ParameterNode& child : model_.plugins.at(0).parameters.children) {
    if (child.name == "position_p_gain") gains.push_back(child.text);
  }
  EXPECT_EQ(gains, (std::vector<std::string>{"0", "50"}));
}

TEST_F(JointElements, counts_of_a_grasp_check_below_one_have_a_line) {
  load("", "",
       "<gripper name='hand'><palm_link>b</palm_link><gripper_link>c</gripper_link><grasp_check><attach_steps>-3</attach_steps>"
       "</grasp_check></gripper>");
  EXPECT_EQ(model_.grippers.at(0).attach_checks, 1);
  expect_line("grasp_check/attach_steps of gripper \"hand\" of model \"arm\" must be from 1 to 1000000, got -3; 1 is taken");
}

TEST_F(JointElements, elements_of_ros2_control_are_no_unknown_elements) {
  load("", "",
       "<ros2_control type='system'><joint name='elbow'><state_interface name='position'><param name='initial_value'>0.5</param>"
       "</state_interface></joint></ros2_control>");
  EXPECT_EQ(model_.joints[1].axes[0].initial_position, 0.5);
  EXPECT_EQ(findings_.find("ros2_control"), std::string::npos) << findings_;
}

}  // namespace
}  // namespace sim
