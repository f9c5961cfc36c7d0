// The callbacks of one component, called by several contexts of this process; over the wire: component_process_test.
#include <gtest/gtest.h>
#include <rtm/InPort.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <atomic>
#include <thread>

#include "support/component_fixture.h"
#include "support/hanging.h"

namespace {

using namespace std::chrono_literals;
using support::Gate;
using support::Owned;

// Two contexts of its own.
class TwoContexts : public support::ProbeComponent {
 public:
  TwoContexts() : support::ProbeComponent(nullptr, "Two0") {
    getProperties()["execution_contexts"] = "PeriodicExecutionContext(), PeriodicExecutionContext()";
    getProperties()["exec_cxt.periodic.rate"] = "1000";
  }
};

class TurnsTest : public testing::Test {
 protected:
  static RTC::LifeCycleState state(RTC::RTObject_impl& component, RTC::UniqueId handle) {
    const RTC::ExecutionContext_var context = component.getExecutionContext(handle);
    return RTC::ExecutionContext_var(context)->get_component_state(RTC::RTObject_var(component.getObjRef()));
  }
  static bool eventually(const std::function<bool()>& holds) {
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    while (!holds()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(1ms);
    }
    return true;
  }
  support::Lines lines;
};

TEST_F(TurnsTest, callbacks_that_two_contexts_call_never_overlap) {
  Owned<TwoContexts> probe;
  std::atomic<int> inside{0}, overlaps{0};
  int not_guarded = 0;  // the sanitizer sees two threads
  probe->during = [&](const std::string&) {
    if (++inside != 1) ++overlaps;
    ++not_guarded;
    std::this_thread::yield();
    --inside;
  };
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(1), RTC::RTC_OK);
  EXPECT_TRUE(probe->wait_for("onExecute", 500));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(probe->setExecutionRate(i % 2, 1000 + i), RTC::RTC_OK) << "from a third thread";
  EXPECT_EQ(probe->deactivate(0), RTC::RTC_OK);
  EXPECT_EQ(probe->deactivate(1), RTC::RTC_OK);
  EXPECT_EQ(overlaps, 0);
}

TEST_F(TurnsTest, a_callback_that_hangs_fails_the_component_in_its_other_context_in_time) {
  Gate gate;
  auto* probe = new TwoContexts;
  probe->getProperties()["exec_cxt.callback_timeout"] = "0.05";
  std::atomic<bool> hangs{false};
  probe->during = [&](const std::string& callback) {
    if (callback == "onStartup" && hangs.exchange(false)) gate.pass();
  };
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(1), RTC::RTC_OK);
  hangs = true;
  std::jthread caller([&] { probe->on_startup(0); });
  ASSERT_TRUE(gate.wait_for_visitors());
  EXPECT_TRUE(eventually([&] { return state(*probe, 1) == RTC::ERROR_STATE; }));
  EXPECT_TRUE(lines.speak_of("Two0", "onExecute was not called: onStartup has run for") ||
              lines.speak_of("Two0", "onStateUpdate was not called: onStartup has run for"));
  gate.open();
  caller.join();
  EXPECT_TRUE(eventually([&] { return probe->reset(1) == RTC::RTC_OK; })) << "and it goes on when that returns";
  EXPECT_EQ(probe->activate(1), RTC::RTC_OK);
  probe->exit();
  probe->_remove_ref();
}

TEST_F(TurnsTest, a_callback_does_not_wait_for_another_context_of_its_component) {
  Owned<TwoContexts> probe;
  std::atomic<int> answers{0};
  std::atomic<int> code{-1};
  probe->during = [&](const std::string& callback) {
    if (callback != "onExecute" || answers.exchange(1) != 0) return;
    code = probe->activate(1);  // that context calls the component when this callback has returned
  };
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  EXPECT_TRUE(eventually([&] { return code == RTC::RTC_OK && state(*probe, 1) == RTC::ACTIVE_STATE; })) << code;
}

