// Execution contexts as authors of 1.2 and 2.x write them on top of ours: with the order, the waiting and the transitions in their own hands.
#include <gtest/gtest.h>
#include <rtm/ECFactory.h>
#include <rtm/OpenHRPExecutionContext.h>
#include <rtm/PeriodicExecutionContext.h>
#include <rtm/RTObjectStateMachine.h>

#include <algorithm>
#include <atomic>
#include <mutex>

#include "support/component_fixture.h"
#include "support/orb_environment.h"

namespace {

using namespace std::chrono_literals;
using support::Owned;
using support::ProbeComponent;

std::mutex order_mutex;
std::string order;

class Lettered : public ProbeComponent {
 public:
  explicit Lettered(const std::string& name) : ProbeComponent(nullptr, name) {}
  RTC::ReturnCode_t onExecute(RTC::UniqueId id) override {
    {
      const std::lock_guard lock(order_mutex);
      order += getInstanceName()[0];
    }
    return ProbeComponent::onExecute(id);
  }
};

// Runs its members from the last to the first, and sleeps while nobody is active.
class BackwardsContext : public virtual RTC_exp::PeriodicExecutionContext {
 public:
  BackwardsContext() : PeriodicExecutionContext() { rtclog.setName("backwards"); }
  ~BackwardsContext() override { endThread(); }

  int svc() override {
    RTC_TRACE(("svc()"));
    do {
      owner_ = m_worker.findComponent(RTC::RTObject_var(getOwner()));
      {
        Guard guard(m_workerthread.mutex_);
        while (!m_workerthread.running_) m_workerthread.cond_.wait();
      }
      if (owner_ != nullptr) owner_->workerPreDo();
      const RTC::RTCList& list = getComponentList();
      for (CORBA::ULong i = list.length(); i > 0; --i) {
        RTC_impl::RTObjectStateMachine* member = m_worker.findComponent(list[i - 1]);
        if (member == nullptr) continue;
        member->workerPreDo();
        member->workerDo();
        member->workerPostDo();
      }
      ++cycles;
      {
        std::unique_lock<std::mutex> guard(m_workerthread.mutex_);
        const bool is_idle = isAllCurrentState(RTC::INACTIVE_STATE) && isAllNextState(RTC::INACTIVE_STATE);
        if (is_idle && threadRunning()) m_workerthread.running_ = false;
      }
      coil::TimeValue period(getPeriod());
      if (!m_nowait) coil::sleep(period);
    } while (threadRunning());
    return 0;
  }

  static inline std::atomic<int> cycles = 0;

