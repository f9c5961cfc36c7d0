// Peers that do what a test wants, and ports that meet them.
#pragma once

#include <gtest/gtest.h>
#include <rtm/idl/DataPort_OpenRTMSkel.h>

#include <atomic>
#include <functional>
#include <memory>

#include "corba/orb/nv_list.h"
#include "ports/support.h"

namespace ports {

// An InPortCdr that does what a test wants.
class StrangeInPort : public POA_OpenRTM::InPortCdr, public PortableServer::RefCountServantBase {
 public:
  explicit StrangeInPort(std::function<OpenRTM::PortStatus()> answer) : answer_(std::move(answer)) {}
  OpenRTM::PortStatus put(const OpenRTM::CdrData&) override { return answer_(); }

 private:
  std::function<OpenRTM::PortStatus()> answer_;
};

// A port that publishes such an object, as a peer of any make would.
class StrangePort : public POA_RTC::PortService, public PortableServer::RefCountServantBase {
 public:
  StrangePort(const char* key, CORBA::Object_ptr object) : key_(key), object_(CORBA::Object::_duplicate(object)) {}
  RTC::PortProfile* get_port_profile() override { return new RTC::PortProfile(); }
  RTC::ConnectorProfileList* get_connector_profiles() override { return new RTC::ConnectorProfileList(); }
  RTC::ConnectorProfile* get_connector_profile(const char*) override { return new RTC::ConnectorProfile(); }
  RTC::ReturnCode_t connect(RTC::ConnectorProfile&) override { return RTC::RTC_ERROR; }
  RTC::ReturnCode_t disconnect(const char*) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t disconnect_all() override { return RTC::RTC_OK; }
  RTC::ReturnCode_t notify_connect(RTC::ConnectorProfile& plan) override {
    if (on_connect) on_connect();
    int argc = 0;
    const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
    const CORBA::String_var text = orb->object_to_string(object_);
    NVUtil::setStringValue(plan.properties, key_, text.in());
    return answer;
  }
  RTC::ReturnCode_t notify_disconnect(const char*) override { return ++disconnects, RTC::RTC_OK; }

  std::function<void()> on_connect;
  RTC::ReturnCode_t answer = RTC::RTC_OK;
  std::atomic<int> disconnects{0};

 private:
  const char* key_;
  CORBA::Object_var object_;
};

struct Count : RTC::ConnectorListener {
  explicit Count(std::atomic<int>& n) : n(n) {}
  ReturnCode operator()(RTC::ConnectorInfo&) override { return ++n, NO_CHANGE; }
  std::atomic<int>& n;
};

class Faults : public testing::Test {
 protected:
  std::unique_ptr<corba::Orb> orb = start_orb();
  RTC::TimedLong sent{};
  RTC::TimedLong received{};
  RTC::OutPort<RTC::TimedLong> out{"A0.out", sent};
  RTC::InPort<RTC::TimedLong> in{"B0.in", received};

  // The object through which the OutPort would send to the InPort.
  OpenRTM::InPortCdr_var connect_and_steal(Pairs properties = {}) {
    auto plan = profile({out.getPortRef(), in.getPortRef()}, properties);
    EXPECT_EQ(out.connect(plan), RTC::RTC_OK);
    const CORBA::Object_var object =
        orb->orb()->string_to_object(NVUtil::toString(plan.properties, "dataport.corba_cdr.inport_ior").c_str());
    return OpenRTM::InPortCdr::_narrow(object);
  }
};

}  // namespace ports