TEST_F(TurnsTest, a_callback_that_makes_its_context_call_the_component_is_called_at_once) {
  Owned<> probe;
  std::atomic<int> within{-1};
  probe->during = [&](const std::string& callback) {
    if (callback != "onExecute" || within >= 0) return;
    const int before = probe->count("onRateChanged");
    probe->setExecutionRate(0, 500);
    within = probe->count("onRateChanged") - before;
  };
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  EXPECT_TRUE(eventually([&] { return within == 1; }));
}

struct Counter : RTC::PostComponentActionListener {
  explicit Counter(std::atomic<int>& calls) : calls(calls) {}
  void operator()(RTC::UniqueId, RTC::ReturnCode_t) override { ++calls; }
  std::atomic<int>& calls;
};
struct SetCounter : RTC::ConfigurationSetNameListener {
  explicit SetCounter(std::atomic<int>& inside, std::atomic<int>& overlaps) : inside(inside), overlaps(overlaps) {}
  void operator()(const char*) override {
    if (++inside != 1) ++overlaps;
    std::this_thread::yield();
    --inside;
  }
  std::atomic<int>&inside, &overlaps;
};

TEST_F(TurnsTest, listeners_come_and_go_while_the_component_runs) {
  std::atomic<int> calls{0};
  Owned<TwoContexts> probe;
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(1), RTC::RTC_OK);
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i)
      threads.emplace_back([&] {
        for (int n = 0; n < 300; ++n) {
          auto* listener = new Counter(calls);
          probe->addPostComponentActionListener(RTC::POST_ON_EXECUTE, listener);
          std::this_thread::yield();
          probe->removePostComponentActionListener(RTC::POST_ON_EXECUTE, listener);
        }
      });
  }
  probe->addPostComponentActionListener(RTC::POST_ON_EXECUTE, new Counter(calls));
  const int before = calls;
  EXPECT_TRUE(eventually([&] { return calls > before; }));
}

TEST_F(TurnsTest, ports_come_and_go_while_the_component_runs_and_tools_look_at_it) {
  RTC::TimedLong value{};
  RTC::InPort<RTC::TimedLong> port("passing", value);
  Owned<TwoContexts> probe;
  std::atomic<int> times{0};
  probe->during = [&](const std::string& callback) {
    if (callback != "onExecute") return;
    if (times++ % 2 == 0)
      probe->addInPort("passing", port);
    else
      probe->removeInPort(port);
  };
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(1), RTC::RTC_OK);
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i)
      threads.emplace_back([&] {
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (times < 200 && std::chrono::steady_clock::now() < deadline) {
          const RTC::ComponentProfile_var profile = probe->get_component_profile();
          RTC::PortServiceList_var ports = probe->get_ports();
          try {
            if (ports->length() == 1)
              RTC::PortProfile_var(RTC::PortService_var(RTC::PortService::_duplicate(ports[0u]))->get_port_profile());
          } catch (const CORBA::Exception&) {
            // It has gone meanwhile.
          }
        }
      });
  }
  probe->deactivate(0);
  probe->deactivate(1);
  EXPECT_GE(times, 200);
  probe->removeInPort(port);
}

// By the interface of tools: what is set by eight at once is heard of one by one.
TEST_F(TurnsTest, listeners_of_configuration_sets_are_called_one_at_a_time) {
  std::atomic<int> inside{0}, overlaps{0};
  Owned<> probe;
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  probe->addConfigurationSetNameListener(RTC::ON_ACTIVATE_CONFIG_SET, new SetCounter(inside, overlaps));
  const SDOPackage::Configuration_var configuration = probe->get_configuration();
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i)
      threads.emplace_back([&, i] {
        for (int n = 0; n < 100; ++n)
          SDOPackage::Configuration_var(configuration)->activate_configuration_set((i + n) % 2 ? "default" : "fast");
      });
  }
  EXPECT_EQ(overlaps, 0);
}

}  // namespace
