// What tools attach to components in this process to learn of what they do: observers and loggers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rtm/InPort.h>
#include <rtm/NVUtil.h>
#include <rtm/OutPort.h>
#include <rtm/StaticFSM.h>
#include <rtm/SystemLogger.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ComponentObserverSkel.h>
#include <rtm/idl/FsmComponentObserverSkel.h>
#include <rtm/idl/LoggerSkel.h>

#include <condition_variable>
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
using testing::Contains;
using testing::Not;
using testing::SizeIs;

using ComponentObserverTest = ComponentTest;

template <class Skeleton, class Kind>
class Observer : public Skeleton {
 public:
  void update_status(Kind kind, const char* hint) override {
    std::lock_guard lock(mutex);
    heard.emplace_back(kind, hint);
    condition.notify_all();
  }
  bool wait_for(Kind kind, const std::string& hint, std::ptrdiff_t times = 1) {
    std::unique_lock lock(mutex);
    return condition.wait_for(lock, 60s, [&] { return std::count(heard.begin(), heard.end(), std::pair(kind, hint)) >= times; });
  }
  std::mutex mutex;
  std::condition_variable condition;
  std::vector<std::pair<Kind, std::string>> heard;
};
using OldObserver = Observer<POA_OpenRTM::ComponentObserver, OpenRTM::StatusKind>;
using NewObserver = Observer<POA_RTC::ComponentObserver, RTC::StatusKind>;

RTC::ReturnCode_t connect(RTC::OutPortBase& out, RTC::InPortBase& in) {
  RTC::ConnectorProfile profile;
  profile.ports.length(2);
  profile.ports[0] = RTC::PortService::_duplicate(out.getPortRef());
  profile.ports[1] = RTC::PortService::_duplicate(in.getPortRef());
  NVUtil::setStringValue(profile.properties, "dataport.interface_type", "corba_cdr");
  NVUtil::setStringValue(profile.properties, "dataport.dataflow_type", "push");
  return out.connect(profile);
}

FSM_TOPSTATE(Lamp) {
  FSM_STATE(Lamp);
  virtual void press() {}
  RTC::ReturnCode_t onInit() override;
};
FSM_SUBSTATE(Dark, Lamp) {
  FSM_STATE(Dark);
  void press() override;
};
FSM_SUBSTATE(Lit, Lamp) { FSM_STATE(Lit); };
RTC::ReturnCode_t Lamp::onInit() {
  setState<Dark>();
  return RTC::RTC_OK;
}
void Dark::press() { setState<Lit>(); }

