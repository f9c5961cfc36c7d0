// Components in this process whose callbacks do not return: what ends, ends in time, and nothing is freed under a running callback.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "component/runtime_access.h"
#include "support/component_fixture.h"
#include "support/hanging.h"

namespace {

using namespace std::chrono_literals;
using support::first_context;
using support::Gate;

// Stands before the gate in the callback that it is told; says when it is freed.
class HangingComponent : public support::ProbeComponent {
 public:
  HangingComponent(const std::string& name, Gate& gate, std::atomic<int>& alive, const std::string& where = "onExecute")
      : support::ProbeComponent(nullptr, name), alive_(alive) {
    ++alive_;
    getProperties()["exec_cxt.callback_timeout"] = "0.05";
    during = [&gate, where](const std::string& callback) {
      if (callback == where) gate.pass();
    };
  }
  ~HangingComponent() override { --alive_; }

 private:
  std::atomic<int>& alive_;
};

bool eventually(const std::function<bool()>& holds) {
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(1ms);
  }
  return true;
}

class HangingCallbackTest : public testing::Test {
 protected:
  ~HangingCallbackTest() override {
    gate.open();
    EXPECT_TRUE(eventually([] { return RTC::RuntimeAccess::destroy_left_contexts(); }));
    EXPECT_TRUE(eventually([&] { return alive == 0; })) << "something is never freed";
  }
  HangingComponent* make(const std::string& name, const std::string& where = "onExecute") {
    return new HangingComponent(name, gate, alive, where);
  }
  // Returns when the guest, a new member of the context, stands in its callback.
  void hang_in(RTC::ExecutionContext_ptr context, HangingComponent& guest) {
    ASSERT_EQ(guest.initialize(), RTC::RTC_OK);
    const RTC::RTObject_var reference = guest.getObjRef();
    ASSERT_EQ(context->add_component(reference), RTC::RTC_OK);
    guest.activate(1000);
    ASSERT_TRUE(gate.wait_for_visitors());
  }

  std::atomic<int> alive{0};
  Gate gate;
  support::Lines lines;
};

TEST_F(HangingCallbackTest, a_component_that_hangs_in_its_own_context_is_not_freed_before_it_returns) {
  HangingComponent* hanging = make("Own0");
  ASSERT_EQ(hanging->initialize(), RTC::RTC_OK);
  hanging->activate(0);
  ASSERT_TRUE(gate.wait_for_visitors());
  EXPECT_EQ(hanging->exit(), RTC::RTC_OK);
  EXPECT_TRUE(RTC::RuntimeAccess::is_held_by_callback(*hanging));
  EXPECT_TRUE(lines.speak_of("Own0", "onExecute"));
  EXPECT_EQ(hanging->count("onFinalize"), 0) << "no callback beside the one that runs";
  EXPECT_EQ(hanging->count("onShutdown"), 0);
  EXPECT_FALSE(RTC::RuntimeAccess::destroy_left_contexts());
  hanging->_remove_ref();  // what a factory does
  EXPECT_EQ(alive, 1);
  gate.open();
  EXPECT_TRUE(eventually([] { return RTC::RuntimeAccess::destroy_left_contexts(); }));
  EXPECT_TRUE(eventually([&] { return alive == 0; }));
}

TEST_F(HangingCallbackTest, a_component_that_hangs_in_the_context_of_another_is_not_freed_before_it_returns) {
  support::Owned<> host(nullptr, "Host0");
  host->getProperties()["exec_cxt.callback_timeout"] = "0.05";
  ASSERT_EQ(host->initialize(), RTC::RTC_OK);
  ASSERT_EQ(host->activate(0), RTC::RTC_OK);
  HangingComponent* guest = make("Guest0");
  RTC::ExecutionContext_var context = first_context(*host);
  ASSERT_NO_FATAL_FAILURE(hang_in(context, *guest));
  EXPECT_EQ(guest->exit(), RTC::RTC_OK);
  EXPECT_TRUE(RTC::RuntimeAccess::is_held_by_callback(*guest));
  EXPECT_TRUE(lines.speak_of("Guest0", "onExecute"));
  EXPECT_EQ(context->get_component_state(RTC::RTObject_var(guest->getObjRef())), RTC::CREATED_STATE) << "it has left";
  guest->_remove_ref();
  EXPECT_EQ(alive, 1);
  const int seen = host->count("onExecute");
  gate.open();
  EXPECT_TRUE(host->wait_for("onExecute", seen + 3)) << "the host goes on";
  EXPECT_TRUE(eventually([&] { return alive == 0; }));
}

