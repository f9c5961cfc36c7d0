#include "system/configuration.h"

#include <gtest/gtest.h>

namespace tools {
namespace {

ComponentView component() {
  ComponentView view;
  view.path = "/localhost/A0.rtc";
  view.configuration_sets = {
      {"default", {{"gain", "1"}, {"name", "x"}}}, {"__type__", {{"gain", "int"}}}, {"__constraints__", {{"gain", "0<=x<=9"}}}};
  return view;
}

TEST(ConfigurationTest, a_set_is_found_by_its_id) {
  const auto view = component();
  EXPECT_EQ(find_set(view, "default"), &view.configuration_sets.front());
  EXPECT_EQ(find_set(view, "other"), nullptr);
}

TEST(ConfigurationTest, a_value_is_held_against_the_declared_type_before_the_constraint) {
  EXPECT_EQ(value_problem(component(), "gain", "5"), "");
  EXPECT_EQ(value_problem(component(), "gain", "5.5"), type_problem("int", "5.5"));
  EXPECT_EQ(value_problem(component(), "gain", "10"), constraint_problem("0<=x<=9", "10"));
  EXPECT_NE(value_problem(component(), "gain", "10"), "");
}

TEST(ConfigurationTest, a_parameter_without_declaration_takes_every_value) {
  EXPECT_EQ(value_problem(component(), "name", "anything"), "");
  EXPECT_EQ(value_problem(component(), "unknown", "1"), "");
}

}  // namespace
}  // namespace tools