TEST_F(ComponentObserverTest, tells_an_observer_of_the_first_version_everything) {
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  Served<OldObserver> observer;
  ASSERT_TRUE(configuration->add_service_profile(
      service_profile("one", "IDL:OpenRTM/ComponentObserver:1.0", observer.reference(),
                      {{"observed_status", "ALL"}, {"heartbeat.enable", "YES"}, {"heartbeat.interval", "0.02"}})));
  EXPECT_TRUE(observer->wait_for(OpenRTM::HEARTBEAT, ""));
  probe->activate(0);
  EXPECT_TRUE(observer->wait_for(OpenRTM::RTC_STATUS, "ACTIVE:0"));
  probe->deactivate(0);
  EXPECT_TRUE(observer->wait_for(OpenRTM::RTC_STATUS, "INACTIVE:0"));
  set("fail", "onActivated");
  EXPECT_TRUE(observer->wait_for(OpenRTM::CONFIGURATION, "SET_CONFIG_SET: default"));
  EXPECT_TRUE(observer->wait_for(OpenRTM::CONFIGURATION, "ACTIVATE_CONFIG_SET: default"));
  probe->activate(0);
  EXPECT_TRUE(observer->wait_for(OpenRTM::CONFIGURATION, "UPDATE_CONFIG_PARAM: default.fail"));
  EXPECT_TRUE(observer->wait_for(OpenRTM::CONFIGURATION, "UPDATE_CONFIG_SET: default"));
  EXPECT_TRUE(observer->wait_for(OpenRTM::RTC_STATUS, "ERROR:0"));
  probe->reset(0);
  EXPECT_TRUE(observer->wait_for(OpenRTM::RTC_STATUS, "INACTIVE:0", 3)) << "deactivated, left by the error, reset";
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

TEST_F(ComponentObserverTest, heartbeats_come_no_faster_than_asked_and_end_when_asked) {
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

TEST_F(ComponentObserverTest, tells_an_observer_of_the_second_version_only_what_it_asked_for) {
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  Served<NewObserver> observer;
  ASSERT_TRUE(configuration->add_service_profile(
      service_profile("two", "IDL:omg.org/RTC/ComponentObserver:1.0", observer.reference(),
                      {{"observed_status", "RTC_STATUS"}, {"ec_heartbeat.enable", "YES"}, {"ec_heartbeat.interval", "0.02"}})));
  EXPECT_TRUE(observer->wait_for(RTC::EC_HEARTBEAT, ""));
  set("fail", "");
  probe->activate(0);
  EXPECT_TRUE(observer->wait_for(RTC::RTC_STATUS, "ACTIVE:0"));
  std::lock_guard lock(observer->mutex);
  for (const auto& [kind, hint] : observer->heard) EXPECT_NE(kind, RTC::CONFIGURATION) << hint;
}

TEST_F(ComponentObserverTest, has_no_more_observers_than_there_may_be_threads) {
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  Served<OldObserver> observer;
  const auto add = [&](int number) {
    return configuration->add_service_profile(
        service_profile(std::to_string(number).c_str(), "IDL:OpenRTM/ComponentObserver:1.0", observer.reference()));
  };
  for (int number = 0; number < 256; ++number) ASSERT_TRUE(add(number)) << number;
  EXPECT_FALSE(add(256));
  EXPECT_TRUE(add(3)) << "one that is known may change";
  ASSERT_TRUE(configuration->remove_service_profile("7"));
  EXPECT_TRUE(add(257));
}

TEST_F(ComponentObserverTest, tells_observers_what_changes_in_ports_profile_and_state_machine) {
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

  ASSERT_EQ(connect(out, in), RTC::RTC_OK);
  out.write();
  for (const char* hint : {"CONNECT:Probe0.in", "CONNECT:Probe0.out", "SEND:OutPort:Probe0.out", "RECEIVE:InPort:Probe0.in"}) {
    EXPECT_TRUE(old_observer->wait_for(OpenRTM::PORT_PROFILE, hint)) << hint;
    EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, hint)) << hint;
  }
  EXPECT_EQ(out.disconnect_all(), RTC::RTC_OK);
  EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, "DISCONNECT:Probe0.in"));
  EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, "DISCONNECT:Probe0.out"));
  RTC::InPort<RTC::TimedLong> late("late", value);
  probe->addInPort("late", late);
  EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, "ADD:Probe0.late"));
  ASSERT_EQ(connect(out, late), RTC::RTC_OK);
  out.write();
  EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, "RECEIVE:InPort:Probe0.late"));
  probe->removeInPort(late);
  EXPECT_TRUE(observer->wait_for(RTC::PORT_PROFILE, "REMOVE:Probe0.late"));

  probe->setInstanceName("Probe1");
  EXPECT_TRUE(old_observer->wait_for(OpenRTM::COMPONENT_PROFILE, "Probe1"));
  EXPECT_TRUE(observer->wait_for(RTC::COMPONENT_PROFILE, "Probe1"));
  probe->notifyObservers(RTC::RTObject_impl::Status::user_defined, "low battery");
  EXPECT_TRUE(observer->wait_for(RTC::USER_DEFINED, "low battery"));
  {
    RTC::Machine<Lamp> machine(&*probe);
    machine.add_event_profile("press", "");
    EXPECT_TRUE(observer->wait_for(RTC::FSM_PROFILE, "press"));
    EXPECT_TRUE(observer->wait_for(RTC::FSM_STRUCTURE, "Lamp"));
    machine->press();
    EXPECT_TRUE(observer->wait_for(RTC::FSM_STATUS, "Dark PRE_ONEXIT"));
    EXPECT_TRUE(observer->wait_for(RTC::FSM_STATUS, "Lit POST_ONENTRY"));
  }
  {
    std::lock_guard lock(old_observer->mutex);
    for (const auto& [kind, hint] : old_observer->heard) EXPECT_LT(kind, OpenRTM::HEARTBEAT) << hint;
  }
  probe->removeInPort(in);
  probe->removeOutPort(out);
}