 private:
  RTC_impl::RTObjectStateMachine* owner_ = nullptr;
};

// Makes transitions on the thread of the one who asks.
class HandContext : public virtual RTC::OpenHRPExecutionContext {
 public:
  void tick() override { invokeWorker(); }
  RTC::ReturnCode_t activate_component(RTC::LightweightRTObject_ptr component) override {
    m_syncActivation = false;
    const RTC::ReturnCode_t code = ExecutionContextBase::activateComponent(component);
    if (code == RTC::RTC_OK) invokeWorkerPreDo();
    return code;
  }
  RTC::ReturnCode_t deactivate_component(RTC::LightweightRTObject_ptr component) override {
    RTC_impl::RTObjectStateMachine* member = m_worker.findComponent(component);
    if (member == nullptr) return RTC::BAD_PARAMETER;
    if (!member->isCurrentState(RTC::ACTIVE_STATE)) return RTC::PRECONDITION_NOT_MET;
    member->goTo(RTC::INACTIVE_STATE);
    tick();
    return member->isCurrentState(RTC::INACTIVE_STATE) ? RTC::RTC_OK : RTC::RTC_ERROR;
  }
};

// 1.1: members by m_comps, transitions by their state.
class MembersContext : public virtual RTC::PeriodicExecutionContext {
 public:
  ~MembersContext() override { endThread(); }
  int svc() override {
    do {
      {
        Guard guard(m_worker.mutex_);
        while (!m_worker.running_) m_worker.cond_.wait();
        Guard another(m_workerthread.mutex_);
        std::for_each(m_comps.begin(), m_comps.end(), invoke_worker());
      }
      coil::sleep(m_period);
    } while (m_svc);
    return 0;
  }
  RTC::ReturnCode_t deactivate_component(RTC::LightweightRTObject_ptr component) override {
    CompItr it = std::find_if(m_comps.begin(), m_comps.end(), find_comp(component));
    if (it == m_comps.end()) return RTC::BAD_PARAMETER;
    if (!it->_sm.m_sm.isIn(RTC::ACTIVE_STATE)) return RTC::PRECONDITION_NOT_MET;
    const Guard guard(m_worker.mutex_);
    it->_sm.m_sm.goTo(RTC::INACTIVE_STATE);
    it->_sm.worker();
    return it->_sm.m_sm.isIn(RTC::INACTIVE_STATE) ? RTC::RTC_OK : RTC::RTC_ERROR;
  }
};

// Only workerDo, until the context says that it stops.
class PlainContext : public virtual RTC_exp::PeriodicExecutionContext {
 public:
  int svc() override {
    do {
      coil::sleep(coil::TimeValue(getPeriod()));
      const RTC::RTCList& list = getComponentList();
      for (CORBA::ULong i = 0; i < list.length(); ++i) m_worker.findComponent(list[i])->workerDo();
    } while (isRunning());
    return 0;
  }
};

template <class Context>
void add(const char* name) {
  RTC::ExecutionContextFactory::instance().addFactory(name, coil::Creator<RTC::ExecutionContextBase, Context>,
                                                      coil::Destructor<RTC::ExecutionContextBase, Context>);
}

RTC::ExecutionContext_ptr context_of(RTC::RTObject_impl& component, const char* type) {
  add<BackwardsContext>("BackwardsContext");
  add<HandContext>("HandContext");
  add<MembersContext>("MembersContext");
  add<PlainContext>("PlainContext");
  component.getProperties()["execution_contexts"] = type;
  EXPECT_EQ(component.initialize(), RTC::RTC_OK);
  return component.getExecutionContext(0);
}

TEST(AuthorContext, runs_its_members_in_an_order_of_its_own) {
  Owned<> owner(nullptr, "Owner0");
  Owned<Lettered> a("A0"), b("B0");
  RTC::ExecutionContext_var context = context_of(*owner, "BackwardsContext");
  ASSERT_EQ(context->set_rate(500), RTC::RTC_OK);
  for (auto* one : {&*a, &*b}) {
    one->getProperties()["execution_contexts"] = "none";
    ASSERT_EQ(one->initialize(), RTC::RTC_OK);
    ASSERT_EQ(context->add_component(RTC::RTObject_var(one->getObjRef())), RTC::RTC_OK);
  }
  // Asleep, as nobody is active: only the request wakes it.
  ASSERT_EQ(context->activate_component(RTC::RTObject_var(a->getObjRef())), RTC::RTC_OK);
  ASSERT_EQ(context->activate_component(RTC::RTObject_var(b->getObjRef())), RTC::RTC_OK);
  ASSERT_TRUE(a->wait_for("onStateUpdate", a->count("onStateUpdate") + 3));
  {
    const std::lock_guard lock(order_mutex);
    order.clear();
  }
  ASSERT_TRUE(a->wait_for("onStateUpdate", a->count("onStateUpdate") + 6));
  {
    const std::lock_guard lock(order_mutex);
    const std::string from_b = order.substr(order.find('B'));
    EXPECT_EQ(from_b.substr(0, 8), "BABABABA");
  }
  EXPECT_EQ(context->deactivate_component(RTC::RTObject_var(b->getObjRef())), RTC::RTC_OK);
  EXPECT_EQ(context->remove_component(RTC::RTObject_var(b->getObjRef())), RTC::RTC_OK);
  EXPECT_EQ(context->deactivate_component(RTC::RTObject_var(a->getObjRef())), RTC::RTC_OK);
  EXPECT_EQ(b->trace().back(), "onDeactivated");
  EXPECT_EQ(owner->activate(0), RTC::RTC_OK);
  EXPECT_EQ(owner->count("onActivated"), 1);
}

TEST(AuthorContext, answers_in_its_own_way_when_asked_for_a_transition) {
  Owned<> probe(nullptr, "Hand0");
  RTC::ExecutionContext_var context = context_of(*probe, "HandContext");
  RTC::RTObject_var self = probe->getObjRef();
  EXPECT_EQ(context->deactivate_component(self), RTC::PRECONDITION_NOT_MET);
  ASSERT_EQ(context->activate_component(self), RTC::RTC_OK);
  EXPECT_EQ(context->get_component_state(self), RTC::ACTIVE_STATE);
  EXPECT_EQ(probe->thread_of("onActivated"), std::this_thread::get_id());
  OpenRTM::ExtTrigExecutionContextService_var trigger = OpenRTM::ExtTrigExecutionContextService::_narrow(context);
  ASSERT_FALSE(CORBA::is_nil(trigger));
  trigger->tick();
  EXPECT_EQ(probe->count("onExecute"), 1);
  EXPECT_EQ(context->deactivate_component(self), RTC::RTC_OK);
  EXPECT_EQ(probe->count("onDeactivated"), 1);
  EXPECT_EQ(probe->count("onExecute"), 1);
  Owned<> stranger(nullptr, "Stranger0");
  EXPECT_EQ(context->deactivate_component(RTC::RTObject_var(stranger->getObjRef())), RTC::BAD_PARAMETER);
}

TEST(AuthorContext, finds_its_members_and_their_states) {
  Owned<> probe(nullptr, "Members0"), stranger(nullptr, "Stranger1");
  RTC::ExecutionContext_var context = context_of(*probe, "MembersContext");
  RTC::RTObject_var self = probe->getObjRef();
  EXPECT_EQ(context->deactivate_component(RTC::RTObject_var(stranger->getObjRef())), RTC::BAD_PARAMETER);
  EXPECT_EQ(context->deactivate_component(self), RTC::PRECONDITION_NOT_MET);
  // From inside a callback too, which the loop calls with its mutex held.
  probe->during = [&](const std::string& callback) {
    if (callback == "onActivated") context->get_component_state(self);
    if (callback == "onExecute") {
      EXPECT_EQ(context->activate_component(self), RTC::PRECONDITION_NOT_MET);
      EXPECT_EQ(context->set_rate(700), RTC::RTC_OK);
    }
  };
  ASSERT_EQ(context->activate_component(self), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onStateUpdate", 3));
  EXPECT_EQ(context->deactivate_component(self), RTC::RTC_OK);
  EXPECT_EQ(probe->count("onDeactivated"), 1);
  RTC::ExecutionContextService_var service = RTC::ExecutionContextService::_narrow(context);
  RTC::ExecutionContextProfile_var profile = service->get_profile();
  EXPECT_GE(std::stoi(NVUtil::toString(profile->properties, "statistics.cycles")), 3);
}

TEST(AuthorContext, may_call_nothing_but_the_do_of_its_members) {
  Owned<> owner(nullptr, "Plain0"), guest(nullptr, "Guest0");
  RTC::ExecutionContext_var context = context_of(*owner, "PlainContext");
  ASSERT_EQ(context->set_rate(500), RTC::RTC_OK);
  guest->getProperties()["execution_contexts"] = "none";
  ASSERT_EQ(guest->initialize(), RTC::RTC_OK);
  RTC::RTObject_var member = guest->getObjRef();
  ASSERT_EQ(context->add_component(member), RTC::RTC_OK);
  for (auto* one : {&*owner, &*guest}) {
    RTC::RTObject_var reference = one->getObjRef();
    ASSERT_EQ(context->activate_component(reference), RTC::RTC_OK);
    ASSERT_TRUE(one->wait_for("onExecute", 3));
    ASSERT_EQ(context->deactivate_component(reference), RTC::RTC_OK);
    EXPECT_EQ(one->trace().back(), "onDeactivated");
  }
  EXPECT_EQ(context->stop(), RTC::RTC_OK);
  EXPECT_FALSE(context->is_running());
  EXPECT_EQ(context->start(), RTC::RTC_OK);
  EXPECT_EQ(context->activate_component(member), RTC::RTC_OK);
  EXPECT_EQ(context->deactivate_component(member), RTC::RTC_OK);
  EXPECT_EQ(context->remove_component(member), RTC::RTC_OK);
}

TEST(AuthorContext, the_triggered_context_is_there_under_the_name_of_1_1) {
  Owned<> probe(nullptr, "Synch0");
  RTC::ExecutionContext_var context = context_of(*probe, "SynchExtTriggerEC");
  OpenRTM::ExtTrigExecutionContextService_var trigger = OpenRTM::ExtTrigExecutionContextService::_narrow(context);
  ASSERT_FALSE(CORBA::is_nil(trigger));
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  trigger->tick();
  EXPECT_EQ(probe->count("onExecute"), 1);
}

}  // namespace