TEST_F(HangingCallbackTest, remove_component_ends_in_time_and_frees_nothing) {
  support::Owned<> host(nullptr, "Host1");
  host->getProperties()["exec_cxt.callback_timeout"] = "0.05";
  ASSERT_EQ(host->initialize(), RTC::RTC_OK);
  HangingComponent* guest = make("Guest1");
  RTC::ExecutionContext_var context = first_context(*host);
  ASSERT_NO_FATAL_FAILURE(hang_in(context, *guest));
  const RTC::RTObject_var reference = guest->getObjRef();
  EXPECT_EQ(context->remove_component(reference), RTC::RTC_OK);
  EXPECT_EQ(context->remove_component(reference), RTC::BAD_PARAMETER);
  EXPECT_TRUE(lines.speak_of("Guest1", "onExecute"));
  EXPECT_TRUE(RTC::RuntimeAccess::is_held_by_callback(*guest));
  EXPECT_EQ(guest->get_context_handle(context), -1);
  EXPECT_EQ(guest->exit(), RTC::RTC_OK);
  EXPECT_TRUE(RTC::RuntimeAccess::is_held_by_callback(*guest));
  guest->_remove_ref();
  EXPECT_EQ(alive, 1);
}

TEST_F(HangingCallbackTest, the_owner_of_a_context_in_which_another_hangs_is_freed_and_the_context_later) {
  HangingComponent* host = make("Host2", "nowhere");
  ASSERT_EQ(host->initialize(), RTC::RTC_OK);
  ASSERT_EQ(host->activate(0), RTC::RTC_OK);
  HangingComponent* guest = make("Guest2");
  RTC::ExecutionContext_var context = first_context(*host);
  ASSERT_NO_FATAL_FAILURE(hang_in(context, *guest));
  EXPECT_EQ(host->exit(), RTC::RTC_OK);
  EXPECT_FALSE(RTC::RuntimeAccess::is_held_by_callback(*host));
  EXPECT_EQ(host->count("onFinalize"), 1);
  host->_remove_ref();
  EXPECT_TRUE(eventually([&] { return alive == 1; })) << "the host is freed although the thread is stuck in its guest";
  EXPECT_FALSE(RTC::RuntimeAccess::destroy_left_contexts());
  EXPECT_EQ(guest->get_context_handle(context), -1) << "the context has let it go";
  EXPECT_EQ(guest->exit(), RTC::RTC_OK);
  guest->_remove_ref();
  EXPECT_EQ(alive, 1);
}

TEST_F(HangingCallbackTest, owners_of_one_context_end_one_after_the_other) {
  HangingComponent* one = make("Owner0");
  HangingComponent* two = make("Owner1", "nowhere");
  for (HangingComponent* owner : {one, two}) {
    owner->getProperties()["execution_contexts"] = "PeriodicExecutionContext(shared_by_hanging)";
    ASSERT_EQ(owner->initialize(), RTC::RTC_OK);
  }
  ASSERT_EQ(two->activate(0), RTC::RTC_OK);
  one->activate(0);
  ASSERT_TRUE(gate.wait_for_visitors());
  EXPECT_EQ(one->exit(), RTC::RTC_OK);
  EXPECT_TRUE(RTC::RuntimeAccess::is_held_by_callback(*one));
  one->_remove_ref();
  EXPECT_EQ(two->exit(), RTC::RTC_OK);
  EXPECT_FALSE(RTC::RuntimeAccess::is_held_by_callback(*two));
  two->_remove_ref();
  EXPECT_TRUE(eventually([&] { return alive == 1; }));
}

TEST_F(HangingCallbackTest, stop_says_who_hangs_and_the_context_runs_on_when_it_returns) {
  HangingComponent* hanging = make("Stop0");
  ASSERT_EQ(hanging->initialize(), RTC::RTC_OK);
  hanging->activate(0);
  ASSERT_TRUE(gate.wait_for_visitors());
  RTC::ExecutionContext_var context = first_context(*hanging);
  EXPECT_EQ(context->stop(), RTC::RTC_ERROR);
  EXPECT_TRUE(lines.speak_of("Stop0", "onExecute"));
  EXPECT_TRUE(context->is_running());
  gate.open();
  EXPECT_TRUE(hanging->wait_for("onExecute", 3));
  EXPECT_EQ(context->stop(), RTC::RTC_OK);
  EXPECT_EQ(hanging->exit(), RTC::RTC_OK);
  hanging->_remove_ref();
}