// Tools show a light at each port; they need no message for each of a thousand samples.
TEST_F(ComponentObserverTest, samples_are_told_once_a_second_unless_asked_for_more) {
  RTC::TimedLong value{};
  RTC::InPort<RTC::TimedLong> in("in", value);
  RTC::OutPort<RTC::TimedLong> out("out", value);
  probe->addInPort("in", in);
  probe->addOutPort("out", out);
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  Served<NewObserver> usual, eager;
  ASSERT_TRUE(configuration->add_service_profile(service_profile("usual", "IDL:omg.org/RTC/ComponentObserver:1.0", usual.reference())));
  ASSERT_TRUE(configuration->add_service_profile(service_profile("eager", "IDL:omg.org/RTC/ComponentObserver:1.0", eager.reference(),
                                                                 {{"port_profile.receive_event.min_interval", "0.001"}})));
  ASSERT_EQ(connect(out, in), RTC::RTC_OK);
  const auto start = std::chrono::steady_clock::now();
  const auto count = [&](const char* hint) {
    std::lock_guard lock(usual->mutex);
    return std::count(usual->heard.begin(), usual->heard.end(), std::pair(RTC::PORT_PROFILE, std::string(hint)));
  };
  for (int i = 0; i < 20; ++i) {
    out.write();
    ASSERT_TRUE(eager->wait_for(RTC::PORT_PROFILE, "RECEIVE:InPort:Probe0.in", i + 1));
    std::this_thread::sleep_for(1ms);  // the interval asked for
  }
  EXPECT_TRUE(usual->wait_for(RTC::PORT_PROFILE, "SEND:OutPort:Probe0.out"));
  EXPECT_TRUE(usual->wait_for(RTC::PORT_PROFILE, "RECEIVE:InPort:Probe0.in"));
  EXPECT_LE(count("SEND:OutPort:Probe0.out"), 1 + (std::chrono::steady_clock::now() - start) / 1s);
  EXPECT_LE(count("RECEIVE:InPort:Probe0.in"), 1 + (std::chrono::steady_clock::now() - start) / 1s);
  {
    std::lock_guard lock(eager->mutex);
    EXPECT_LE(std::count(eager->heard.begin(), eager->heard.end(), std::pair(RTC::PORT_PROFILE, std::string("SEND:OutPort:Probe0.out"))),
              1 + (std::chrono::steady_clock::now() - start) / 1s)
        << "each kind has an interval of its own";
  }
  probe->removeInPort(in);
  probe->removeOutPort(out);
}

// A peer on a slow line.
class SlowObserver : public NewObserver {
 public:
  void update_status(RTC::StatusKind kind, const char* hint) override {
    std::this_thread::sleep_for(20ms);
    NewObserver::update_status(kind, hint);
  }
};

TEST_F(ComponentObserverTest, tells_the_end_of_a_component_before_it_has_ended) {
  RTC::TimedLong value{};
  RTC::InPort<RTC::TimedLong> in("in", value);
  probe->addInPort("in", in);
  probe->initialize();
  Served<SlowObserver> observer;
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  ASSERT_TRUE(configuration->add_service_profile(
      service_profile("end", "IDL:omg.org/RTC/ComponentObserver:1.0", observer.reference(), {{"observed_status", "ALL"}})));
  probe->activate(0);
  probe->exit();
  std::lock_guard lock(observer->mutex);
  EXPECT_THAT(observer->heard, Contains(std::pair(RTC::RTC_STATUS, std::string("FINALIZE:0"))));
  EXPECT_THAT(observer->heard, Not(Contains(std::pair(RTC::PORT_PROFILE, std::string("REMOVE:Probe0.in"))))) << "it ends with its ports";
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

TEST_F(ComponentObserverTest, publishes_log_records_to_a_logger) {
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

TEST_F(ComponentObserverTest, publishes_the_records_of_all_when_a_logger_asks_for_all) {
  probe->initialize();
  SDOPackage::Configuration_var configuration = probe->get_configuration();
  for (const char* filter : {"ALL", "A,L,L", ""}) {
    Served<LogReader> reader;
    ASSERT_TRUE(configuration->add_service_profile(
        service_profile("log", "IDL:OpenRTM/Logger:1.0", reader.reference(), {{"logger.log_level", "WARN"}, {"logger.filter", filter}})));
    RTC::Logger("Somebody").write(RTC::Logger::RTL_WARN, "for you");
    EXPECT_TRUE(configuration->remove_service_profile("log"));
    std::lock_guard lock(reader->mutex);
    ASSERT_THAT(reader->records, SizeIs(1)) << filter << ": what was written before it was removed";
    EXPECT_STREQ(reader->records[0].loggername, "Somebody");
  }
}

TEST_F(ComponentObserverTest, refuses_services_that_are_not_what_they_say) {
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

}  // namespace
