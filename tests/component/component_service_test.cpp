// State machines and composites of components in this process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rtm/ExecutionContextServant.h>
#include <rtm/InPort.h>
#include <rtm/NVUtil.h>
#include <rtm/OutPort.h>
#include <rtm/PeriodicECOrganization.h>
#include <rtm/StaticFSM.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <semaphore>
#include <thread>

#include "corba/orb/call_timeout.h"
#include "support/component_fixture.h"

namespace {

using namespace std::chrono_literals;
using support::ComponentTest;
using support::first_context;
using support::Owned;
using support::Served;
using support::service_profile;
using testing::ElementsAre;
using testing::SizeIs;

using ComponentServiceTest = ComponentTest;

// --- state machines

std::vector<std::string> steps;

FSM_TOPSTATE(Door) {
  FSM_STATE(Door);
  virtual void open() {}
  virtual void close() {}
  virtual void lock(int) {}
  RTC::ReturnCode_t onInit() override;
};
FSM_SUBSTATE(Shut, Door) {
  struct Box {
    int turns = 0;
  };
  FSM_STATE(Shut);
  void open() override;
  void lock(int n) override;
  RTC::ReturnCode_t onEntry() override { return steps.push_back("enter Shut"), RTC::RTC_OK; }
  RTC::ReturnCode_t onExit() override { return steps.push_back("leave Shut"), RTC::RTC_OK; }
};
FSM_SUBSTATE(Locked, Shut) {
  FSM_STATE(Locked);
  void open() override { steps.push_back("locked " + std::to_string(Shut::box().turns)); }
  RTC::ReturnCode_t onEntry() override { return steps.push_back("enter Locked"), RTC::RTC_OK; }
  RTC::ReturnCode_t onExit() override { return steps.push_back("leave Locked"), RTC::RTC_OK; }
};
FSM_SUBSTATE(Ajar, Door) {
  FSM_STATE(Ajar);
  void close() override { setStateHistory<Shut>(); }
  RTC::ReturnCode_t onEntry() override { return steps.push_back("enter Ajar"), RTC::RTC_OK; }
};
RTC::ReturnCode_t Door::onInit() {
  setState<Shut>();
  return RTC::RTC_OK;
}
void Shut::open() { setState<Ajar>(); }
void Shut::lock(int n) {
  box().turns += n;
  setState<Locked>();
}

// With history, data and events of its own, spelled as the generator of 2.0 does.
FSM_TOPSTATE(Heater) {
  struct Box {
    int litres = 0;
  };
  FSM_STATE(Heater);
  virtual void heat() {}
  virtual void fill(int) {}
  virtual void count() {}
  virtual void trip() {}

 private:
  RTC::ReturnCode_t onInit() override;
};
FSM_SUBSTATE(On, Heater) {
  FSM_STATE(On);
  DEEPHISTORY();
  void trip() override;
  RTC::ReturnCode_t onInit() override;
};
FSM_SUBSTATE(Cold, On) {
  FSM_STATE(Cold);
  void heat() override;
  void fill(int litres) override;
};
FSM_SUBSTATE(Warm, On) {
  FSM_STATE(Warm);
  HISTORY();
  void heat() override;
  void fill(int litres) override { TOP::box().litres += litres; }
};
FSM_SUBSTATE(Boiling, Warm) {
  struct Box {
    int bubbles = 0;
  };
  FSM_STATE(Boiling);
  void init(int n) { bubbles = box().bubbles = n; }
  void heat() override;
  void count() override { bubbles = ++box().bubbles; }
  static inline int bubbles = 0;
};
FSM_SUBSTATE(Rolling, Boiling) {
  FSM_STATE(Rolling);
  void heat() override {}
};
FSM_SUBSTATE(Tripped, Heater) {
  struct Box {
    int times = 0;
  };
  FSM_STATE(Tripped);
  PERSISTENT();
  void heat() override { setStateHistory<On>(); }
  void trip() override { setStateHistory<Warm>(); }
  RTC::ReturnCode_t onEntry() override { return times = ++box().times, RTC::RTC_OK; }
  static inline int times = 0;
};
RTC::ReturnCode_t Heater::onInit() {
  setState<On>();
  return RTC::RTC_OK;
}
RTC::ReturnCode_t On::onInit() {
  setState<Cold>();
  return RTC::RTC_OK;
}
void On::trip() { setState<Tripped>(); }
void Cold::heat() { setState<Warm>(); }
void Cold::fill(int litres) {
  if (litres < 0) throw std::runtime_error("no such amount");
  setState<Warm>();
  dispatch(Event(&TOP::fill, litres));
}
void Warm::heat() { setState<Boiling>(7); }
void Boiling::heat() { setState<Rolling>(); }

// --- composites

struct Composite : RTC::DataFlowComponentBase {
  Composite() : RTC::DataFlowComponentBase(nullptr), organization(new SDOPackage::PeriodicECOrganization(*this)) {
    setInstanceName("Composite0");
    addOwnedOrganization(organization);
  }
  ~Composite() override { organization->_remove_ref(); }
  RTC::ReturnCode_t onActivated(RTC::UniqueId) override {
    organization->activate_members();
    return RTC::RTC_OK;
  }
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId) override {
    organization->deactivate_members();
    return RTC::RTC_OK;
  }
  RTC::ReturnCode_t onFinalize() override {
    organization->close();
    return RTC::RTC_OK;
  }
  SDOPackage::PeriodicECOrganization* organization;
};

