#include "system/saved_system.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/orb_environment.h"  // a timeout of calls needs an ORB
#include "system/fake_components.h"

namespace tools {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

SavedComponent saved(const std::string& instance, const std::string& state = "Active") {
  SavedComponent component;
  component.instance = instance;
  component.path_uri = "localhost/" + instance + ".rtc";
  component.contexts.push_back({.id = "0", .state = state});
  return component;
}

SavedConnector saved_connector() {
  SavedConnector connector;
  connector.id = "id1";
  connector.source = {"", "A0", "A0.out", "localhost/A0.rtc"};
  connector.target = {"", "B0", "B0.in", "localhost/B0.rtc"};
  return connector;
}

std::vector<std::string> messages(const Changes& changes) {
  std::vector<std::string> texts;
  for (const auto& error : changes.errors) texts.push_back(error.message);
  return texts;
}

// A0.out and B0.in, both inactive, in a system that has them connected and active.
class SavedSystemTest : public testing::Test {
 protected:
  SavedSystemTest() {
    system_.components = {saved("A0"), saved("B0")};
    system_.connectors = {saved_connector()};
    a_.ports.push_back(port_view("A0.out", "DataOutPort"));
    b_.ports.push_back(port_view("B0.in", "DataInPort"));
  }
  Matched matched() const { return {{a_, b_}, system_}; }
  // Nothing is called: the session has no ORB.
  Changes plan_load(LoadOptions options = {}) const {
    options.dry_run = true;
    return load(session_, matched(), system_, options);
  }
  Changes plan_move(Transition transition) const { return move_all(session_, matched(), system_, true, transition); }

