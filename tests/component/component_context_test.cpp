// The execution contexts of components in this process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rtm/ECFactory.h>
#include <rtm/ExecutionContextServant.h>
#include <rtm/idl/LogicalTimeTriggeredECSkel.h>
#include <rtm/idl/OpenRTMSkel.h>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>

#include "base/clock.h"
#include "component/context_clock.h"
#include "component/runtime_access.h"
#include "support/component_fixture.h"
#include "support/silence.h"

namespace {

using namespace std::chrono_literals;
using support::ComponentTest;
using support::first_context;
using support::Owned;

using ComponentContextTest = ComponentTest;

TEST_F(ComponentContextTest, has_the_contexts_that_its_properties_name) {
  probe->getProperties()["execution_contexts"] = "PeriodicExecutionContext(fast), ExtTrigExecutionContext(hand)";
  probe->getProperties()["ec.PeriodicExecutionContext.rate"] = "10";
  probe->getProperties()["ec.fast.rate"] = "250";
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  RTC::ExecutionContextList_var contexts = probe->get_owned_contexts();
  ASSERT_EQ(contexts->length(), 2u);
  EXPECT_EQ(contexts[0u]->get_rate(), 250);
  EXPECT_EQ(probe->get_context_handle(contexts[1u]), 1);
  EXPECT_TRUE(probe->is_alive(contexts[1u]));
  OpenRTM::ExtTrigExecutionContextService_var trigger = OpenRTM::ExtTrigExecutionContextService::_narrow(contexts[1u]);
  ASSERT_FALSE(CORBA::is_nil(trigger));
  ASSERT_EQ(probe->activate(1), RTC::RTC_OK);
  for (int i = 0; i < 100; ++i) trigger->tick();
  EXPECT_TRUE(probe->wait_for("onStateUpdate", 100));
  EXPECT_EQ(probe->count("onExecute"), 100);
}

TEST_F(ComponentContextTest, components_share_a_context_of_the_same_type_and_name) {
  Owned<> a(nullptr, "SharedA"), b(nullptr, "SharedB");
  for (auto* one : {&*a, &*b}) {
    one->getProperties()["execution_contexts"] = "PeriodicExecutionContext(together)";
    ASSERT_EQ(one->initialize(), RTC::RTC_OK);
  }
  RTC::ExecutionContext_var of_a = first_context(*a);
  RTC::ExecutionContext_var of_b = first_context(*b);
  EXPECT_TRUE(of_a->_is_equivalent(of_b));
  EXPECT_EQ(b->activate(0), RTC::RTC_OK);
  EXPECT_EQ(a->exit(), RTC::RTC_OK);
  EXPECT_TRUE(of_b->is_running());
  EXPECT_TRUE(b->wait_for("onExecute", b->count("onExecute") + 2));
}

TEST_F(ComponentContextTest, has_no_more_contexts_of_its_own_than_there_may_be_threads) {
  const auto initialize_with = [](std::size_t count) {
    std::string list = "ExtTrigExecutionContext";
    for (std::size_t n = 1; n < count; ++n) list += ",ExtTrigExecutionContext";
    Owned<> component(nullptr, "Many");
    component->getProperties()["execution_contexts"] = list;
    return component->initialize();
  };
  EXPECT_EQ(initialize_with(64), RTC::RTC_OK);
  EXPECT_EQ(initialize_with(65), RTC::RTC_ERROR);
}

TEST_F(ComponentContextTest, may_have_none) {
  probe->getProperties()["execution_contexts"] = "none";
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  RTC::ExecutionContextList_var contexts = probe->get_owned_contexts();
  EXPECT_EQ(contexts->length(), 0u);
}

TEST_F(ComponentContextTest, does_not_live_in_one_of_unknown_type) {
  probe->getProperties()["exec_cxt.periodic.type"] = "NoSuchContext";
  EXPECT_EQ(probe->initialize(), RTC::RTC_ERROR);
}

TEST_F(ComponentContextTest, a_tick_of_the_synchronous_one_returns_after_the_cycle) {
  for (const char* type : {"OpenHRPExecutionContext", "SimulatorExecutionContext"}) {
    Owned<> stepped(nullptr, "Stepped0");
    stepped->getProperties()["execution_contexts"] = type;
    ASSERT_EQ(stepped->initialize(), RTC::RTC_OK);
    ASSERT_EQ(stepped->activate(0), RTC::RTC_OK);
    EXPECT_EQ(stepped->count("onActivated"), 1);
    EXPECT_EQ(stepped->count("onExecute"), 0);
    RTC::ExecutionContext_var context = first_context(*stepped);
    OpenRTM::ExtTrigExecutionContextService_var trigger = OpenRTM::ExtTrigExecutionContextService::_narrow(context);
    trigger->tick();
    trigger->tick();
    EXPECT_EQ(stepped->count("onExecute"), 2);
    EXPECT_EQ(stepped->thread_of("onExecute"), std::this_thread::get_id());
    EXPECT_EQ(stepped->deactivate(0), RTC::RTC_OK);
    EXPECT_EQ(stepped->count("onDeactivated"), 1);
  }
}

TEST_F(ComponentContextTest, every_tick_of_several_threads_is_a_cycle) {
  constexpr int threads = 8, ticks = 500;
  for (const char* type : {"ExtTrigExecutionContext", "OpenHRPExecutionContext", "SimulatorExecutionContext", "LogicalTimeTriggeredEC"}) {
    Owned<> ticked(nullptr, "Ticked0");
    ticked->getProperties()["execution_contexts"] = type;
    ASSERT_EQ(ticked->initialize(), RTC::RTC_OK);
    ASSERT_EQ(ticked->activate(0), RTC::RTC_OK);
    const RTC::ExecutionContext_var context = first_context(*ticked);
    {
      std::vector<std::jthread> callers;
      for (int i = 0; i < threads; ++i)
        callers.emplace_back([&] {
          OpenRTM::ExtTrigExecutionContextService_var trigger = OpenRTM::ExtTrigExecutionContextService::_narrow(context);
          OpenRTM::LogicalTimeTriggeredEC_var logical = OpenRTM::LogicalTimeTriggeredEC::_narrow(context);
          for (int k = 0; k < ticks; ++k) CORBA::is_nil(trigger) ? logical->tick(k, 0) : trigger->tick();
        });
    }
    EXPECT_TRUE(ticked->wait_for("onStateUpdate", threads * ticks)) << type;
    EXPECT_EQ(ticked->deactivate(0), RTC::RTC_OK);
    EXPECT_EQ(ticked->count("onExecute"), threads * ticks) << type;
  }
}

TEST_F(ComponentContextTest, each_cycle_of_logical_time_happens_at_the_time_of_its_tick) {
  Owned<> ticked(nullptr, "Logical0");
  ticked->getProperties()["execution_contexts"] = "LogicalTimeTriggeredEC";
  ASSERT_EQ(ticked->initialize(), RTC::RTC_OK);
  ASSERT_EQ(ticked->activate(0), RTC::RTC_OK);
  std::vector<std::chrono::nanoseconds> seen;  // of the context's thread
  ticked->during = [&](const std::string& callback) {
    if (callback == "onExecute") seen.push_back(base::current_clock().now());
  };
  const RTC::ExecutionContext_var context = first_context(*ticked);
  EXPECT_TRUE(context->_is_a("IDL:openrtm.org/OpenRTM/LogicalTimeTriggeredEC:1.0"));
  OpenRTM::LogicalTimeTriggeredEC_var logical = OpenRTM::LogicalTimeTriggeredEC::_narrow(context);
  CORBA::ULong sec = 7, usec = 7;
  logical->get_time(sec, usec);
  EXPECT_EQ(std::pair(sec, usec), std::pair(0u, 0u));
  logical->tick(1, 250000);
  logical->tick(1, 1500000);
  logical->tick(4294967295u, 999999);
  EXPECT_EQ(ticked->count("onStateUpdate"), 3) << "tick() returns when its cycle is over";
  logical->get_time(sec, usec);
  EXPECT_EQ(std::pair(sec, usec), std::pair(4294967295u, 999999u));
  EXPECT_EQ(ticked->deactivate(0), RTC::RTC_OK);
  ticked->during = nullptr;
  EXPECT_THAT(seen, testing::ElementsAre(1250ms, 2500ms, 4294967295s + 999999us));
  EXPECT_EQ(context->stop(), RTC::RTC_OK);
  logical->tick(9, 0);
  EXPECT_EQ(context->start(), RTC::RTC_OK);
  logical->get_time(sec, usec);
  EXPECT_EQ(sec, 4294967295u) << "ticks of a stopped context are forgotten";
}

TEST_F(ComponentContextTest, tools_may_ask_while_a_component_ends) {
  for (int round = 0; round < 20; ++round) {
    auto* leaving = new support::ProbeComponent(nullptr, "Leaving0");
    ASSERT_EQ(leaving->initialize(), RTC::RTC_OK);
    const RTC::RTObject_var reference = leaving->getObjRef();
    std::atomic<bool> has_left{false};
    std::vector<std::jthread> tools;
    for (int i = 0; i < 3; ++i)
      tools.emplace_back([&] {
        const RTC::RTObject_var component = reference;
        while (!has_left) {
          try {
            const SDOPackage::Configuration_var configuration = component->get_configuration();
            const SDOPackage::ConfigurationSetList_var sets = configuration->get_configuration_sets();
            const RTC::ComponentProfile_var profile = component->get_component_profile();
            RTC::ExecutionContextList_var contexts = component->get_owned_contexts();
            for (CORBA::ULong k = 0; k < contexts->length(); ++k) contexts[k]->get_component_state(component);
          } catch (const CORBA::Exception&) {
            // It has left: what the contract knows for that.
          }
        }
      });
    EXPECT_EQ(leaving->exit(), RTC::RTC_OK);
    leaving->_remove_ref();
    has_left = true;
  }
}

// A context with a clock of its own, and a cycle when it wants one.
class ManualContext final : public RTC::ExecutionContextServant<POA_RTC::ExecutionContextService> {
 public:
  ManualContext() : ExecutionContextServant("manual_ec") {
    setObjRef(RTC::ExecutionContextService_var(_this()));
    RTC::set_clock(*this, now_, nullptr);
  }
  void cycle() {
    now_->advance(10ms);
    invokeWorkerPreDo();
    invokeWorkerDo();
    invokeWorkerPostDo();
  }

