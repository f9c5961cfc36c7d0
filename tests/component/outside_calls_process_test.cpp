// Callbacks of a component of another process, called over the wire by programs that are none of its contexts.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <thread>

#include "support/component_process_fixture.h"

namespace {

using namespace std::chrono_literals;
using support::ComponentProcessTest;
using support::first_context;
using support::Owned;

// Callbacks called over the wire, by the test instead of an execution context of its own. component_peer prints what must not happen.
class OutsideCallsTest : public ComponentProcessTest {
 public:
  OutsideCallsTest() {
    host->initialize();
    foreign = first_context(*host);
  }
  ~OutsideCallsTest() override {
    const std::string output = peer.process().output();
    EXPECT_EQ(output.find("overlap "), std::string::npos) << output;
    EXPECT_EQ(output.find("late "), std::string::npos) << output;
  }

 protected:
  using Operation = std::function<RTC::ReturnCode_t(CORBA::Long)>;
  std::vector<std::pair<std::string, Operation>> operations() {
    auto* target = component.in();
    return {{"on_startup", [=](CORBA::Long handle) { return target->on_startup(handle); }},
            {"on_shutdown", [=](CORBA::Long handle) { return target->on_shutdown(handle); }},
            {"on_activated", [=](CORBA::Long handle) { return target->on_activated(handle); }},
            {"on_deactivated", [=](CORBA::Long handle) { return target->on_deactivated(handle); }},
            {"on_aborting", [=](CORBA::Long handle) { return target->on_aborting(handle); }},
            {"on_error", [=](CORBA::Long handle) { return target->on_error(handle); }},
            {"on_reset", [=](CORBA::Long handle) { return target->on_reset(handle); }},
            {"on_execute", [this](CORBA::Long handle) { return flow()->on_execute(handle); }},
            {"on_state_update", [this](CORBA::Long handle) { return flow()->on_state_update(handle); }},
            {"on_rate_changed", [this](CORBA::Long handle) { return flow()->on_rate_changed(handle); }}};
  }
  // On each call its own reference: one may be used by several threads.
  RTC::DataFlowComponentAction_var flow() { return RTC::DataFlowComponentAction::_narrow(component); }
  void set(const char* key, const char* callbacks) {
    SDOPackage::ConfigurationSet set;
    set.id = "default";
    set.configuration_data.length(1);
    set.configuration_data[0].name = key;
    set.configuration_data[0].value <<= callbacks;
    configuration->set_configuration_set_values(set);
    configuration->activate_configuration_set("default");
  }
  bool is_printed(const std::string& text) { return peer.process().wait_for_output(text); }

  Owned<> host{nullptr, "Host0"};
  RTC::ExecutionContext_var foreign;
};

TEST_F(OutsideCallsTest, handles_that_no_context_of_another_process_has_are_refused) {
  for (const CORBA::Long handle :
       {-1, 0, 1, 999, 1000, 1001, std::numeric_limits<CORBA::Long>::max(), std::numeric_limits<CORBA::Long>::min()})
    for (const auto& [name, call] : operations()) EXPECT_EQ(call(handle), RTC::PRECONDITION_NOT_MET) << name << " " << handle;
  expect_unchanged();
}

TEST_F(OutsideCallsTest, what_the_runtime_calls_once_in_a_life_is_refused_however_often_it_is_asked_for) {
  const std::size_t before = peer.process().output().size();
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(component->on_initialize(), RTC::PRECONDITION_NOT_MET);
    ASSERT_EQ(component->on_finalize(), RTC::PRECONDITION_NOT_MET);
    ASSERT_EQ(component->initialize(), RTC::PRECONDITION_NOT_MET);
    ASSERT_EQ(component->finalize(), RTC::PRECONDITION_NOT_MET);
  }
  expect_unchanged();
  EXPECT_LT(peer.process().output().size() - before, 100000u) << "8000 calls leave few lines in the log";
}