TEST_F(ComponentServiceTest, members_of_a_composite_run_in_its_context_and_follow_its_state) {
  probe->initialize();
  Owned<Composite> composite;
  composite->initialize();
  SDOPackage::OrganizationList_var organizations = composite->get_owned_organizations();
  ASSERT_EQ(organizations->length(), 1u);
  SDOPackage::SDOList members;
  members.length(1);
  members[0] = probe->getObjRef();
  ASSERT_TRUE(organizations[0u]->add_members(members));
  RTC::ExecutionContext_var own = first_context(*probe);
  EXPECT_FALSE(own->is_running());
  SDOPackage::OrganizationList_var of_member = probe->get_organizations();
  EXPECT_EQ(of_member->length(), 1u);
  ASSERT_EQ(composite->activate(0), RTC::RTC_OK);
  EXPECT_TRUE(probe->wait_for("onExecute", 2));
  ASSERT_EQ(composite->deactivate(0), RTC::RTC_OK);
  EXPECT_TRUE(probe->wait_for("onDeactivated"));
  ASSERT_TRUE(organizations[0u]->remove_member("Probe0"));
  EXPECT_TRUE(own->is_running());
  EXPECT_THROW(organizations[0u]->remove_member("Probe0"), SDOPackage::InvalidParameter);
  of_member = probe->get_organizations();
  EXPECT_EQ(of_member->length(), 0u);
}

// Two members that each wait in onExecute for the other: on one thread they would never meet.
TEST_F(ComponentServiceTest, groups_of_a_multilayer_composite_run_at_the_same_time) {
  Owned<> a(nullptr, "LayerA"), b(nullptr, "LayerB"), c(nullptr, "LayerC");
  std::mutex mutex;
  std::condition_variable changed;
  int inside = 0, met = 0;
  std::map<std::string, std::thread::id> threads;
  const auto meet = [&](const std::string& name) {
    std::unique_lock lock(mutex);
    threads[name] = std::this_thread::get_id();
    if (++inside == 2) {
      ++met;
      changed.notify_all();
    } else {
      changed.wait_for(lock, 100ms, [&, before = met] { return met > before; });  // alone in the cycles of activation and deactivation
    }
    --inside;
  };
  a->during = [&](const std::string& callback) {
    if (callback == "onExecute") meet("LayerA");
  };
  b->during = [&](const std::string& callback) {
    if (callback == "onExecute") meet("LayerB");
  };
  c->during = [&](const std::string& callback) {
    if (callback != "onExecute") return;
    const std::scoped_lock lock(mutex);
    threads["LayerC"] = std::this_thread::get_id();
  };
  Owned<Composite> composite;
  composite->getProperties()["exec_cxt.periodic.type"] = "MultilayerCompositeEC";
  coil::Properties spec;
  spec["conf.default.members"] = "LayerA | LayerB, LayerC";
  composite->setProperties(spec);
  ASSERT_EQ(composite->initialize(), RTC::RTC_OK);
  SDOPackage::OrganizationList_var organizations = composite->get_owned_organizations();
  SDOPackage::SDOList members;
  members.length(3);
  CORBA::ULong n = 0;
  for (auto* member : {&*a, &*b, &*c}) {
    ASSERT_EQ(member->initialize(), RTC::RTC_OK);
    members[n++] = member->getObjRef();
  }
  ASSERT_TRUE(organizations[0u]->add_members(members));
  ASSERT_EQ(composite->activate(0), RTC::RTC_OK);
  for (auto* member : {&*a, &*b, &*c}) EXPECT_TRUE(member->wait_for("onStateUpdate", 20));
  ASSERT_EQ(composite->deactivate(0), RTC::RTC_OK);
  for (auto* member : {&*a, &*b, &*c}) EXPECT_TRUE(member->wait_for("onDeactivated"));
  {
    const std::scoped_lock lock(mutex);
    EXPECT_NE(threads["LayerA"], threads["LayerB"]);
    EXPECT_EQ(threads["LayerB"], threads["LayerC"]);
    EXPECT_GE(met, 10);
  }
  // And again: the threads of the groups come and go with the context's.
  const RTC::ExecutionContext_var context = first_context(*composite);
  EXPECT_EQ(context->stop(), RTC::RTC_OK);
  EXPECT_EQ(context->start(), RTC::RTC_OK);
  const int seen = c->count("onExecute");
  ASSERT_EQ(composite->activate(0), RTC::RTC_OK);
  EXPECT_TRUE(c->wait_for("onExecute", seen + 3));
  ASSERT_EQ(composite->deactivate(0), RTC::RTC_OK);
  for (auto* member : {&*a, &*b, &*c}) EXPECT_TRUE(member->wait_for("onDeactivated", 2));
  EXPECT_EQ(context->stop(), RTC::RTC_OK);
  for (auto* member : {&*a, &*b, &*c}) member->during = nullptr;
}