// The second member begins to hang while the context is being stopped in the first.
TEST_F(HangingCallbackTest, a_context_that_stops_begins_no_callback_any_more) {
  Gate first_gate;
  std::atomic<bool> is_stopping{false};
  support::Owned<> host(nullptr, "Host3");
  host->getProperties()["exec_cxt.callback_timeout"] = "60";
  ASSERT_EQ(host->initialize(), RTC::RTC_OK);
  HangingComponent* guest = make("Guest3", "nowhere");
  guest->during = [&](const std::string& callback) {
    if (callback == "onExecute" && is_stopping) gate.pass();
  };
  ASSERT_EQ(guest->initialize(), RTC::RTC_OK);
  RTC::ExecutionContext_var context = first_context(*host);
  RTC::RTObject_var reference = guest->getObjRef();
  ASSERT_EQ(context->add_component(reference), RTC::RTC_OK);
  ASSERT_EQ(guest->activate(1000), RTC::RTC_OK);
  host->during = [&](const std::string& callback) {
    if (callback == "onExecute") first_gate.pass();
  };
  host->activate(0);
  ASSERT_TRUE(first_gate.wait_for_visitors());
  is_stopping = true;
  std::jthread stopper([&] { EXPECT_EQ(RTC::ExecutionContext_var(first_context(*host))->stop(), RTC::RTC_OK); });
  std::this_thread::sleep_for(20ms);  // the stop is under way; too short a time makes the test weaker, never wrong
  first_gate.open();
  stopper.join();
  EXPECT_FALSE(context->is_running());
  host->during = nullptr;
  EXPECT_EQ(guest->exit(), RTC::RTC_OK);
  guest->_remove_ref();
}

TEST_F(HangingCallbackTest, several_that_hang_cost_no_more_than_one) {
  constexpr int count = 8;
  std::vector<HangingComponent*> all;
  for (int i = 0; i < count; ++i) {
    all.push_back(make("Many" + std::to_string(i)));
    ASSERT_EQ(all.back()->initialize(), RTC::RTC_OK);
    all.back()->activate(0);
  }
  ASSERT_TRUE(gate.wait_for_visitors(count));
  // Each of them has been waited for once; nobody waits for the same callback again.
  for (HangingComponent* one : all) EXPECT_EQ(RTC::RuntimeAccess::exit_by(*one, std::chrono::steady_clock::now()), RTC::RTC_OK);
  for (int i = 0; i < count; ++i) {
    EXPECT_TRUE(RTC::RuntimeAccess::is_held_by_callback(*all[static_cast<std::size_t>(i)]));
    EXPECT_TRUE(lines.speak_of("Many" + std::to_string(i), "onExecute"));
    all[static_cast<std::size_t>(i)]->_remove_ref();
  }
  EXPECT_EQ(alive, count);
}

TEST_F(HangingCallbackTest, a_callback_that_others_call_holds_the_component_too) {
  HangingComponent* hanging = make("Called0", "onRateChanged");
  ASSERT_EQ(hanging->initialize(), RTC::RTC_OK);
  std::jthread caller([&] { RTC::ExecutionContext_var(first_context(*hanging))->set_rate(10); });
  ASSERT_TRUE(gate.wait_for_visitors());
  EXPECT_EQ(hanging->exit(), RTC::RTC_OK);
  EXPECT_TRUE(RTC::RuntimeAccess::is_held_by_callback(*hanging));
  EXPECT_TRUE(lines.speak_of("Called0", "onRateChanged"));
  gate.open();
  caller.join();
  EXPECT_FALSE(RTC::RuntimeAccess::is_held_by_callback(*hanging));
  hanging->_remove_ref();
}

TEST_F(HangingCallbackTest, start_and_stop_from_many_threads_leave_the_context_whole) {
  support::Owned<> probe(nullptr, "StartStop0");
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  {
    std::vector<std::jthread> callers;
    for (int i = 0; i < 4; ++i)
      callers.emplace_back([&] {
        const RTC::ExecutionContext_var context = first_context(*probe);
        for (int k = 0; k < 50; ++k) {
          RTC::ExecutionContext_var(context)->stop();
          RTC::ExecutionContext_var(context)->start();
        }
      });
  }
  RTC::ExecutionContext_var context = first_context(*probe);
  context->start();
  EXPECT_TRUE(context->is_running());
  EXPECT_EQ(probe->count("onStartup"), probe->count("onShutdown") + 1);
  EXPECT_TRUE(probe->wait_for("onExecute", probe->count("onExecute") + 3));
}

}  // namespace
