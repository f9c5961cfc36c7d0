// What libsdformat throws, prints or loses never reaches a user: names of flattened nested models, as Gazebo classic writes them.
#include <gmock/gmock.h>

#include <iostream>

#include "support/world_files.h"

namespace sim {
namespace {

using testing::HasSubstr;

// Links called as Gazebo classic calls those of nested models; `pose` stands in each of them.
std::string flattened(const std::string& pose) {
  return "<model name='m'><link name='base'/><link name='arm::hand'>" + pose + "<collision name='c'>" + pose +
         "<geometry><box/></geometry></collision></link><link name='arm::finger'/>"
         "<joint name='arm::bend' type='revolute'>" +
         pose + "<parent>arm::hand</parent><child>arm::finger</child><axis><xyz>0 0 1</xyz></axis></joint></model>";
}

const ModelDef& only_model(const LoadResult& result) {
  static const ModelDef none;
  EXPECT_EQ(result.world.models.size(), 1U) << all_findings(result);
  return result.world.models.empty() ? none : result.world.models.front();
}

TEST(LibraryBorder, empty_frames_in_flattened_models_say_nothing) {
  for (const char* version : {"1.4", "1.5", "1.6", "1.7"}) {
    const LoadResult result = WorldFiles().load(flattened("<pose frame=''>0 0 1 0 0 0</pose>"), version);
    const ModelDef& model = only_model(result);
    EXPECT_TRUE(result.findings.empty()) << version << "\n" << all_findings(result);
    ASSERT_NE(model.link("arm::hand"), nullptr) << version;
    EXPECT_EQ(model.link("arm::hand")->pose.translation(), Eigen::Vector3d(0, 0, 1)) << version;
    EXPECT_NE(model.joint("arm::bend"), nullptr) << version;
  }
}

TEST(LibraryBorder, empty_frames_are_nothing_to_a_running_server_either) {
  const auto model = load_model("<sdf version='1.6'>" + flattened("<pose frame=''>0 0 1 0 0 0</pose>") + "</sdf>", "", {}, ModelPath{});
  ASSERT_TRUE(model) << model.error().message;
  // The translation makes nested models in worlds alone.
  EXPECT_NE(model->model.link("arm_hand"), nullptr);
}

TEST(LibraryBorder, references_out_of_a_flattened_model_are_kept) {
  const std::string frame = "<frame name='f'><pose>0 0 5 0 0 0</pose></frame>";
  const LoadResult result =
      WorldFiles().load("<model name='m'>" + frame +
                            "<link name='arm::hand'><pose relative_to='f'>0 0 1 0 0 0</pose></link><link name='base'/>"
                            "<joint name='arm::bend' type='fixed'><parent>base</parent><child>arm::hand</child></joint>"
                            "<plugin name='p' filename='libDiffDrivePlugin.so'><left_joint>arm::bend</left_joint></plugin></model>",
                        "1.7");
  const ModelDef& model = only_model(result);
  EXPECT_EQ(findings_with(result, "names with '::' (\"arm::bend\" and the like)"), 1) << all_findings(result);
  ASSERT_NE(model.link("arm_hand"), nullptr);
  EXPECT_EQ(model.link("arm_hand")->pose.translation(), Eigen::Vector3d(0, 0, 6));
  ASSERT_NE(model.joint("arm_bend"), nullptr);
  EXPECT_EQ(model.joint("arm_bend")->parent, "base");
  ASSERT_EQ(model.plugins.size(), 1U);
  EXPECT_EQ(model.plugins[0].parameters.text_of({"left_joint"}), "arm_bend");
}

TEST(LibraryBorder, joints_of_a_flattened_model_with_the_world_are_kept) {
  const LoadResult result = WorldFiles().load(
      "<model name='m'><link name='arm::hand'/><joint name='arm::hold' "
      "type='fixed'><parent>world</parent><child>arm::hand</child></joint></model>",
      "1.6");
  ASSERT_EQ(only_model(result).joints.size(), 1U) << all_findings(result);
  EXPECT_EQ(only_model(result).joints[0].parent, "");
}

// The library reports what it refuses by itself; only our own lines are for users.
TEST(LibraryBorder, prints_nothing) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const WorldFiles files;
  for (const char* text :
       {"<robot name='r'><link name='a'/><link name='a'/></robot>", "<robot name='r'><link/><joint name='j' type='x'/></robot>",
        "<robot name='r'><link name='a'><inertial><mass value='x'/></inertial></link></robot>", "<robot/>",
        "<sdf version='1.4'><model name='m'><link name='::'><pose frame='::'>1</pose></link><joint name='::a'/></model></sdf>",
        "<sdf version='1.6'><model name='m'><link name='l'/><joint name='a::j'/><frame name='a::__model__' "
        "attached_to='x'/></model></sdf>"}) {
    const auto model = load_model(text, "", {}, ModelPath{});
    EXPECT_TRUE(model || model.error().message.find('\n') == std::string::npos) << text;
  }
  std::cerr << "heard";
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "heard");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace sim