TEST_F(ComponentServiceTest, a_composite_takes_no_more_groups_than_there_may_be_threads) {
  const auto initialize_with_groups = [](std::size_t count) {
    Owned<Composite> composite;
    composite->getProperties()["exec_cxt.periodic.type"] = "MultilayerCompositeEC";
    coil::Properties spec;
    spec["conf.default.members"] = "a";
    for (std::size_t n = 1; n < count; ++n) spec["conf.default.members"] += "|a";
    composite->setProperties(spec);
    return composite->initialize();
  };
  EXPECT_EQ(initialize_with_groups(256), RTC::RTC_OK);
  EXPECT_EQ(initialize_with_groups(257), RTC::BAD_PARAMETER);
}

// --- state machines

TEST_F(ComponentServiceTest, an_organization_has_a_limited_number_of_properties_and_members) {
  probe->initialize();
  Owned<Composite> composite;
  composite->initialize();
  SDOPackage::OrganizationList_var organizations = composite->get_owned_organizations();
  CORBA::Any value;
  value <<= "x";
  for (int i = 0; i < 256; ++i) ASSERT_TRUE(organizations[0u]->set_organization_property_value(std::to_string(i).c_str(), value));
  EXPECT_THROW(organizations[0u]->set_organization_property_value("another", value), SDOPackage::InvalidParameter);
  EXPECT_TRUE(organizations[0u]->set_organization_property_value("7", value));
  SDOPackage::SDOList members;
  members.length(4097);
  for (CORBA::ULong i = 0; i < members.length(); ++i) members[i] = probe->getObjRef();
  EXPECT_THROW(organizations[0u]->set_members(members), SDOPackage::InvalidParameter);
}

// Takes its time for each answer, but no time-out.
class SlowContext final : public RTC::ExecutionContextServant<POA_RTC::ExecutionContextService> {
 public:
  SlowContext() : ExecutionContextServant("slow_ec") { setObjRef(RTC::ExecutionContextService_var(_this())); }
  RTC::ReturnCode_t stop() override {
    ++stops;
    static_cast<void>(std::binary_semaphore(0).try_acquire_for(100ms));
    return RTC::RTC_OK;
  }
  int stops = 0;
};

// As many contexts as it likes.
class Contextful : public support::ProbeComponent {
 public:
  explicit Contextful(RTC::ExecutionContextService_ptr one)
      : ProbeComponent(nullptr, "Contextful0"), one_(RTC::ExecutionContextService::_duplicate(one)) {}
  RTC::ExecutionContextList* get_owned_contexts() override {
    RTC::ExecutionContextList_var list = new RTC::ExecutionContextList();
    list->length(100);
    for (CORBA::ULong i = 0; i < list->length(); ++i) list[i] = RTC::ExecutionContext::_duplicate(one_);
    return list._retn();
  }

 private:
  const RTC::ExecutionContextService_var one_;
};

TEST_F(ComponentServiceTest, a_member_that_takes_its_time_for_each_of_many_contexts_does_not_join) {
  const auto usual = corba::port_call_timeout();
  Served<SlowContext> context;
  Owned<Contextful> member(context->getObjRef());
  member->initialize();
  Owned<Composite> composite;
  composite->initialize();
  SDOPackage::OrganizationList_var organizations = composite->get_owned_organizations();
  SDOPackage::SDOList members;
  members.length(1);
  members[0] = member->getObjRef();
  corba::set_port_call_timeout(100ms);
  EXPECT_FALSE(organizations[0u]->add_members(members));
  corba::set_port_call_timeout(usual);
  EXPECT_GE(context->stops, 1);
  EXPECT_LT(context->stops, 10);
}

