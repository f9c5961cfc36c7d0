// What tools attach to components in this process, and composites.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rtm/InPort.h>
#include <rtm/NVUtil.h>
#include <rtm/OutPort.h>
#include <rtm/PeriodicECOrganization.h>
#include <rtm/StaticFSM.h>
#include <rtm/SystemLogger.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ComponentObserverSkel.h>
#include <rtm/idl/FsmComponentObserverSkel.h>
#include <rtm/idl/LoggerSkel.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

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

template <class Skeleton, class Kind>
class Observer : public Skeleton {
 public:
  void update_status(Kind kind, const char* hint) override {
    std::lock_guard lock(mutex);
    heard.emplace_back(kind, hint);
    condition.notify_all();
  }
  bool wait_for(Kind kind, const std::string& hint) {
    std::unique_lock lock(mutex);
    return condition.wait_for(lock, 60s, [&] { return std::find(heard.begin(), heard.end(), std::pair(kind, hint)) != heard.end(); });
  }
  std::mutex mutex;
  std::condition_variable condition;
  std::vector<std::pair<Kind, std::string>> heard;
};
using OldObserver = Observer<POA_OpenRTM::ComponentObserver, OpenRTM::StatusKind>;
using NewObserver = Observer<POA_RTC::ComponentObserver, RTC::StatusKind>;

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

// --- observers and loggers

TEST_F(ComponentServiceTest, tells_an_observer_of_the_first_version_everything) {
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  Served<OldObserver> observer;
  ASSERT_TRUE(configuration->add_service_profile(
      service_profile("one", "IDL:OpenRTM/ComponentObserver:1.0", observer.reference(),
                      {{"observed_status", "ALL"}, {"heartbeat.enable", "YES"}, {"heartbeat.interval", "0.02"}})));
  EXPECT_TRUE(observer->wait_for(OpenRTM::HEARTBEAT, ""));
  probe->activate(0);
  EXPECT_TRUE(observer->wait_for(OpenRTM::RTC_STATUS, "ACTIVATED:0"));
  probe->deactivate(0);
  EXPECT_TRUE(observer->wait_for(OpenRTM::RTC_STATUS, "DEACTIVATED:0"));
  set("fail", "onActivated");
  EXPECT_TRUE(observer->wait_for(OpenRTM::CONFIGURATION, "SET_CONFIG_SET: default"));
  EXPECT_TRUE(observer->wait_for(OpenRTM::CONFIGURATION, "ACTIVATE_CONFIG_SET: default"));
  probe->activate(0);
  EXPECT_TRUE(observer->wait_for(OpenRTM::CONFIGURATION, "UPDATE_CONFIG_PARAM: default.fail"));
  EXPECT_TRUE(observer->wait_for(OpenRTM::CONFIGURATION, "UPDATE_CONFIG_SET: default"));
  EXPECT_TRUE(observer->wait_for(OpenRTM::RTC_STATUS, "ABORTING:0"));
  probe->reset(0);
  EXPECT_TRUE(observer->wait_for(OpenRTM::RTC_STATUS, "RESET:0"));
  probe->setExecutionRate(0, 100);
  EXPECT_TRUE(observer->wait_for(OpenRTM::EC_STATUS, "RATE_CHANGED:0"));
  RTC::ExecutionContext_var context = first_context(*probe);
  context->stop();
  EXPECT_TRUE(observer->wait_for(OpenRTM::EC_STATUS, "SHUTDOWN:0"));
  context->start();
  EXPECT_TRUE(observer->wait_for(OpenRTM::EC_STATUS, "STARTUP:0"));
  Owned<> host(nullptr, "Host0");
  host->initialize();
  RTC::ExecutionContext_var other = first_context(*host);
  RTC::RTObject_var self = probe->getObjRef();
  other->add_component(self);
  EXPECT_TRUE(observer->wait_for(OpenRTM::EC_STATUS, "ATTACHED:1000"));
  other->remove_component(self);
  EXPECT_TRUE(observer->wait_for(OpenRTM::EC_STATUS, "DETACHED:1000"));
  EXPECT_TRUE(configuration->remove_service_profile("one"));
  EXPECT_FALSE(configuration->remove_service_profile("one"));
}

