// A component of another process, worked through its interfaces only, with what tools send and with what nobody should. Whatever comes is
// answered with a code of the contract, changes nothing, and the process lives on.
#include <gtest/gtest.h>
#include <rtm/NVUtil.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <limits>
#include <thread>

#include "support/component_fixture.h"
#include "support/orb_environment.h"
#include "support/paths.h"
#include "support/process.h"

namespace {

using namespace std::chrono_literals;
using support::ComponentTest;
using support::first_context;
using support::Owned;

const std::string megabyte(1 << 20, 'x');

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

TEST_F(ComponentProcessTest, is_all_that_it_inherits) {
  for (const char* id :
       {"IDL:openrtm.aist.go.jp/OpenRTM/DataFlowComponent:1.0", "IDL:omg.org/RTC/RTObject:1.0", "IDL:omg.org/RTC/DataFlowComponent:1.0",
        "IDL:omg.org/RTC/DataFlowComponentAction:1.0", "IDL:omg.org/RTC/LightweightRTObject:1.0", "IDL:omg.org/RTC/ComponentAction:1.0",
        "IDL:org.omg/SDOPackage/SDO:1.0", "IDL:org.omg/SDOPackage/SDOSystemElement:1.0"})
    EXPECT_TRUE(component->_is_a(id)) << id;
  for (const char* id :
       {"IDL:omg.org/RTC/ExecutionContextService:1.0", "IDL:omg.org/RTC/ExecutionContext:1.0", "IDL:org.omg/SDOPackage/SDOService:1.0"})
    EXPECT_TRUE(context->_is_a(id)) << id;
  for (const char* id : {"IDL:omg.org/RTC/PortService:1.0", "IDL:org.omg/SDOPackage/SDOService:1.0"}) EXPECT_TRUE(in->_is_a(id)) << id;
  EXPECT_TRUE(configuration->_is_a("IDL:org.omg/SDOPackage/Configuration:1.0"));
  EXPECT_TRUE(organization->_is_a("IDL:org.omg/SDOPackage/Organization:1.0"));
  EXPECT_FALSE(component->_is_a("IDL:omg.org/RTC/PortService:1.0"));
  EXPECT_FALSE(component->_is_a(""));
  EXPECT_FALSE(component->_is_a(megabyte.c_str()));
}

TEST_F(ComponentProcessTest, answers_handles_and_contexts_that_are_none) {
  for (const CORBA::Long handle : {-1, 1, 999, 1000, std::numeric_limits<CORBA::Long>::max(), std::numeric_limits<CORBA::Long>::min()}) {
    const RTC::ExecutionContext_var none = component->get_context(handle);
    EXPECT_TRUE(CORBA::is_nil(none)) << handle;
    EXPECT_EQ(component->detach_context(handle), RTC::BAD_PARAMETER) << handle;
  }
  EXPECT_EQ(component->detach_context(0), RTC::BAD_PARAMETER);
  EXPECT_LT(component->attach_context(RTC::ExecutionContext::_nil()), 0);
  EXPECT_LT(component->get_context_handle(RTC::ExecutionContext::_nil()), 0);
  EXPECT_FALSE(component->is_alive(RTC::ExecutionContext::_nil()));
  EXPECT_EQ(component->get_context_handle(context), 0);
  EXPECT_TRUE(component->is_alive(context));
  EXPECT_EQ(component->initialize(), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(component->finalize(), RTC::PRECONDITION_NOT_MET);
  expect_unchanged();
}

TEST_F(ComponentProcessTest, a_dead_context_may_be_attached_and_costs_nothing) {
  const CORBA::Object_var object = dead();
  const RTC::ExecutionContext_var ghost = RTC::ExecutionContext::_unchecked_narrow(object);
  const CORBA::Long handle = component->attach_context(ghost);
  EXPECT_EQ(handle, 1000);
  EXPECT_EQ(component->detach_context(handle), RTC::RTC_OK);
  expect_unchanged();
}

TEST_F(ComponentProcessTest, knows_no_services_of_strange_names) {
  for (const std::string& name : {std::string(), std::string("nobody"), megabyte}) {
    EXPECT_THROW(component->get_service_profile(name.c_str()), SDOPackage::InvalidParameter);
    EXPECT_THROW(component->get_sdo_service(name.c_str()), SDOPackage::InvalidParameter);
    EXPECT_THROW(component->get_status(name.c_str()), SDOPackage::InvalidParameter);
  }
  EXPECT_THROW(component->get_monitoring(), SDOPackage::InterfaceNotImplemented);
  expect_unchanged();
}

TEST_F(ComponentProcessTest, a_context_refuses_rates_that_are_none) {
  using Limits = std::numeric_limits<double>;
  for (const double rate :
       {0.0, -0.0, -1.0, Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), Limits::max(), Limits::denorm_min()})
    EXPECT_EQ(context->set_rate(rate), RTC::BAD_PARAMETER) << rate;
  expect_unchanged();
}

TEST_F(ComponentProcessTest, a_context_refuses_components_that_are_none) {
  const CORBA::Object_var ghost = dead();
  const std::pair<const char*, RTC::LightweightRTObject_var> strangers[] = {
      {"nil", RTC::LightweightRTObject::_nil()},
      {"dead", RTC::LightweightRTObject::_unchecked_narrow(ghost)},
      {"a port", RTC::LightweightRTObject::_unchecked_narrow(in)},
  };
  for (const auto& [what, stranger] : strangers) {
    const RTC::LightweightRTObject_var other = stranger;
    EXPECT_NE(context->add_component(other), RTC::RTC_OK) << what;
    EXPECT_EQ(context->remove_component(other), RTC::BAD_PARAMETER) << what;
    EXPECT_EQ(context->activate_component(other), RTC::BAD_PARAMETER) << what;
    EXPECT_EQ(context->deactivate_component(other), RTC::BAD_PARAMETER) << what;
    EXPECT_EQ(context->reset_component(other), RTC::BAD_PARAMETER) << what;
    EXPECT_EQ(context->get_component_state(other), RTC::CREATED_STATE) << what;
  }
  EXPECT_EQ(context->start(), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(context->deactivate_component(component), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(context->reset_component(component), RTC::PRECONDITION_NOT_MET);
  expect_unchanged();
}

TEST_F(ComponentProcessTest, a_component_joins_a_context_once_however_many_ask) {
  Owned<> probe;
  probe->initialize();
  const RTC::RTObject_var self = probe->getObjRef();
  std::atomic<int> taken{0};
  {
    std::vector<std::jthread> callers;
    for (int i = 0; i < 8; ++i)
      callers.emplace_back([&] {
        const RTC::ExecutionContextService_var target = context;
        if (RTC::ExecutionContextService_var(target)->add_component(RTC::RTObject_var(self)) == RTC::RTC_OK) ++taken;
      });
  }
  EXPECT_EQ(taken, 1);
  const RTC::ExecutionContextProfile_var profile = context->get_profile();
  EXPECT_EQ(profile->participants.length(), 1u);
  EXPECT_EQ(context->activate_component(self), RTC::RTC_OK);
  EXPECT_TRUE(probe->wait_for("onExecute", 3));
  EXPECT_EQ(context->deactivate_component(self), RTC::RTC_OK);
  EXPECT_EQ(context->remove_component(self), RTC::RTC_OK);
  expect_unchanged();
}

TEST_F(ComponentProcessTest, configuration_refuses_ids_that_are_none) {
  for (const std::string& id : {std::string(), std::string("nobody"), std::string("__widget__"), megabyte}) {
    EXPECT_THROW(configuration->activate_configuration_set(id.c_str()), SDOPackage::InvalidParameter) << id.substr(0, 20);
    EXPECT_FALSE([&] {
      try {
        return configuration->remove_configuration_set(id.c_str());
      } catch (const SDOPackage::InvalidParameter&) {
        return CORBA::Boolean(false);
      }
    }());
  }
  EXPECT_FALSE(configuration->remove_configuration_set("default"));
  EXPECT_THROW(configuration->get_configuration_set("nobody"), SDOPackage::InternalError);
  EXPECT_THROW(configuration->get_configuration_set(megabyte.c_str()), SDOPackage::InternalError);
  SDOPackage::ConfigurationSet set;
  for (const std::string& id : {std::string(), megabyte}) {
    set.id = id.c_str();
    EXPECT_THROW(configuration->add_configuration_set(set), SDOPackage::InvalidParameter);
    EXPECT_THROW(configuration->set_configuration_set_values(set), SDOPackage::InvalidParameter);
  }
  const SDOPackage::ConfigurationSet_var active = configuration->get_active_configuration_set();
  EXPECT_STREQ(active->id, "default");
  expect_unchanged();
}

TEST_F(ComponentProcessTest, values_that_are_no_text_are_skipped) {
  const SDOPackage::ConfigurationSet_var set = configuration->get_configuration_set("default");
  SDOPackage::ConfigurationSet strange;
  strange.id = "default";
  strange.configuration_data.length(2);
  strange.configuration_data[0].name = "gain";
  strange.configuration_data[0].value <<= CORBA::Double(7);
  strange.configuration_data[1].name = "how";
  strange.configuration_data[1].value <<= component.in();
  EXPECT_TRUE(configuration->set_configuration_set_values(strange));
  EXPECT_THROW(configuration->get_active_configuration_set(), SDOPackage::NotAvailable);
  EXPECT_TRUE(configuration->activate_configuration_set("default"));
  const SDOPackage::ConfigurationSet_var after = configuration->get_active_configuration_set();
  EXPECT_EQ(NVUtil::toString(after->configuration_data, "gain"), "1.5");
  expect_unchanged();
}

TEST_F(ComponentProcessTest, configuration_refuses_services_and_organizations_that_are_none) {
  const CORBA::Object_var ghost = dead();
  const auto add = [&](const char* id, const char* type, CORBA::Object_ptr service) {
    SDOPackage::ServiceProfile profile;
    profile.id = id;
    profile.interface_type = type;
    profile.service = SDOPackage::SDOService::_unchecked_narrow(service);
    return configuration->add_service_profile(profile);
  };
  for (const char* type : {"IDL:OpenRTM/ComponentObserver:1.0", "IDL:omg.org/RTC/ComponentObserver:1.0", "IDL:OpenRTM/Logger:1.0"}) {
    EXPECT_FALSE(add("a", type, CORBA::Object::_nil())) << type;
    EXPECT_FALSE(add("b", type, ghost)) << type;
    EXPECT_FALSE(add("c", type, in)) << type;
    EXPECT_FALSE(add("", type, in)) << type;
  }
  EXPECT_FALSE(add("d", "", in));
  EXPECT_FALSE(add("e", "IDL:omg.org/RTC/PortService:1.0", in));
  EXPECT_FALSE(add("f", megabyte.c_str(), in));
  EXPECT_THROW(configuration->remove_service_profile(""), SDOPackage::InvalidParameter);
  EXPECT_FALSE(configuration->remove_service_profile(megabyte.c_str()));
  EXPECT_THROW(configuration->add_organization(SDOPackage::Organization::_nil()), SDOPackage::InvalidParameter);
  EXPECT_THROW(configuration->remove_organization(""), SDOPackage::InvalidParameter);
  EXPECT_FALSE(configuration->remove_organization(megabyte.c_str()));
  expect_unchanged();
}

TEST_F(ComponentProcessTest, an_organization_refuses_members_that_are_none) {
  const CORBA::Object_var ghost = dead();
  SDOPackage::SDOList list;
  list.length(2);
  list[0] = SDOPackage::SDO::_duplicate(component);
  for (const SDOPackage::SDO_var& stranger :
       {SDOPackage::SDO_var(SDOPackage::SDO::_nil()), SDOPackage::SDO_var(SDOPackage::SDO::_unchecked_narrow(ghost)),
        SDOPackage::SDO_var(SDOPackage::SDO::_unchecked_narrow(in))}) {
    list[1] = SDOPackage::SDO::_duplicate(SDOPackage::SDO_var(stranger));
    EXPECT_THROW(organization->add_members(list), SDOPackage::InvalidParameter);
    EXPECT_THROW(organization->set_members(list), SDOPackage::InvalidParameter);
  }
  for (const std::string& name : {std::string(), std::string("nobody"), megabyte}) {
    EXPECT_THROW(organization->remove_member(name.c_str()), SDOPackage::InvalidParameter);
    EXPECT_THROW(organization->get_organization_property_value(name.c_str()), SDOPackage::InvalidParameter);
    EXPECT_THROW(organization->remove_organization_property(name.c_str()), SDOPackage::InvalidParameter);
  }
  EXPECT_THROW(organization->set_owner(SDOPackage::SDOSystemElement::_nil()), SDOPackage::InvalidParameter);
  const auto dependency = organization->get_dependency();
  const CORBA::Request_var no_enumerator = organization->_request("set_dependency");
  no_enumerator->add_in_arg() <<= CORBA::ULong{77};  // the same octets; the stub would refuse such an enumerator itself
  no_enumerator->set_return_type(CORBA::_tc_boolean);
  no_enumerator->invoke();
  EXPECT_NE(no_enumerator->env()->exception(), nullptr);
  EXPECT_EQ(organization->get_dependency(), dependency);
  expect_unchanged();
}

TEST_F(ComponentProcessTest, ports_refuse_connections_that_are_none) {
  RTC::ConnectorProfile profile = connection();
  profile.ports.length(1);  // without the InPort
  EXPECT_EQ(in->connect(profile), RTC::BAD_PARAMETER);
  profile.ports.length(0);
  EXPECT_EQ(out->connect(profile), RTC::BAD_PARAMETER);
  profile = connection();
  profile.ports[1] = RTC::PortService::_nil();
  EXPECT_EQ(out->connect(profile), RTC::BAD_PARAMETER);
  profile = connection();
  const CORBA::Object_var ghost = dead();
  profile.ports[1] = RTC::PortService::_unchecked_narrow(ghost);
  EXPECT_EQ(out->connect(profile), RTC::RTC_ERROR);
  profile = connection(megabyte.c_str());
  EXPECT_EQ(out->connect(profile), RTC::BAD_PARAMETER);
  profile = connection();
  EXPECT_EQ(out->notify_connect(profile), RTC::BAD_PARAMETER);
  for (const std::string& id : {std::string(), std::string("nobody"), megabyte}) {
    EXPECT_EQ(out->disconnect(id.c_str()), RTC::BAD_PARAMETER);
    EXPECT_EQ(out->notify_disconnect(id.c_str()), RTC::BAD_PARAMETER);
    const RTC::ConnectorProfile_var none = out->get_connector_profile(id.c_str());
    EXPECT_STREQ(none->connector_id, "");
  }
  expect_unchanged();
}

TEST_F(ComponentProcessTest, ports_that_are_connected_from_both_sides_at_once_have_one_connection) {
  for (int round = 0; round < 10; ++round) {
    std::atomic<int> made{0};
    const auto connect = [&](RTC::PortService_ptr asked, bool turned) {
      RTC::ConnectorProfile profile = connection();
      if (turned) {
        profile.ports[0] = RTC::PortService::_duplicate(in);
        profile.ports[1] = RTC::PortService::_duplicate(out);
      }
      if (asked->connect(profile) == RTC::RTC_OK) ++made;
    };
    {
      std::jthread one([&] { connect(out, false); });
      std::jthread two([&] { connect(in, true); });
    }
    const RTC::ConnectorProfileList_var profiles = in->get_connector_profiles();
    EXPECT_LE(made, 1);
    EXPECT_EQ(static_cast<int>(profiles->length()), made.load());
    EXPECT_EQ(in->disconnect_all(), RTC::RTC_OK);
  }
  RTC::ConnectorProfile profile = connection("same");
  EXPECT_EQ(out->connect(profile), RTC::RTC_OK);
  profile = connection("same");
  EXPECT_EQ(out->connect(profile), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(in->connect(profile), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(in->disconnect("same"), RTC::RTC_OK);
  expect_unchanged();
}

// --- peers that end badly

TEST_F(ComponentTest, a_member_of_another_process_that_is_killed_costs_the_others_nothing) {
  probe->initialize();
  PeerProcess peer;
  const RTC::ExecutionContext_var context = first_context(*probe);
  const RTC::RTObject_var self = probe->getObjRef();
  const RTC::ExecutionContext_var own = context;
  ASSERT_EQ(RTC::ExecutionContext_var(own)->add_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(RTC::ExecutionContext_var(own)->activate_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onExecute", 3));
  peer.process().kill();
  const int seen = probe->count("onExecute");
  EXPECT_TRUE(probe->wait_for("onExecute", seen + 50));
  EXPECT_EQ(RTC::ExecutionContext_var(own)->remove_component(peer.component), RTC::RTC_OK);
  EXPECT_EQ(state(), RTC::ACTIVE_STATE);
  EXPECT_EQ(probe->deactivate(0), RTC::RTC_OK);
}

TEST_F(ComponentTest, what_remains_of_a_killed_owner_is_forgotten_at_exit) {
  probe->initialize();
  PeerProcess peer;
  RTC::ExecutionContextList_var contexts = peer.component->get_owned_contexts();
  const RTC::RTObject_var self = probe->getObjRef();
  ASSERT_EQ(contexts[0u]->add_component(self), RTC::RTC_OK);
  ASSERT_EQ(contexts[0u]->activate_component(self), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onExecute", 3));
  peer.process().kill();
  EXPECT_EQ(probe->exit(), RTC::RTC_OK);
}

// Stopped, so that its connections stay open and nobody answers.
void freeze(support::Process& process) {
  process.signal(SIGSTOP);
  const auto is_stopped = [&] {
    std::ifstream file("/proc/" + std::to_string(process.pid()) + "/stat");
    std::string text;
    std::getline(file, text);
    return text.find(") T ") != std::string::npos;
  };
  while (!is_stopped()) std::this_thread::sleep_for(1ms);
}

TEST_F(ComponentTest, a_member_of_another_process_that_hangs_costs_the_others_one_time_out_at_most) {
  probe->initialize();
  Owned<> neighbour(nullptr, "Neighbour0");  // has a context of its own
  neighbour->initialize();
  PeerProcess peer;
  const RTC::ExecutionContext_var context = first_context(*probe);
  const auto of_probe = [&] { return RTC::ExecutionContextService::_narrow(context); };
  ASSERT_EQ(RTC::ExecutionContextService_var(of_probe())->add_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(RTC::ExecutionContextService_var(of_probe())->activate_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  ASSERT_EQ(neighbour->activate(0), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onExecute", 3));
  freeze(peer.process());
  // Whoever is in another context, and tools, notice nothing; the context itself goes on after a time-out of the call, and only one.
  const int seen = neighbour->count("onExecute");
  for (int i = 0; i < 20; ++i) {
    RTC::ExecutionContextService_var service = of_probe();
    const RTC::ExecutionContextProfile_var profile = service->get_profile();
    EXPECT_EQ(profile->participants.length(), 1u);
    const RTC::RTObject_var self = probe->getObjRef();
    EXPECT_EQ(service->get_component_state(self), RTC::ACTIVE_STATE);
    EXPECT_TRUE(neighbour->wait_for("onExecute", seen + i));
  }
  const int before = probe->count("onExecute");
  EXPECT_TRUE(probe->wait_for("onExecute", before + 50));
  RTC::ExecutionContextService_var service = of_probe();
  while (service->get_component_state(peer.component) != RTC::ERROR_STATE) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(probe->deactivate(0), RTC::RTC_OK);
  EXPECT_EQ(service->remove_component(peer.component), RTC::RTC_OK);
  peer.process().signal(SIGCONT);
}

// On a busy machine, in lock step: the run waits, and goes on as if nothing had been.
TEST_F(ComponentTest, a_member_of_another_process_is_waited_for_as_long_as_the_context_says) {
  probe->getProperties()["exec_cxt.member_timeout"] = "60";
  probe->initialize();
  PeerProcess peer;
  const RTC::ExecutionContext_var context = first_context(*probe);
  const RTC::ExecutionContextService_var service = RTC::ExecutionContextService::_narrow(context);
  ASSERT_EQ(service->add_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(service->activate_component(peer.component), RTC::RTC_OK);
  ASSERT_EQ(probe->activate(0), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onExecute", 3));
  freeze(peer.process());
  std::this_thread::sleep_for(1500ms);  // longer than it has by default
  const int before = probe->count("onExecute");
  peer.process().signal(SIGCONT);
  EXPECT_TRUE(probe->wait_for("onExecute", before + 10));
  EXPECT_EQ(service->get_component_state(peer.component), RTC::ACTIVE_STATE);
  EXPECT_EQ(probe->deactivate(0), RTC::RTC_OK);
  EXPECT_EQ(service->remove_component(peer.component), RTC::RTC_OK);
}

TEST_F(ComponentTest, a_context_of_another_process_that_hangs_does_not_keep_a_component_from_leaving) {
  probe->getProperties()["exec_cxt.callback_timeout"] = "0.2";
  probe->initialize();
  PeerProcess peer;
  RTC::ExecutionContextList_var contexts = peer.component->get_owned_contexts();
  const RTC::RTObject_var self = probe->getObjRef();
  ASSERT_EQ(contexts[0u]->add_component(self), RTC::RTC_OK);
  ASSERT_EQ(contexts[0u]->activate_component(self), RTC::RTC_OK);
  ASSERT_TRUE(probe->wait_for("onExecute", 3));
  freeze(peer.process());
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(probe->exit(), RTC::RTC_OK);
  EXPECT_LT(std::chrono::steady_clock::now() - began, 5s) << "half of the time-out of other calls";
  EXPECT_EQ(probe->count("onFinalize"), 1);
  peer.process().signal(SIGCONT);
}

// Callbacks called over the wire, by the test instead of an execution context of its own. component_peer prints what must not happen.
class OutsideCallsTest : public ComponentProcessTest {
 public:
  OutsideCallsTest() {
    host->initialize();
    foreign = first_context(*host);
  }
  ~OutsideCallsTest() override {
    const std::string output = peer.process().output();
    EXPECT_EQ(output.find("overlap "), std::string::npos) << output;
    EXPECT_EQ(output.find("late "), std::string::npos) << output;
  }

 protected:
  using Operation = std::function<RTC::ReturnCode_t(CORBA::Long)>;
  std::vector<std::pair<std::string, Operation>> operations() {
    auto* target = component.in();
    return {{"on_startup", [=](CORBA::Long handle) { return target->on_startup(handle); }},
            {"on_shutdown", [=](CORBA::Long handle) { return target->on_shutdown(handle); }},
            {"on_activated", [=](CORBA::Long handle) { return target->on_activated(handle); }},
            {"on_deactivated", [=](CORBA::Long handle) { return target->on_deactivated(handle); }},
            {"on_aborting", [=](CORBA::Long handle) { return target->on_aborting(handle); }},
            {"on_error", [=](CORBA::Long handle) { return target->on_error(handle); }},
            {"on_reset", [=](CORBA::Long handle) { return target->on_reset(handle); }},
            {"on_execute", [this](CORBA::Long handle) { return flow()->on_execute(handle); }},
            {"on_state_update", [this](CORBA::Long handle) { return flow()->on_state_update(handle); }},
            {"on_rate_changed", [this](CORBA::Long handle) { return flow()->on_rate_changed(handle); }}};
  }
  // On each call its own reference: one may be used by several threads.
  RTC::DataFlowComponentAction_var flow() { return RTC::DataFlowComponentAction::_narrow(component); }
  void set(const char* key, const char* callbacks) {
    SDOPackage::ConfigurationSet set;
    set.id = "default";
    set.configuration_data.length(1);
    set.configuration_data[0].name = key;
    set.configuration_data[0].value <<= callbacks;
    configuration->set_configuration_set_values(set);
    configuration->activate_configuration_set("default");
  }
  bool is_printed(const std::string& text) { return peer.process().wait_for_output(text); }

  Owned<> host{nullptr, "Host0"};
  RTC::ExecutionContext_var foreign;
};

TEST_F(OutsideCallsTest, handles_that_no_context_of_another_process_has_are_refused) {
  for (const CORBA::Long handle :
       {-1, 0, 1, 999, 1000, 1001, std::numeric_limits<CORBA::Long>::max(), std::numeric_limits<CORBA::Long>::min()})
    for (const auto& [name, call] : operations()) EXPECT_EQ(call(handle), RTC::PRECONDITION_NOT_MET) << name << " " << handle;
  expect_unchanged();
}

TEST_F(OutsideCallsTest, what_the_runtime_calls_once_in_a_life_is_refused_however_often_it_is_asked_for) {
  const std::size_t before = peer.process().output().size();
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(component->on_initialize(), RTC::PRECONDITION_NOT_MET);
    ASSERT_EQ(component->on_finalize(), RTC::PRECONDITION_NOT_MET);
    ASSERT_EQ(component->initialize(), RTC::PRECONDITION_NOT_MET);
    ASSERT_EQ(component->finalize(), RTC::PRECONDITION_NOT_MET);
  }
  expect_unchanged();
  EXPECT_LT(peer.process().output().size() - before, 100000u) << "8000 calls leave few lines in the log";
}

TEST_F(OutsideCallsTest, a_context_of_another_process_calls_what_its_state_of_the_component_allows) {
  const CORBA::Long handle = component->attach_context(foreign);
  ASSERT_GE(handle, 1000);
  const auto refused = RTC::PRECONDITION_NOT_MET;
  EXPECT_EQ(component->on_startup(handle), RTC::RTC_OK);
  EXPECT_EQ(flow()->on_execute(handle), refused) << "not active yet";
  EXPECT_EQ(flow()->on_state_update(handle), refused);
  EXPECT_EQ(component->on_deactivated(handle), refused);
  EXPECT_EQ(component->on_activated(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_activated(handle), refused) << "active already";
  EXPECT_EQ(component->on_error(handle), refused);
  EXPECT_EQ(flow()->on_execute(handle), RTC::RTC_OK);
  EXPECT_EQ(flow()->on_state_update(handle), RTC::RTC_OK);
  EXPECT_EQ(flow()->on_rate_changed(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_deactivated(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_aborting(handle), RTC::RTC_OK) << "what contexts call after a failure";
  EXPECT_EQ(component->on_error(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_reset(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_activated(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_aborting(handle), RTC::RTC_OK) << "some leave out on_deactivated";
  EXPECT_EQ(flow()->on_execute(handle), refused);
  EXPECT_EQ(component->on_reset(handle), RTC::RTC_OK);
  EXPECT_EQ(component->on_shutdown(handle), RTC::RTC_OK);
  EXPECT_EQ(component->attach_context(foreign), handle) << "the same one again";
  EXPECT_EQ(component->detach_context(handle), RTC::RTC_OK);
  for (const auto& [name, call] : operations()) EXPECT_EQ(call(handle), refused) << name;
}

TEST_F(OutsideCallsTest, nobody_outside_calls_with_the_handle_of_a_context_of_the_components_own_process) {
  const CORBA::Long handle = component->attach_context(context);
  ASSERT_GE(handle, 1000);
  for (const auto& [name, call] : operations()) EXPECT_EQ(call(handle), RTC::PRECONDITION_NOT_MET) << name;
  EXPECT_EQ(component->detach_context(handle), RTC::RTC_OK);
}

TEST_F(OutsideCallsTest, callbacks_that_eight_connections_call_never_overlap) {
  ASSERT_EQ(context->set_rate(1000), RTC::RTC_OK);
  ASSERT_EQ(context->activate_component(component), RTC::RTC_OK);
  const CORBA::Long handle = component->attach_context(foreign);
  ASSERT_EQ(component->on_activated(handle), RTC::RTC_OK);
  std::atomic<int> carried_out{0}, others{0};
  {
    std::vector<std::jthread> callers;
    for (int i = 0; i < 8; ++i)
      callers.emplace_back([&] {
        for (int n = 0; n < 200; ++n) {
          for (const auto code : {flow()->on_execute(handle), flow()->on_state_update(handle), flow()->on_rate_changed(handle)}) {
            if (code == RTC::RTC_OK) ++carried_out;
            if (code != RTC::RTC_OK && code != RTC::PRECONDITION_NOT_MET) ++others;
          }
        }
      });
  }
  EXPECT_GT(carried_out, 1000);
  EXPECT_EQ(others, 0);
  EXPECT_EQ(component->on_deactivated(handle), RTC::RTC_OK);
  EXPECT_EQ(context->get_component_state(component), RTC::ACTIVE_STATE) << "in its own context";
}

TEST_F(OutsideCallsTest, who_comes_while_a_callback_runs_waits_a_while_and_is_answered) {
  const CORBA::Long handle = component->attach_context(foreign);
  ASSERT_EQ(component->on_activated(handle), RTC::RTC_OK);
  set("held", "onExecute");
  std::jthread caller([&] { EXPECT_EQ(flow()->on_execute(handle), RTC::RTC_OK); });
  ASSERT_TRUE(is_printed("held onExecute"));
  EXPECT_EQ(flow()->on_rate_changed(handle), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(component->on_deactivated(handle), RTC::PRECONDITION_NOT_MET);
  set("held", "");
  caller.join();
  EXPECT_EQ(component->on_deactivated(handle), RTC::RTC_OK);
}

// onExecute calls the context, which calls the component back before it answers.
TEST_F(OutsideCallsTest, a_call_that_comes_back_into_the_component_ends_and_so_does_the_callback) {
  ASSERT_EQ(foreign->add_component(component), RTC::RTC_OK);
  ASSERT_EQ(foreign->activate_component(component), RTC::RTC_OK);
  const double before = foreign->get_rate();
  set("asking", "onExecute");
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (foreign->get_rate() < before + 2 && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(1ms);
  EXPECT_GE(foreign->get_rate(), before + 2) << "it goes on";
  set("asking", "");
  EXPECT_EQ(foreign->get_component_state(component), RTC::ACTIVE_STATE);
  EXPECT_EQ(foreign->remove_component(component), RTC::RTC_OK);
}

TEST_F(OutsideCallsTest, a_component_ends_once_whatever_is_called_meanwhile) {
  const CORBA::Long handle = component->attach_context(foreign);
  ASSERT_EQ(component->on_activated(handle), RTC::RTC_OK);
  std::atomic<int> ended{0}, others{0};
  {
    std::vector<std::jthread> callers;
    for (int i = 0; i < 8; ++i)
      callers.emplace_back([&, i] {
        try {
          for (int n = 0; n < 100; ++n) {
            for (const auto code : {component->initialize(), component->finalize(), component->on_finalize(), component->on_initialize()})
              if (code != RTC::PRECONDITION_NOT_MET) ++others;
            flow()->on_execute(handle);
            if (n == 10 + i && component->exit() == RTC::RTC_OK) ++ended;
          }
        } catch (const CORBA::SystemException&) {
          // The object is gone.
        }
      });
  }
  EXPECT_EQ(ended, 1);
  EXPECT_EQ(others, 0);
}

}  // namespace
