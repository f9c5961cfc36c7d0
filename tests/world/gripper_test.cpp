// <gripper> elements: links by the names that files use, and what is wrong in one.
#include <gtest/gtest.h>

#include "world/world_loader.h"

namespace sim {
namespace {

LoadedModel hand(const std::string& grippers) {
  auto loaded = load_model(
      "<sdf version='1.9'><model name='robot'><link name='base'/><model name='hand'><link name='palm'/><link name='left'/><link "
      "name='right'/>" +
          grippers + "</model></model></sdf>",
      "", std::nullopt, ModelPath{});
  if (!loaded) throw std::runtime_error(loaded.error().message);
  return std::move(*loaded);
}

std::string findings(const LoadedModel& loaded) {
  std::string text;
  for (const Finding& finding : loaded.findings) text += finding.message + "\n";
  return text;
}

TEST(Gripper, names_links_with_the_models_before_them_or_without) {
  const auto loaded = hand(
      "<gripper name='grip'><grasp_check><attach_steps>7</attach_steps><min_contact_count>3</min_contact_count></grasp_check>"
      "<palm_link>hand::palm</palm_link><gripper_link>left</gripper_link><gripper_link>robot::hand::right</gripper_link>"
      "<gripper_link>left</gripper_link></gripper>");
  ASSERT_EQ(loaded.model.grippers.size(), 1U) << findings(loaded);
  const GripperDef& gripper = loaded.model.grippers[0];
  EXPECT_EQ(gripper.name, "hand::grip");
  EXPECT_EQ(gripper.palm, "hand::palm");
  EXPECT_EQ(gripper.fingers, (std::vector<std::string>{"hand::left", "hand::right"}));
  EXPECT_EQ(gripper.attach_checks, 7);
  EXPECT_EQ(gripper.detach_checks, 40);
  EXPECT_EQ(gripper.contacts, 3);
}

TEST(Gripper, without_links_that_exist_is_left_out_with_lines) {
  const auto loaded = hand(
      "<gripper name='none'><palm_link>palm</palm_link><gripper_link>thumb</gripper_link></gripper>"
      "<gripper name='grip'><gripper_link>left</gripper_link></gripper><gripper name='grip'><gripper_link>right</gripper_link></gripper>");
  ASSERT_EQ(loaded.model.grippers.size(), 1U) << findings(loaded);
  EXPECT_EQ(loaded.model.grippers[0].palm, "hand::left") << "the first finger";
  const std::string text = findings(loaded);
  EXPECT_NE(text.find("names the link \"thumb\", which does not exist; it is left out"), std::string::npos) << text;
  EXPECT_NE(text.find("has no gripper_link that exists; it is ignored"), std::string::npos) << text;
  EXPECT_NE(text.find("has the name of another one; it is ignored"), std::string::npos) << text;
}

}  // namespace
}  // namespace sim