TEST_F(ComponentServiceTest, heartbeats_come_no_faster_than_asked_and_end_when_asked) {
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  const auto add = [&](const char* id, Served<OldObserver>& observer, const char* enable, const char* interval) {
    return configuration->add_service_profile(
        service_profile(id, "IDL:OpenRTM/ComponentObserver:1.0", observer.reference(),
                        {{"observed_status", "ALL"}, {"heartbeat.enable", enable}, {"heartbeat.interval", interval}}));
  };
  const auto beats = [](Served<OldObserver>& observer) {
    std::lock_guard lock(observer->mutex);
    return std::count(observer->heard.begin(), observer->heard.end(), std::pair(OpenRTM::HEARTBEAT, std::string()));
  };
  const auto wait_for_beats = [&](Served<OldObserver>& observer, std::ptrdiff_t further) {
    const auto enough = beats(observer) + further;
    std::unique_lock lock(observer->mutex);
    return observer->condition.wait_for(lock, 60s, [&] {
      return std::count(observer->heard.begin(), observer->heard.end(), std::pair(OpenRTM::HEARTBEAT, std::string())) >= enough;
    });
  };
  Served<OldObserver> steady, quick, mute;
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(add("steady", steady, "YES", "0.05"));
  ASSERT_TRUE(add("quick", quick, "YES", "0.02"));
  ASSERT_TRUE(add("mute", mute, "NO", "0.02"));
  EXPECT_TRUE(wait_for_beats(steady, 5));
  EXPECT_GE(std::chrono::steady_clock::now() - start, 4 * 50ms) << "no faster than asked";
  EXPECT_GT(beats(quick), 0);
  EXPECT_EQ(beats(mute), 0);

  // Told again with other settings, and taken away: one that was on its way may still come.
  ASSERT_TRUE(add("quick", quick, "NO", "0.02"));
  auto before = beats(quick);
  EXPECT_TRUE(wait_for_beats(steady, 3));
  EXPECT_LE(beats(quick), before + 1);
  ASSERT_TRUE(add("quick", quick, "YES", "0.02"));
  EXPECT_TRUE(wait_for_beats(quick, 2));
  ASSERT_TRUE(configuration->remove_service_profile("quick"));
  before = beats(quick);
  EXPECT_TRUE(wait_for_beats(steady, 3));
  EXPECT_LE(beats(quick), before + 1);
}

TEST_F(ComponentServiceTest, tells_an_observer_of_the_second_version_only_what_it_asked_for) {
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  Served<NewObserver> observer;
  ASSERT_TRUE(configuration->add_service_profile(
      service_profile("two", "IDL:omg.org/RTC/ComponentObserver:1.0", observer.reference(),
                      {{"observed_status", "RTC_STATUS"}, {"ec_heartbeat.enable", "YES"}, {"ec_heartbeat.interval", "0.02"}})));
  EXPECT_TRUE(observer->wait_for(RTC::EC_HEARTBEAT, ""));
  set("fail", "");
  probe->activate(0);
  EXPECT_TRUE(observer->wait_for(RTC::RTC_STATUS, "ACTIVATED:0"));
  std::lock_guard lock(observer->mutex);
  for (const auto& [kind, hint] : observer->heard) EXPECT_NE(kind, RTC::CONFIGURATION) << hint;
}

