// A component of another process, the program component_peer, and what a tool sees of it. One thread at a time.
#pragma once

#include <gtest/gtest.h>
#include <rtm/NVUtil.h>

#include <stdexcept>
#include <string>

#include "support/component_fixture.h"
#include "support/paths.h"
#include "support/process.h"

namespace support {

// The program component_peer.
class PeerProcess {
 public:
  PeerProcess() : process_({std::string(paths::bin_dir) + "/component_peer"}) {
    if (!process_.wait_for_output("ready\n")) throw std::runtime_error("the peer does not start: " + process_.output());
    const std::string output = process_.output();
    const auto at = output.find("IOR:");
    int argc = 0;
    const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
    const CORBA::Object_var object = orb->string_to_object(output.substr(at, output.find('\n', at) - at).c_str());
    component = RTC::RTObject::_narrow(object);
  }
  support::Process& process() { return process_; }
  RTC::RTObject_var component;

 private:
  support::Process process_;
};

class ComponentProcessTest : public testing::Test {
 public:
  ComponentProcessTest() {
    component = peer.component;
    RTC::ExecutionContextList_var contexts = component->get_owned_contexts();
    context = RTC::ExecutionContextService::_narrow(contexts[0u]);
    configuration = component->get_configuration();
    SDOPackage::OrganizationList_var organizations = component->get_owned_organizations();
    organization = SDOPackage::Organization::_duplicate(organizations[0u]);
    RTC::PortServiceList_var ports = component->get_ports();
    in = RTC::PortService::_duplicate(ports[0u]);
    out = RTC::PortService::_duplicate(ports[1u]);
    before_ = look();
  }
  ~ComponentProcessTest() override {
    EXPECT_TRUE(peer.process().running());
    EXPECT_EQ(peer.process().stop(), 0) << peer.process().output();
  }

 protected:
  // What a tool sees of the component.
  std::string look() {
    const RTC::ComponentProfile_var profile = component->get_component_profile();
    std::string text = std::string(profile->instance_name) + " " + profile->type_name.in();
    for (CORBA::ULong i = 0; i < profile->port_profiles.length(); ++i)
      text +=
          " " + std::string(profile->port_profiles[i].name) + ":" + std::to_string(profile->port_profiles[i].connector_profiles.length());
    for (CORBA::ULong i = 0; i < profile->properties.length(); ++i)
      text +=
          std::string(" ") + profile->properties[i].name.in() + "=" + NVUtil::toString(profile->properties, profile->properties[i].name);
    const RTC::ExecutionContextProfile_var own = context->get_profile();
    text += " rate " + std::to_string(own->rate) + " members " + std::to_string(own->participants.length());
    text += " state " + std::to_string(context->get_component_state(component)) + (context->is_running() ? " running" : " stopped");
    RTC::ExecutionContextList_var foreign = component->get_participating_contexts();
    text += " foreign " + std::to_string(foreign->length());
    const SDOPackage::SDOList_var members = organization->get_members();
    SDOPackage::OrganizationList_var organizations = component->get_organizations();
    return text + " members " + std::to_string(members->length()) + " organizations " + std::to_string(organizations->length());
  }
  void expect_unchanged() { EXPECT_EQ(look(), before_); }

  RTC::ConnectorProfile connection(const char* id = "") {
    RTC::ConnectorProfile profile;
    profile.name = "test";
    profile.connector_id = id;
    profile.ports.length(2);
    profile.ports[0] = RTC::PortService::_duplicate(out);
    profile.ports[1] = RTC::PortService::_duplicate(in);
    NVUtil::setStringValue(profile.properties, "dataport.interface_type", "corba_cdr");
    NVUtil::setStringValue(profile.properties, "dataport.dataflow_type", "push");
    return profile;
  }

  // A reference that nobody answers any more.
  static CORBA::Object_var dead() {
    Owned<> corpse;
    corpse->initialize();
    RTC::RTObject_var reference = corpse->getObjRef();
    return CORBA::Object::_duplicate(reference);
  }

  PeerProcess peer;
  RTC::RTObject_var component;
  RTC::ExecutionContextService_var context;
  SDOPackage::Configuration_var configuration;
  SDOPackage::Organization_var organization;
  RTC::PortService_var in, out;

 private:
  std::string before_;
};

}  // namespace support
