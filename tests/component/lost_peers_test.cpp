// Members and contexts of other processes that are killed, or hang: what that costs the components of this process.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "support/component_process_fixture.h"

namespace {

using namespace std::chrono_literals;
using support::ComponentTest;
using support::first_context;
using support::Owned;
using support::PeerProcess;

TEST_F(ComponentTest, a_member_of_another_process_that_is_killed_costs_the_others_nothing) {
  probe->initialize();
  PeerProcess peer;
  const RTC::ExecutionContext_var context = first_context(*probe);
  const RTC::RTObject_var self = probe->getObjRef();
  const RTC::ExecutionContext_var own = context;
  ASSERT_EQ(RTC::ExecutionContext_var(own)->add_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(RTC::ExecutionContext_var(own)->activate_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onExecute", 3));
  peer.process().kill();
  const int seen = probe->count("onExecute");
  EXPECT_TRUE(probe->wait_for("onExecute", seen + 50));
  EXPECT_EQ(RTC::ExecutionContext_var(own)->remove_component(peer.component), RTC::RTC_OK);
  EXPECT_EQ(state(), RTC::ACTIVE_STATE);
  EXPECT_EQ(probe->deactivate(0), RTC::RTC_OK);
}

TEST_F(ComponentTest, what_remains_of_a_killed_owner_is_forgotten_at_exit) {
  probe->initialize();
  PeerProcess peer;
  RTC::ExecutionContextList_var contexts = peer.component->get_owned_contexts();
  const RTC::RTObject_var self = probe->getObjRef();
  ASSERT_EQ(contexts[0u]->add_component(self), RTC::RTC_OK);
  ASSERT_EQ(contexts[0u]->activate_component(self), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onExecute", 3));
  peer.process().kill();
  EXPECT_EQ(probe->exit(), RTC::RTC_OK);
}

// Stopped, so that its connections stay open and nobody answers.
void freeze(support::Process& process) {
  process.signal(SIGSTOP);
  const auto is_stopped = [&] {
    std::ifstream file("/proc/" + std::to_string(process.pid()) + "/stat");
    std::string text;
    std::getline(file, text);
    return text.find(") T ") != std::string::npos;
  };
  while (!is_stopped()) std::this_thread::sleep_for(1ms);
}

TEST_F(ComponentTest, a_member_of_another_process_that_hangs_costs_the_others_one_time_out_at_most) {
  probe->initialize();
  Owned<> neighbour(nullptr, "Neighbour0");  // has a context of its own
  neighbour->initialize();
  PeerProcess peer;
  const RTC::ExecutionContext_var context = first_context(*probe);
  const auto of_probe = [&] { return RTC::ExecutionContextService::_narrow(context); };
  ASSERT_EQ(RTC::ExecutionContextService_var(of_probe())->add_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(RTC::ExecutionContextService_var(of_probe())->activate_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  ASSERT_EQ(neighbour->activate(0), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onExecute", 3));
  freeze(peer.process());
  // Whoever is in another context, and tools, notice nothing; the context itself goes on after a time-out of the call, and only one.
  const int seen = neighbour->count("onExecute");
  for (int i = 0; i < 20; ++i) {
    RTC::ExecutionContextService_var service = of_probe();
    const RTC::ExecutionContextProfile_var profile = service->get_profile();
    EXPECT_EQ(profile->participants.length(), 1u);
    const RTC::RTObject_var self = probe->getObjRef();
    EXPECT_EQ(service->get_component_state(self), RTC::ACTIVE_STATE);
    EXPECT_TRUE(neighbour->wait_for("onExecute", seen + i));
  }
  const int before = probe->count("onExecute");
  EXPECT_TRUE(probe->wait_for("onExecute", before + 50));
  RTC::ExecutionContextService_var service = of_probe();
  while (service->get_component_state(peer.component) != RTC::ERROR_STATE) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(probe->deactivate(0), RTC::RTC_OK);
  EXPECT_EQ(service->remove_component(peer.component), RTC::RTC_OK);
  peer.process().signal(SIGCONT);
}

// On a busy machine, in lock step: the run waits, and goes on as if nothing had been.
TEST_F(ComponentTest, a_member_of_another_process_is_waited_for_as_long_as_the_context_says) {
  probe->getProperties()["exec_cxt.member_timeout"] = "60";
  probe->initialize();
  PeerProcess peer;
  const RTC::ExecutionContext_var context = first_context(*probe);
  const RTC::ExecutionContextService_var service = RTC::ExecutionContextService::_narrow(context);
  ASSERT_EQ(service->add_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(service->activate_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onExecute", 3));
  freeze(peer.process());
  std::this_thread::sleep_for(1500ms);  // longer than it has by default
  const int before = probe->count("onExecute");
  peer.process().signal(SIGCONT);
  EXPECT_TRUE(probe->wait_for("onExecute", before + 10));
  EXPECT_EQ(service->get_component_state(peer.component), RTC::ACTIVE_STATE);
  EXPECT_EQ(probe->deactivate(0), RTC::RTC_OK);
  EXPECT_EQ(service->remove_component(peer.component), RTC::RTC_OK);
}

TEST_F(ComponentTest, a_context_of_another_process_that_hangs_does_not_keep_a_component_from_leaving) {
  probe->getProperties()["exec_cxt.callback_timeout"] = "0.2";
  probe->initialize();
  PeerProcess peer;
  RTC::ExecutionContextList_var contexts = peer.component->get_owned_contexts();
  const RTC::RTObject_var self = probe->getObjRef();
  ASSERT_EQ(contexts[0u]->add_component(self), RTC::RTC_OK);
  ASSERT_EQ(contexts[0u]->activate_component(self), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onExecute", 3));
  freeze(peer.process());
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(probe->exit(), RTC::RTC_OK);
  EXPECT_LT(std::chrono::steady_clock::now() - began, 5s) << "half of the time-out of other calls";
  EXPECT_EQ(probe->count("onFinalize"), 1);
  peer.process().signal(SIGCONT);
}

}  // namespace