TEST_F(OutsideCallsTest, a_context_of_another_process_calls_what_its_state_of_the_component_allows) {
  const CORBA::Long handle = component->attach_context(foreign);
  ASSERT_GE(handle, 1000);
  const auto refused = RTC::PRECONDITION_NOT_MET;
  EXPECT_EQ(component->on_startup(handle), RTC::RTC_OK);
  EXPECT_EQ(flow()->on_execute(handle), refused) << "not active yet";
  EXPECT_EQ(flow()->on_state_update(handle), refused);
  EXPECT_EQ(component->on_deactivated(handle), refused);
  EXPECT_EQ(component->on_activated(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_activated(handle), refused) << "active already";
  EXPECT_EQ(component->on_error(handle), refused);
  EXPECT_EQ(flow()->on_execute(handle), RTC::RTC_OK);
  EXPECT_EQ(flow()->on_state_update(handle), RTC::RTC_OK);
  EXPECT_EQ(flow()->on_rate_changed(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_deactivated(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_aborting(handle), RTC::RTC_OK) << "what contexts call after a failure";
  EXPECT_EQ(component->on_error(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_reset(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_activated(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_aborting(handle), RTC::RTC_OK) << "some leave out on_deactivated";
  EXPECT_EQ(flow()->on_execute(handle), refused);
  EXPECT_EQ(component->on_reset(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_shutdown(handle), RTC::RTC_OK);
  EXPECT_EQ(component->attach_context(foreign), handle) << "the same one again";
  EXPECT_EQ(component->detach_context(handle), RTC::RTC_OK);
  for (const auto& [name, call] : operations()) EXPECT_EQ(call(handle), refused) << name;
}

TEST_F(OutsideCallsTest, nobody_outside_calls_with_the_handle_of_a_context_of_the_components_own_process) {
  const CORBA::Long handle = component->attach_context(context);
  ASSERT_GE(handle, 1000);
  for (const auto& [name, call] : operations()) EXPECT_EQ(call(handle), RTC::PRECONDITION_NOT_MET) << name;
  EXPECT_EQ(component->detach_context(handle), RTC::RTC_OK);
}

TEST_F(OutsideCallsTest, callbacks_that_eight_connections_call_never_overlap) {
  ASSERT_EQ(context->set_rate(1000), RTC::RTC_OK);
  ASSERT_EQ(context->activate_component(component), RTC::RTC_OK);
  const CORBA::Long handle = component->attach_context(foreign);
  ASSERT_EQ(component->on_activated(handle), RTC::RTC_OK);
  std::atomic<int> carried_out{0}, others{0};
  {
    std::vector<std::jthread> callers;
    for (int i = 0; i < 8; ++i)
      callers.emplace_back([&] {
        for (int n = 0; n < 200; ++n) {
          for (const auto code : {flow()->on_execute(handle), flow()->on_state_update(handle), flow()->on_rate_changed(handle)}) {
            if (code == RTC::RTC_OK) ++carried_out;
            if (code != RTC::RTC_OK && code != RTC::PRECONDITION_NOT_MET) ++others;
          }
        }
      });
  }
  EXPECT_GT(carried_out, 1000);
  EXPECT_EQ(others, 0);
  EXPECT_EQ(component->on_deactivated(handle), RTC::RTC_OK);
  EXPECT_EQ(context->get_component_state(component), RTC::ACTIVE_STATE) << "in its own context";
}

TEST_F(OutsideCallsTest, who_comes_while_a_callback_runs_waits_a_while_and_is_answered) {
  const CORBA::Long handle = component->attach_context(foreign);
  ASSERT_EQ(component->on_activated(handle), RTC::RTC_OK);
  set("held", "onExecute");
  std::jthread caller([&] { EXPECT_EQ(flow()->on_execute(handle), RTC::RTC_OK); });
  ASSERT_TRUE(is_printed("held onExecute"));
  EXPECT_EQ(flow()->on_rate_changed(handle), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(component->on_deactivated(handle), RTC::PRECONDITION_NOT_MET);
  set("held", "");
  caller.join();
  EXPECT_EQ(component->on_deactivated(handle), RTC::RTC_OK);
}

// onExecute calls the context, which calls the component back before it answers.
TEST_F(OutsideCallsTest, a_call_that_comes_back_into_the_component_ends_and_so_does_the_callback) {
  ASSERT_EQ(foreign->add_component(component), RTC::RTC_OK);
  ASSERT_EQ(foreign->activate_component(component), RTC::RTC_OK);
  const double before = foreign->get_rate();
  set("asking", "onExecute");
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (foreign->get_rate() < before + 2 && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(1ms);
  EXPECT_GE(foreign->get_rate(), before + 2) << "it goes on";
  set("asking", "");
  EXPECT_EQ(foreign->get_component_state(component), RTC::ACTIVE_STATE);
  EXPECT_EQ(foreign->remove_component(component), RTC::RTC_OK);
}

TEST_F(OutsideCallsTest, a_component_ends_once_whatever_is_called_meanwhile) {
  const CORBA::Long handle = component->attach_context(foreign);
  ASSERT_EQ(component->on_activated(handle), RTC::RTC_OK);
  std::atomic<int> ended{0}, others{0};
  {
    std::vector<std::jthread> callers;
    for (int i = 0; i < 8; ++i)
      callers.emplace_back([&, i] {
        try {
          for (int n = 0; n < 100; ++n) {
            for (const auto code : {component->initialize(), component->finalize(), component->on_finalize(), component->on_initialize()})
              if (code != RTC::PRECONDITION_NOT_MET) ++others;
            flow()->on_execute(handle);
            if (n == 10 + i && component->exit() == RTC::RTC_OK) ++ended;
          }
        } catch (const CORBA::SystemException&) {
          // The object is gone.
        }
      });
  }
  EXPECT_EQ(ended, 1);
  EXPECT_EQ(others, 0);
}

}  // namespace