TEST_F(ComponentServiceTest, shows_its_state_machine_to_tools) {
  probe->initialize();
  EXPECT_THROW(probe->get_sdo_service("IDL:omg.org/RTC/ExtendedFsmService:1.0"), SDOPackage::InvalidParameter);
  RTC::Machine<Door> machine(&*probe);
  machine.add_event_profile("open", "");
  SDOPackage::SDOService_var object = probe->get_sdo_service("IDL:omg.org/RTC/ExtendedFsmService:1.0");
  RTC::ExtendedFsmService_var service = RTC::ExtendedFsmService::_narrow(object);
  ASSERT_FALSE(CORBA::is_nil(service));
  CORBA::String_var state = service->get_current_state();
  EXPECT_STREQ(state, "Shut");
  RTC::FsmStructure_var structure;
  EXPECT_EQ(service->get_fsm_structure(structure.out()), RTC::RTC_OK);
  EXPECT_STREQ(structure->name, "Door");
  ASSERT_EQ(structure->event_profiles.length(), 1u);
  RTC::FsmStructure other = structure.in();
  other.name = "Bottom";
  EXPECT_EQ(service->set_fsm_structure(other), RTC::BAD_PARAMETER);
  EXPECT_EQ(service->set_fsm_structure(structure.in()), RTC::RTC_OK);
}

TEST(StaticFsm, enters_and_leaves_states_along_the_tree) {
  steps.clear();
  RTC::Machine<Door> machine;
  EXPECT_EQ(machine.current_state(), "Shut");
  machine->lock(2);
  EXPECT_EQ(machine.current_state(), "Locked");
  machine->open();
  EXPECT_EQ(machine.current_state(), "Locked");
  EXPECT_THAT(steps, ElementsAre("enter Shut", "enter Locked", "locked 2"));
}

TEST(StaticFsm, remembers_substates_as_their_state_says) {
  RTC::Machine<Heater> machine;
  EXPECT_EQ(machine.current_state(), "Cold");
  for (int i = 0; i < 3; ++i) machine->heat();
  EXPECT_EQ(machine.current_state(), "Rolling");
  machine->trip();
  EXPECT_STREQ(machine.currentState().name(), "Tripped");
  machine->heat();
  EXPECT_EQ(machine.current_state(), "Rolling") << "deep: the one that was current";
  machine->trip();
  machine->trip();
  EXPECT_EQ(machine.current_state(), "Boiling") << "shallow: the one next to it";
}

TEST(StaticFsm, hands_dispatched_events_to_the_next_state) {
  RTC::Machine<Heater> machine;
  machine->fill(2);
  EXPECT_EQ(machine.current_state(), "Warm");
  EXPECT_EQ(machine.box().litres, 2) << "Cold has gone to Warm, which has filled";
  machine.dispatch(&Heater::fill, 3);
  EXPECT_EQ(machine.box().litres, 5);
}

TEST(StaticFsm, keeps_the_data_of_a_state_while_it_is_in_it) {
  RTC::Machine<Heater> machine;
  machine->heat();
  machine->heat();
  EXPECT_EQ(Boiling::bubbles, 7) << "what init(7) was given";
  machine->count();
  machine->count();
  EXPECT_EQ(Boiling::bubbles, 9);
  machine->trip();
  machine->heat();
  machine->count();
  EXPECT_EQ(Boiling::bubbles, 1) << "new data";
  EXPECT_EQ(Tripped::times, 1);
  machine->trip();
  EXPECT_EQ(Tripped::times, 2) << "its data is persistent";
}

TEST(StaticFsm, goes_on_after_a_handler_that_throws) {
  RTC::Machine<Heater> machine;
  EXPECT_THROW(machine->fill(-1), std::runtime_error);
  EXPECT_EQ(machine.current_state(), "Cold");
  machine->heat();
  EXPECT_EQ(machine.current_state(), "Warm");
}

TEST(StaticFsm, handles_queued_events_when_it_is_told_to) {
  RTC::Machine<Door> machine;
  machine.push(&Door::open);
  machine.push(&Door::close);
  EXPECT_EQ(machine.current_state(), "Shut");
  steps.clear();
  machine.run_event();
  EXPECT_EQ(machine.current_state(), "Shut");
  EXPECT_THAT(steps, ElementsAre("leave Shut", "enter Ajar", "enter Shut"));
}

}  // namespace
