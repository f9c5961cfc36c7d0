#include "system/transitions.h"

#include <gtest/gtest.h>

#include "system/fake_components.h"

namespace tools {
namespace {

class TransitionsTest : public testing::Test {
 protected:
  ComponentView component(RTC::LifeCycleState state) {
    auto view = component_view("A0", state);
    view.contexts.front().object = context_->_this();
    return view;
  }

  const Orb orb_;
  Served<FakeContext> context_;
};

TEST_F(TransitionsTest, a_component_in_the_wanted_state_is_not_called) {
  EXPECT_TRUE(change_state(component(RTC::ACTIVE_STATE), Transition::activate, -1));
  EXPECT_EQ(context_->calls, 0);
}

TEST_F(TransitionsTest, a_component_in_another_state_is_not_called_and_the_error_names_both_states) {
  const auto done = change_state(component(RTC::ERROR_STATE), Transition::activate, -1);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "activating /localhost/A0.rtc: is Error, must be Inactive (try: rtse reset)");
  EXPECT_EQ(context_->calls, 0);
}

TEST_F(TransitionsTest, a_context_that_the_component_does_not_have_is_an_error) {
  const auto done = change_state(component(RTC::INACTIVE_STATE), Transition::activate, 3);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "component /localhost/A0.rtc: has no execution context number 3, it has 1");
}

TEST_F(TransitionsTest, a_component_without_context_is_an_error) {
  auto view = component_view("A0");
  view.contexts.clear();
  EXPECT_FALSE(change_state(view, Transition::activate, -1));
}

TEST_F(TransitionsTest, a_transition_that_the_context_gave_up_too_early_is_awaited) {
  context_->answer = RTC::RTC_ERROR;
  context_->looks_until_done = 3;
  EXPECT_TRUE(change_state(component(RTC::INACTIVE_STATE), Transition::activate, -1));
  EXPECT_EQ(context_->calls, 1);
  EXPECT_GT(context_->looks, 3);
}

TEST_F(TransitionsTest, a_refused_transition_is_not_awaited) {
  context_->answer = RTC::PRECONDITION_NOT_MET;
  context_->looks_until_done = 1000;
  const auto done = change_state(component(RTC::INACTIVE_STATE), Transition::activate, -1);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("it is Inactive now"), std::string::npos) << done.error().message;
  EXPECT_EQ(context_->looks, 1);
}

TEST_F(TransitionsTest, a_component_that_ends_in_its_error_state_is_an_error_at_once) {
  context_->answer = RTC::RTC_ERROR;
  context_->after = RTC::ERROR_STATE;
  const auto done = change_state(component(RTC::INACTIVE_STATE), Transition::activate, -1);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("it is Error now"), std::string::npos) << done.error().message;
  EXPECT_EQ(context_->looks, 1);
}

}  // namespace
}  // namespace tools