 protected:
  RTC::ReturnCode_t onWaitingActivated(RTC_impl::RTObjectStateMachine* comp, long int) override {
    EXPECT_TRUE(comp->isCurrentState(RTC::INACTIVE_STATE));
    EXPECT_TRUE(comp->isNextState(RTC::ACTIVE_STATE));
    EXPECT_TRUE(isAllNextState(RTC::ACTIVE_STATE));
    cycle();
    return RTC::RTC_OK;
  }

 private:
  const std::shared_ptr<base::ManualClock> now_ = std::make_shared<base::ManualClock>();
};

TEST_F(ComponentContextTest, may_have_a_clock_of_its_own) {
  RTC::ExecutionContextFactory::instance().addFactory("ManualContext", coil::Creator<RTC::ExecutionContextBase, ManualContext>,
                                                      coil::Destructor<RTC::ExecutionContextBase, ManualContext>);
  Owned<> simulated(nullptr, "Simulated0");
  simulated->getProperties()["execution_contexts"] = "ManualContext";
  simulated->getProperties()["exec_cxt.callback_timeout"] = "0";  // nobody steps it at the end
  ASSERT_EQ(simulated->initialize(), RTC::RTC_OK);
  std::chrono::nanoseconds seen{};
  simulated->during = [&](const std::string& callback) {
    if (callback == "onExecute") seen = base::current_clock().now();
  };
  ASSERT_EQ(simulated->activate(0), RTC::RTC_OK);
  EXPECT_EQ(seen, 10ms);
  dynamic_cast<ManualContext*>(RTC::RuntimeAccess::own_contexts(*simulated).at(0))->cycle();
  EXPECT_EQ(seen, 20ms);
  simulated->during = nullptr;
}

TEST_F(ComponentContextTest, takes_part_in_the_one_of_another_component) {
  probe->initialize();
  Owned<> guest(nullptr, "Guest0");
  guest->initialize();
  RTC::ExecutionContext_var context = first_context(*probe);
  RTC::RTObject_var self = guest->getObjRef();
  ASSERT_EQ(context->add_component(self), RTC::RTC_OK);
  EXPECT_EQ(context->add_component(self), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(guest->get_context_handle(context), 1000);
  RTC::ExecutionContextList_var contexts = guest->get_participating_contexts();
  EXPECT_EQ(contexts->length(), 1u);
  EXPECT_EQ(guest->activate(1000), RTC::RTC_OK);
  EXPECT_TRUE(guest->wait_for("onExecute", 3));
  EXPECT_EQ(context->get_component_state(self), RTC::ACTIVE_STATE);
  RTC::ExecutionContext_var own = first_context(*guest);
  EXPECT_EQ(own->get_component_state(self), RTC::INACTIVE_STATE) << "a state per context";
  EXPECT_EQ(context->remove_component(self), RTC::RTC_OK);
  EXPECT_EQ(context->remove_component(self), RTC::BAD_PARAMETER);
  EXPECT_EQ(guest->get_context_handle(context), -1);
  EXPECT_EQ(context->get_component_state(self), RTC::CREATED_STATE);
}

TEST_F(ComponentContextTest, attaches_only_what_is_a_context) {
  probe->initialize();
  RTC::RTObject_var self = probe->getObjRef();
  RTC::ExecutionContext_var wrong = RTC::ExecutionContext::_unchecked_narrow(self);
  EXPECT_EQ(probe->attach_context(wrong), -1);
  EXPECT_EQ(probe->attach_context(RTC::ExecutionContext::_nil()), -1);
  RTC::ExecutionContextList_var contexts = probe->get_participating_contexts();
  EXPECT_EQ(contexts->length(), 0u);
}

TEST_F(ComponentContextTest, a_rate_of_zero_is_as_fast_as_possible) {
  probe->getProperties()["exec_cxt.periodic.rate"] = "0";
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  const RTC::ExecutionContext_var context = first_context(*probe);
  EXPECT_EQ(context->get_rate(), 1e6);
  EXPECT_EQ(context->set_rate(0), RTC::BAD_PARAMETER) << "over the wire it is none";
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  EXPECT_TRUE(probe->wait_for("onExecute", 10));
  ASSERT_EQ(probe->deactivate(0), RTC::RTC_OK);
}

// What a component keeps in thread_local variables, a device handle for instance, must not be gone.
TEST_F(ComponentContextTest, goes_on_with_the_same_thread_after_stop_and_start) {
  ASSERT_EQ(probe->initialize(), RTC::RTC_OK);
  std::mutex mutex;
  std::set<std::thread::id> threads;
  probe->during = [&](const std::string& callback) {
    const std::lock_guard lock(mutex);
    if (callback == "onExecute") threads.insert(std::this_thread::get_id());
  };
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  const RTC::ExecutionContext_var context = first_context(*probe);
  for (int round = 0; round < 3; ++round) {
    EXPECT_TRUE(probe->wait_for("onExecute", probe->count("onExecute") + 3));
    ASSERT_EQ(context->stop(), RTC::RTC_OK);
    ASSERT_EQ(context->start(), RTC::RTC_OK);
  }
  EXPECT_TRUE(probe->wait_for("onExecute", probe->count("onExecute") + 3));
  ASSERT_EQ(probe->deactivate(0), RTC::RTC_OK);
  probe->during = nullptr;  // the end of the component comes after the end of what it refers to
  const std::lock_guard lock(mutex);
  EXPECT_EQ(threads.size(), 1u);
}

TEST_F(ComponentContextTest, gives_its_thread_the_stack_that_was_asked_for) {
  coil::Properties settings;
  settings["exec_cxt.stack_size"] = "24M";
  probe->setProperties(settings);
  std::atomic<std::size_t> stack = 0;
  probe->during = [&](const std::string& callback) {
    if (callback != "onActivated") return;
    pthread_attr_t attributes;
    std::size_t octets = 0;
    pthread_getattr_np(pthread_self(), &attributes);
    pthread_attr_getstacksize(&attributes, &octets);
    pthread_attr_destroy(&attributes);
    stack = octets;
  };
  probe->initialize();
  EXPECT_EQ(probe->activate(0), RTC::RTC_OK);
  EXPECT_GE(stack, std::size_t{24} << 20) << "stacks of threads that have ended are used again when they are large enough";
  probe->during = nullptr;
}

struct AmongTheSilent : ComponentTest {
  CORBA::Object_ptr object(const char* type) {
    int argc = 0;
    const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
    return silence.object(orb, type, ++made);
  }
  RTC::ExecutionContext_ptr context() {
    const CORBA::Object_var silent = object("IDL:omg.org/RTC/ExecutionContextService:1.0");
    return RTC::ExecutionContext::_unchecked_narrow(silent);
  }
  SDOPackage::Organization_ptr organization(const char* type = "IDL:org.omg/SDOPackage/Organization:1.0") {
    const CORBA::Object_var silent = object(type);
    return SDOPackage::Organization::_unchecked_narrow(silent);
  }
  support::Silence silence;
  int made = 0;
};

TEST_F(AmongTheSilent, a_component_takes_part_in_a_limited_number_of_contexts_and_organizations) {
  probe->getProperties()["exec_cxt.callback_timeout"] = "0.2";
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  for (int i = 0; i < 64; ++i) {
    EXPECT_EQ(probe->attach_context(RTC::ExecutionContext_var(context())), 1000 + i);
    EXPECT_TRUE(configuration->add_organization(SDOPackage::Organization_var(organization())));
  }
  EXPECT_EQ(probe->attach_context(RTC::ExecutionContext_var(context())), -1);
  EXPECT_FALSE(configuration->add_organization(SDOPackage::Organization_var(organization())));
  EXPECT_EQ(probe->detach_context(1007), RTC::RTC_OK);
  EXPECT_EQ(probe->attach_context(RTC::ExecutionContext_var(context())), 1007);
}

TEST_F(AmongTheSilent, a_component_leaves_in_time) {
  probe->getProperties()["exec_cxt.callback_timeout"] = "0.2";
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  for (int i = 0; i < 60; ++i) {
    probe->attach_context(RTC::ExecutionContext_var(context()));
    configuration->add_organization(SDOPackage::Organization_var(organization()));
  }
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(probe->exit(), RTC::RTC_OK);
  EXPECT_LT(std::chrono::steady_clock::now() - began, 12s) << "half of what all of them take, one after the other";
  EXPECT_EQ(probe->count("onFinalize"), 1);
}

// The ORB narrows such a reference to a further one, with the call timeout of the process.
TEST_F(AmongTheSilent, a_component_leaves_in_time_when_references_name_another_type) {
  probe->getProperties()["exec_cxt.callback_timeout"] = "0.2";
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  configuration->add_organization(SDOPackage::Organization_var(organization("IDL:omg.org/RTC/PortService:1.0")));
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(probe->exit(), RTC::RTC_OK);
  EXPECT_LT(std::chrono::steady_clock::now() - began, 10s) << "the call timeout of the process";
}

TEST_F(ComponentContextTest, leaves_foreign_ones_when_it_exits) {
  probe->initialize();
  RTC::ExecutionContext_var context = first_context(*probe);
  {
    Owned<> guest(nullptr, "Guest1");
    guest->initialize();
    RTC::RTObject_var reference = guest->getObjRef();
    ASSERT_EQ(context->add_component(reference), RTC::RTC_OK);
    ASSERT_EQ(guest->activate(1000), RTC::RTC_OK);
  }
  RTC::ExecutionContextService_var service = RTC::ExecutionContextService::_narrow(context);
  RTC::ExecutionContextProfile_var profile = service->get_profile();
  EXPECT_EQ(profile->participants.length(), 0u);
}

}  // namespace
