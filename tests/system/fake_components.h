// Components of a running system as values, and objects that answer as a test wants, without a process or a name server.
#pragma once

#include <rtm/idl/RTCSkel.h>

#include <string>
#include <vector>

#include "system/component_view.h"
#include "system/orb.h"

namespace tools {

// An execution context that answers each transition with `answer`. Its state changes with the n-th look at it, n = `looks_until_done`.
class FakeContext : public POA_RTC::ExecutionContext, public PortableServer::RefCountServantBase {
 public:
  RTC::ReturnCode_t answer = RTC::RTC_OK;
  RTC::LifeCycleState before = RTC::INACTIVE_STATE, after = RTC::ACTIVE_STATE;
  int looks_until_done = 0;
  int calls = 0, looks = 0;

  CORBA::Boolean is_running() override { return true; }
  RTC::ReturnCode_t start() override { return RTC::RTC_OK; }
  RTC::ReturnCode_t stop() override { return RTC::RTC_OK; }
  CORBA::Double get_rate() override { return 100; }
  RTC::ReturnCode_t set_rate(CORBA::Double) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t add_component(RTC::LightweightRTObject_ptr) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t remove_component(RTC::LightweightRTObject_ptr) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t activate_component(RTC::LightweightRTObject_ptr) override { return ++calls, answer; }
  RTC::ReturnCode_t deactivate_component(RTC::LightweightRTObject_ptr) override { return ++calls, answer; }
  RTC::ReturnCode_t reset_component(RTC::LightweightRTObject_ptr) override { return ++calls, answer; }
  RTC::LifeCycleState get_component_state(RTC::LightweightRTObject_ptr) override { return ++looks > looks_until_done ? after : before; }
  RTC::ExecutionKind get_kind() override { return RTC::PERIODIC; }
};

// A port that keeps what it was asked for, and answers with `answer`.
class FakePort : public POA_RTC::PortService, public PortableServer::RefCountServantBase {
 public:
  RTC::ReturnCode_t answer = RTC::RTC_OK;
  RTC::ConnectorProfileList connectors;
  std::vector<RTC::ConnectorProfile> asked;
  std::vector<std::string> disconnected;

  RTC::PortProfile* get_port_profile() override { return new RTC::PortProfile(); }
  RTC::ConnectorProfileList* get_connector_profiles() override { return new RTC::ConnectorProfileList(connectors); }
  RTC::ConnectorProfile* get_connector_profile(const char*) override { return new RTC::ConnectorProfile(); }
  RTC::ReturnCode_t connect(RTC::ConnectorProfile& profile) override { return asked.push_back(profile), answer; }
  RTC::ReturnCode_t disconnect(const char* id) override { return disconnected.emplace_back(id), answer; }
  RTC::ReturnCode_t disconnect_all() override { return RTC::RTC_OK; }
  RTC::ReturnCode_t notify_connect(RTC::ConnectorProfile&) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t notify_disconnect(const char*) override { return RTC::RTC_OK; }
};

// Keeps the servant for as long as the test, and its reference.
template <class Servant>
struct Served {
  Servant* servant = new Servant();
  PortableServer::Servant_var<Servant> owner{servant};
  Servant* operator->() const { return servant; }
};

inline PortView port_view(const std::string& full_name, const std::string& port_type,
                          const std::string& data_type = "IDL:RTC/TimedLong:1.0") {
  PortView port;
  port.full_name = full_name;
  port.name = full_name.substr(full_name.find('.') + 1);
  port.properties = {{"port.port_type", port_type}, {"dataport.data_type", data_type}};
  return port;
}

inline ComponentView component_view(const std::string& instance, RTC::LifeCycleState state = RTC::INACTIVE_STATE) {
  ComponentView view;
  view.path = "/localhost/" + instance + ".rtc";
  view.segments = {"localhost", instance + ".rtc"};
  view.instance = instance;
  view.contexts.emplace_back();
  view.contexts.back().is_running = true;
  view.contexts.back().state = state;
  return view;
}

}  // namespace tools
