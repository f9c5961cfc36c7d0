// A component of another process, worked through its interfaces only, with what tools send and with what nobody should. Whatever comes is
// answered with a code of the contract, changes nothing, and the process lives on.
#include <gtest/gtest.h>
#include <rtm/NVUtil.h>

#include <atomic>
#include <limits>
#include <thread>

#include "support/component_process_fixture.h"
#include "support/orb_environment.h"

namespace {

using support::ComponentProcessTest;
using support::Owned;

const std::string megabyte(1 << 20, 'x');

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

}  // namespace