  const Session session_{CORBA::ORB::_nil(), "localhost", std::chrono::milliseconds(100)};
  SavedSystem system_;
  ComponentView a_ = component_view("A0"), b_ = component_view("B0");
};

TEST_F(SavedSystemTest, a_dry_run_lists_connections_values_and_states_in_the_order_of_the_profile) {
  a_.configuration_sets = {{"default", {{"gain", "1"}}}};
  system_.components[0].configuration_sets = {{"default", {{"gain", "2"}}}};
  const auto changes = plan_load({.with_states = true});
  EXPECT_THAT(messages(changes), IsEmpty());
  EXPECT_THAT(changes.actions,
              ElementsAre("connect A0.out to B0.in", "set configuration default of /localhost/A0.rtc",
                          "bring /localhost/A0.rtc from Inactive to Active", "bring /localhost/B0.rtc from Inactive to Active"));
}

TEST_F(SavedSystemTest, nothing_is_changed_when_a_required_component_is_missing) {
  system_.components.push_back(saved("C0"));
  const auto changes = plan_load();
  EXPECT_THAT(messages(changes), ElementsAre("component localhost/C0.rtc: is not on the name server"));
  EXPECT_THAT(changes.actions, IsEmpty());
}

TEST_F(SavedSystemTest, a_missing_component_that_is_optional_is_left_out_with_its_connections) {
  system_.components[1].is_required = false;
  const Matched only_a({a_}, system_);
  const auto changes = load(session_, only_a, system_, {.dry_run = true, .with_states = true});
  EXPECT_THAT(messages(changes), IsEmpty());
  EXPECT_THAT(changes.actions, ElementsAre("bring /localhost/A0.rtc from Inactive to Active"));
  EXPECT_THAT(changes.warnings,
              ElementsAre("component localhost/B0.rtc: is not on the name server; it is left out, as the profile does not "
                          "require it"));
}

TEST_F(SavedSystemTest, a_port_that_is_not_there_does_not_keep_other_changes_from_being_made) {
  system_.connectors.insert(system_.connectors.begin(), saved_connector());
  system_.connectors[0].source.port_name = "A0.wrong";
  const auto changes = plan_load();
  EXPECT_THAT(messages(changes), ElementsAre("connection id1: /localhost/A0.rtc has no port \"wrong\"; it has out"));
  EXPECT_THAT(changes.actions, ElementsAre("connect A0.out to B0.in"));
}

TEST_F(SavedSystemTest, states_are_not_restored_after_a_failure) {
  system_.connectors[0].source.port_name = "A0.wrong";
  EXPECT_THAT(plan_load({.with_states = true}).actions, IsEmpty());
}

TEST_F(SavedSystemTest, a_forbidden_value_is_left_out_unless_it_is_forced) {
  a_.configuration_sets = {{"default", {{"gain", "1"}}}, {"__type__", {{"gain", "int"}}}};
  system_.components[0].configuration_sets = {{"default", {{"gain", "much"}}}};
  system_.connectors.clear();
  const auto refused = plan_load();
  ASSERT_EQ(refused.errors.size(), 1u);
  EXPECT_NE(refused.errors[0].message.find("parameter default.gain cannot be \"much\""), std::string::npos) << refused.errors[0].message;
  EXPECT_THAT(refused.actions, IsEmpty());
  const auto forced = plan_load({.force = true});
  EXPECT_TRUE(forced.ok());
  EXPECT_THAT(forced.actions, ElementsAre("set configuration default of /localhost/A0.rtc"));
}

TEST_F(SavedSystemTest, a_misspelt_parameter_is_a_warning) {
  a_.configuration_sets = {{"default", {{"gain", "1"}}}};
  system_.components[0].configuration_sets = {{"default", {{"gian", "2"}}}};
  const auto changes = plan_load();
  EXPECT_TRUE(changes.ok());
  EXPECT_THAT(changes.warnings, ElementsAre("component /localhost/A0.rtc has no parameter gian (in set default of the profile); "
                                            "parameters: gain"));
}

TEST_F(SavedSystemTest, an_error_state_is_left_by_a_reset_and_cannot_be_restored) {
  a_.contexts.front().state = RTC::ERROR_STATE;
  system_.components[1].contexts.front().state = "Error";
  const auto changes = plan_load({.with_states = true});
  EXPECT_THAT(changes.actions, ElementsAre("connect A0.out to B0.in", "bring /localhost/A0.rtc from Error to Active"));
  EXPECT_THAT(messages(changes), ElementsAre("component /localhost/B0.rtc: state Error cannot be restored, it is Inactive"));
}

TEST_F(SavedSystemTest, connections_that_are_made_come_back_unless_the_file_says_otherwise) {
  auto saved = saved_connector();
  saved.is_data = true;
  EXPECT_EQ(restored_properties(saved)["dataport.reconnect"], "YES");
  EXPECT_FALSE(connect_properties(saved).contains("dataport.reconnect"));
  saved.properties.emplace_back("dataport.reconnect", "NO");
  EXPECT_EQ(restored_properties(saved)["dataport.reconnect"], "NO");
  saved.is_data = false;
  saved.properties.clear();
  EXPECT_FALSE(restored_properties(saved).contains("dataport.reconnect"));
}

TEST_F(SavedSystemTest, components_start_in_the_listed_order_and_the_others_after_them) {
  system_.components.push_back(saved("C0"));
  system_.components.back().is_required = false;
  system_.start_up = {{"A0", "", "", "0", 2}, {"B0", "", "", "0", 1}};
  const Matched all({a_, b_, component_view("C0")}, system_);
  EXPECT_THAT(move_all(session_, all, system_, true, Transition::activate).actions,
              ElementsAre("activate /localhost/B0.rtc in context 0", "activate /localhost/A0.rtc in context 0",
                          "activate /localhost/C0.rtc in context 0"));
}

TEST_F(SavedSystemTest, components_without_a_listed_order_stop_in_the_order_of_the_profile) {
  EXPECT_THAT(plan_move(Transition::deactivate).actions,
              ElementsAre("deactivate /localhost/A0.rtc in context 0", "deactivate /localhost/B0.rtc in context 0"));
}

TEST_F(SavedSystemTest, a_connection_is_removed_at_the_port_that_has_it) {
  b_.ports.front().connectors.emplace_back();
  b_.ports.front().connectors.front().id = "id1";
  EXPECT_THAT(teardown(session_, matched(), system_, true).actions, ElementsAre("disconnect id1 of B0.in"));
}

TEST_F(SavedSystemTest, a_connection_that_no_port_has_is_an_error) {
  const auto changes = teardown(session_, matched(), system_, true);
  EXPECT_THAT(messages(changes), ElementsAre("connection id1: A0.out does not have it"));
}

TEST_F(SavedSystemTest, components_are_activated_with_the_timeout_of_the_session) {
  const Orb orb;
  Served<FakeContext> context;
  auto a = a_;  // ends before the ORB
  a.contexts.front().object = context->_this();
  system_.components.pop_back();
  const Matched one({a}, system_);
  const Session session(orb.get(), "localhost", std::chrono::milliseconds(100), std::chrono::seconds(30));
  const auto changes = move_all(session, one, system_, false, Transition::activate);
  EXPECT_THAT(messages(changes), IsEmpty());
  EXPECT_EQ(context->calls, 1);
}

TEST(SessionTest, a_name_server_is_known_by_its_address_without_slashes) {
  const Session session(CORBA::ORB::_nil(), "/localhost:2809/", std::chrono::milliseconds(100));
  EXPECT_EQ(session.server(), "localhost:2809");
  EXPECT_EQ(session.transition_timeout(), default_transition_timeout);
}

}  // namespace
}  // namespace tools