TEST_F(ComponentServiceTest, tells_observers_what_changes_in_ports_profile_and_state_machine) {
  RTC::TimedLong value{};
  RTC::InPort<RTC::TimedLong> in("in", value);
  RTC::OutPort<RTC::TimedLong> out("out", value);
  probe->addInPort("in", in);
  probe->addOutPort("out", out);
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  Served<OldObserver> old_observer;
  Served<NewObserver> observer;
  ASSERT_TRUE(configuration->add_service_profile(service_profile("old", "IDL:OpenRTM/ComponentObserver:1.0", old_observer.reference())));
  ASSERT_TRUE(configuration->add_service_profile(service_profile("new", "IDL:omg.org/RTC/ComponentObserver:1.0", observer.reference(),
                                                                 {{"rtc_heartbeat.enable", "YES"}, {"rtc_heartbeat.interval", "0.02"}})));
  EXPECT_TRUE(observer->wait_for(RTC::RTC_HEARTBEAT, ""));

  RTC::ConnectorProfile profile;
  profile.ports.length(2);
  profile.ports[0] = RTC::PortService::_duplicate(out.getPortRef());
  profile.ports[1] = RTC::PortService::_duplicate(in.getPortRef());
  NVUtil::setStringValue(profile.properties, "dataport.interface_type", "corba_cdr");
  NVUtil::setStringValue(profile.properties, "dataport.dataflow_type", "push");
  ASSERT_EQ(out.connect(profile), RTC::RTC_OK);
  out.write();
  for (const char* hint : {"CONNECT:Probe0.in", "CONNECT:Probe0.out", "SEND:OutPort:out", "RECEIVE:InPort:in"}) {
    EXPECT_TRUE(old_observer->wait_for(OpenRTM::PORT_PROFILE, hint)) << hint;
    EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, hint)) << hint;
  }
  EXPECT_EQ(out.disconnect_all(), RTC::RTC_OK);
  EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, "DISCONNECT:Probe0.in"));
  EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, "DISCONNECT:Probe0.out"));
  RTC::InPort<RTC::TimedLong> late("late", value);
  probe->addInPort("late", late);
  EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, "ADD:Probe0.late"));
  profile.connector_id = "";
  profile.ports[1] = RTC::PortService::_duplicate(late.getPortRef());
  ASSERT_EQ(out.connect(profile), RTC::RTC_OK);
  out.write();
  EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, "RECEIVE:InPort:late"));
  probe->removeInPort(late);
  EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, "REMOVE:Probe0.late"));

  probe->setInstanceName("Probe1");
  EXPECT_TRUE(old_observer->wait_for(OpenRTM::COMPONENT_PROFILE, "Probe1"));
  EXPECT_TRUE(observer->wait_for(RTC::COMPONENT_PROFILE, "Probe1"));
  probe->notifyObservers(RTC::RTObject_impl::Status::user_defined, "low battery");
  EXPECT_TRUE(observer->wait_for(RTC::USER_DEFINED, "low battery"));
  {
    RTC::Machine<Door> machine(&*probe);
    machine.add_event_profile("open", "");
    EXPECT_TRUE(observer->wait_for(RTC::FSM_PROFILE, "open"));
    EXPECT_TRUE(observer->wait_for(RTC::FSM_STRUCTURE, "Door"));
    machine->open();
    EXPECT_TRUE(observer->wait_for(RTC::FSM_STATUS, "Shut PRE_ONEXIT"));
    EXPECT_TRUE(observer->wait_for(RTC::FSM_STATUS, "Ajar POST_ONENTRY"));
  }
  {
    std::lock_guard lock(old_observer->mutex);
    for (const auto& [kind, hint] : old_observer->heard) EXPECT_LT(kind, OpenRTM::HEARTBEAT) << hint;
  }
  probe->removeInPort(in);
  probe->removeOutPort(out);
}

class LogReader : public POA_OpenRTM::Logger {
 public:
  void publish(const OpenRTM::LogRecord& record) override {
    std::lock_guard lock(mutex);
    records.push_back(record);
    condition.notify_all();
  }
  void close() override {}
  std::mutex mutex;
  std::condition_variable condition;
  std::vector<OpenRTM::LogRecord> records;
};

TEST_F(ComponentServiceTest, publishes_log_records_to_a_logger) {
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  Served<LogReader> reader;
  ASSERT_TRUE(configuration->add_service_profile(
      service_profile("log", "IDL:OpenRTM/Logger:1.0", reader.reference(), {{"logger.log_level", "WARN"}, {"logger.filter", "Probe0"}})));
  RTC::Logger("Somebody").write(RTC::Logger::RTL_WARN, "not for you");
  RTC::Logger("Probe0").write(RTC::Logger::RTL_INFO, "too small");
  RTC::Logger("Probe0").write(RTC::Logger::RTL_WARN, "hot");
  std::unique_lock lock(reader->mutex);
  ASSERT_TRUE(reader->condition.wait_for(lock, 60s, [&] { return !reader->records.empty(); }));
  ASSERT_THAT(reader->records, SizeIs(1));
  EXPECT_STREQ(reader->records[0].loggername, "Probe0");
  EXPECT_STREQ(reader->records[0].message, "hot");
  EXPECT_EQ(reader->records[0].level, OpenRTM::RTM_WARN);
}

TEST_F(ComponentServiceTest, refuses_services_that_are_not_what_they_say) {
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  Served<LogReader> reader;
  const auto add = [&](const char* id, const char* type, CORBA::Object_ptr service) {
    return configuration->add_service_profile(service_profile(id, type, service));
  };
  EXPECT_FALSE(add("a", "IDL:omg.org/RTC/ComponentObserver:1.0", reader.reference()));
  EXPECT_FALSE(add("b", "IDL:nobody/Knows:1.0", reader.reference()));
  EXPECT_FALSE(add("c", "IDL:OpenRTM/Logger:1.0", CORBA::Object::_nil()));
  EXPECT_FALSE(add("", "IDL:OpenRTM/Logger:1.0", reader.reference()));
  EXPECT_TRUE(add("d", "IDL:OpenRTM/Logger:1.0", reader.reference()));
}

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

// --- state machines

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
