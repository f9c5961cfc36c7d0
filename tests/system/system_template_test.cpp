#include "system/profile/system_template.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace tools {
namespace {

SavedComponent template_component(const std::string& instance, const std::string& device = "") {
  SavedComponent made;
  made.instance = instance;
  made.path_uri = "localhost/" + instance + ".rtc";
  made.configuration_sets = {{"default", {{"device_id", device}}}};
  return made;
}

SavedConnector template_connector(const std::string& id, const std::string& from, const std::string& to) {
  SavedConnector made;
  made.id = id;
  made.source = {"", from, from + ".out", "localhost/" + from + ".rtc"};
  made.target = {"", to, to + ".in", "localhost/" + to + ".rtc"};
  return made;
}

SavedSystem fleet_template() {
  SavedSystem system;
  system.components = {template_component("Dispatcher"), template_component("Laser_{robot}", "{robot}::laser"),
                       template_component("Drive_{robot}", "{robot#}")};
  system.connectors = {template_connector("scan_{robot}", "Laser_{robot}", "Drive_{robot}"),
                       template_connector("orders", "Dispatcher", "Drive_{robot}")};
  return system;
}

std::vector<std::string> instances_of_template(const SavedSystem& system) {
  std::vector<std::string> names;
  for (const auto& component : system.components) names.push_back(component.instance);
  return names;
}

template <class T>
void expect_template_error(const base::Result<T>& result, const std::string& part) {
  ASSERT_FALSE(result.ok()) << part;
  EXPECT_NE(result.error().message.find(part), std::string::npos) << result.error().message;
}

TEST(SystemTemplate, components_with_the_name_are_repeated_robot_by_robot_and_others_stand_once) {
  const auto system = filled_in(fleet_template(), {"robot=r8..r10"}, "fleet.xml");
  ASSERT_TRUE(system.ok()) << system.error().message;
  EXPECT_EQ(instances_of_template(*system),
            (std::vector<std::string>{"Dispatcher", "Laser_r8", "Drive_r8", "Laser_r9", "Drive_r9", "Laser_r10", "Drive_r10"}));
  EXPECT_EQ(system->components[3].path_uri, "localhost/Laser_r9.rtc");
  EXPECT_EQ(system->components[3].configuration_sets[0].values[0].second, "r9::laser");
  EXPECT_EQ(system->components[4].configuration_sets[0].values[0].second, "1");
}

TEST(SystemTemplate, connections_are_repeated_and_their_ids_stay_unique) {
  const auto system = filled_in(fleet_template(), {"robot=a,b"}, "fleet.xml");
  ASSERT_TRUE(system.ok()) << system.error().message;
  std::vector<std::string> lines;
  for (const auto& one : system->connectors) lines.push_back(one.id + " " + one.source.port_name + " " + one.target.port_name);
  EXPECT_EQ(lines, (std::vector<std::string>{"scan_a Laser_a.out Drive_a.in", "orders-a Dispatcher.out Drive_a.in",
                                             "scan_b Laser_b.out Drive_b.in", "orders-b Dispatcher.out Drive_b.in"}));
}

TEST(SystemTemplate, two_lists_make_all_combinations) {
  SavedSystem system;
  system.components = {template_component("Laser_{robot}_{side}")};
  const auto filled = filled_in(system, {"robot=a,b", "side=l,r"}, "fleet.xml");
  ASSERT_TRUE(filled.ok()) << filled.error().message;
  EXPECT_EQ(instances_of_template(*filled), (std::vector<std::string>{"Laser_a_l", "Laser_a_r", "Laser_b_l", "Laser_b_r"}));
}

TEST(SystemTemplate, lists_are_ranges_words_and_numbers) {
  const auto values = [](const std::string& text) { return base::NameList::parse(text)->values; };
  EXPECT_EQ(values("robot=r0..r2"), (std::vector<std::string>{"r0", "r1", "r2"}));
  EXPECT_EQ(values("robot=r08..r11"), (std::vector<std::string>{"r08", "r09", "r10", "r11"}));
  EXPECT_EQ(values("robot=9..11"), (std::vector<std::string>{"9", "10", "11"}));
  EXPECT_EQ(values("robot=lead,r0..r1"), (std::vector<std::string>{"lead", "r0", "r1"}));
  EXPECT_EQ(values("robot=3"), (std::vector<std::string>{"robot0", "robot1", "robot2"}));
}

TEST(SystemTemplate, a_bad_list_is_named_with_what_was_expected) {
  for (const auto& [text, why] : std::vector<std::pair<std::string, std::string>>{{"robot", "has no name"},
                                                                                  {"=r0", "has no name"},
                                                                                  {"robot=", "has no values"},
                                                                                  {"robot=0", "0 values"},
                                                                                  {"robot=200000", "200000 values"},
                                                                                  {"robot=r9..r0", "not a range"},
                                                                                  {"robot=a0..b9", "not a range"},
                                                                                  {"robot=a..b", "not a range"},
                                                                                  {"robot=r0..r999999999", "not a range"},
                                                                                  {"robot=a,a", "twice"},
                                                                                  {"robot=a b", "part of a name"},
                                                                                  {"robot={x}", "part of a name"}}) {
    expect_template_error(base::NameList::parse(text), why);
    expect_template_error(base::NameList::parse(text), "expected NAME=LIST");
  }
}

TEST(SystemTemplate, a_name_without_a_list_and_a_list_without_a_name_are_errors) {
  expect_template_error(filled_in(fleet_template(), {}, "fleet.xml"), "expected --for robot=LIST");
  expect_template_error(filled_in(fleet_template(), {"robot=a", "side=l"}, "fleet.xml"), "does not contain {side}");
  expect_template_error(filled_in(fleet_template(), {"robot=a", "robot=b"}, "fleet.xml"), "has a list already");
}

TEST(SystemTemplate, a_component_repeated_under_one_name_is_an_error) {
  SavedSystem system;
  system.components = {template_component("Laser", "{robot}::laser")};
  expect_template_error(filled_in(system, {"robot=a,b"}, "fleet.xml"), "two components are called \"Laser\"");
}

TEST(SystemTemplate, other_braces_stay_and_a_plain_system_needs_no_list) {
  SavedSystem system;
  system.components = {template_component("Laser", R"({"a":[1,{"robot":2}]})")};
  const auto filled = filled_in(system, {}, "plain.xml");
  ASSERT_TRUE(filled.ok()) << filled.error().message;
  EXPECT_EQ(filled->components[0].configuration_sets[0].values[0].second, R"({"a":[1,{"robot":2}]})");
}

TEST(SystemTemplate, a_million_entries_are_the_most) {
  SavedSystem system;
  system.components = {template_component("L_{a}_{b}")};
  expect_template_error(filled_in(system, {"a=2000", "b=2000"}, "fleet.xml"), "more than 1000000");
}

TEST(SystemTemplate, properties_of_components_are_repeated) {
  const auto texts = filled_in(std::vector<std::string>{"Laser_{robot}:rate=5", "Other:x=1"}, {"robot=a,b"});
  ASSERT_TRUE(texts.ok());
  EXPECT_EQ(*texts, (std::vector<std::string>{"Laser_a:rate=5", "Laser_b:rate=5", "Other:x=1"}));
}

}  // namespace
}  // namespace tools
