#include <gtest/gtest.h>
#include <rtm/idl/DataPort_OpenRTMSkel.h>

#include "ports/support.h"

namespace {

class Service : public POA_OpenRTM::InPortCdr, public PortableServer::RefCountServantBase {
 public:
  OpenRTM::PortStatus put(const OpenRTM::CdrData& data) override {
    return ++calls, data.length() ? OpenRTM::PORT_OK : OpenRTM::BUFFER_EMPTY;
  }
  int calls = 0;
};

class ServicePorts : public testing::Test {
 protected:
  ServicePorts() {
    provider_port.registerProvider("echo0", "Echo", service);
    consumer_port.registerConsumer("echo0", "Echo", consumer);
  }
  RTC::ConnectorProfile plan(ports::Pairs properties = {}) {
    auto made = ports::profile({consumer_port.getPortRef(), provider_port.getPortRef()});
    made.properties.length(0);
    for (const auto& [key, value] : properties) NVUtil::setStringValue(made.properties, key, value.c_str());
    return made;
  }

  std::unique_ptr<corba::Orb> orb = ports::start_orb();
  Service service;
  RTC::CorbaConsumer<OpenRTM::InPortCdr> consumer;
  RTC::CorbaPort provider_port{"P0.service"};
  RTC::CorbaPort consumer_port{"C0.service"};
};

TEST_F(ServicePorts, a_consumer_calls_while_the_provider_is_active) {
  auto made = plan();
  ASSERT_EQ(consumer_port.connect(made), RTC::RTC_OK);
  EXPECT_FALSE(NVUtil::toString(made.properties, "P0.port.service.provided.Echo.echo0").empty());
  EXPECT_FALSE(NVUtil::toString(made.properties, "port.Echo.echo0").empty());
  OpenRTM::CdrData octets;
  EXPECT_THROW(consumer->put(octets), CORBA::OBJECT_NOT_EXIST);
  for (int i = 0; i < 3; ++i) {
    provider_port.activateInterfaces();
    EXPECT_EQ(consumer->put(octets), OpenRTM::BUFFER_EMPTY);
    EXPECT_EQ(consumer._ptr()->put(octets), OpenRTM::BUFFER_EMPTY);
    provider_port.deactivateInterfaces();
    EXPECT_THROW(consumer->put(octets), CORBA::OBJECT_NOT_EXIST);
  }
  EXPECT_EQ(provider_port.disconnect(made.connector_id), RTC::RTC_OK);
  EXPECT_TRUE(CORBA::is_nil(consumer._ptr()));
  EXPECT_THROW(consumer->put(octets), CORBA::Exception);
}

TEST_F(ServicePorts, the_long_form_names_the_provider) {
  RTC::CorbaConsumer<OpenRTM::InPortCdr> named;
  RTC::CorbaPort port("D0.need");
  port.registerConsumer("other", "Whatever", named);
  auto made = ports::profile({port.getPortRef(), provider_port.getPortRef()});
  NVUtil::setStringValue(made.properties, "D0.port.need.required.Whatever.other", "P0.port.service.provided.Echo.echo0");
  ASSERT_EQ(port.connect(made), RTC::RTC_OK);
  provider_port.activateInterfaces();
  EXPECT_EQ(named->put(OpenRTM::CdrData()), OpenRTM::BUFFER_EMPTY);
}

TEST_F(ServicePorts, strict_connections_fail_where_best_effort_is_content) {
  RTC::CorbaConsumer<OpenRTM::InPortCdr> lonely;
  RTC::CorbaPort port("D0.need");
  port.registerConsumer("nobody0", "Nobody", lonely);
  auto best_effort = ports::profile({port.getPortRef(), provider_port.getPortRef()});
  EXPECT_EQ(port.connect(best_effort), RTC::RTC_OK);
  port.disconnect_all();
  auto strict = ports::profile({port.getPortRef(), provider_port.getPortRef()});
  NVUtil::setStringValue(strict.properties, "port.connection.strictness", "strict");
  EXPECT_EQ(port.connect(strict), RTC::RTC_ERROR);
  EXPECT_EQ(provider_port.getPortProfile().connector_profiles.length(), 0u);
  auto unbound = ports::profile({port.getPortRef(), provider_port.getPortRef()});
  NVUtil::setStringValue(unbound.properties, "port.connection.strictness", "strict");
  NVUtil::setStringValue(unbound.properties, "D0.port.need.required.Nobody.nobody0", "null");
  EXPECT_EQ(port.connect(unbound), RTC::RTC_OK);
}

TEST_F(ServicePorts, references_that_a_tool_sends_back_do_not_replace_our_own) {
  auto made = plan({{"port.Echo.echo0", "IOR:000000"}, {"P0.port.service.provided.Echo.echo0", "IOR:000000"}});
  ASSERT_EQ(consumer_port.connect(made), RTC::RTC_OK);
  provider_port.activateInterfaces();
  EXPECT_EQ(consumer->put(OpenRTM::CdrData()), OpenRTM::BUFFER_EMPTY);
}

TEST_F(ServicePorts, the_profile_lists_the_interfaces) {
  const auto shown = provider_port.getPortProfile();
  ASSERT_EQ(shown.interfaces.length(), 1u);
  EXPECT_STREQ(shown.interfaces[0].instance_name, "echo0");
  EXPECT_STREQ(shown.interfaces[0].type_name, "Echo");
  EXPECT_EQ(shown.interfaces[0].polarity, RTC::PROVIDED);
  EXPECT_EQ(NVUtil::toString(shown.properties, "port.port_type"), "CorbaPort");
  EXPECT_FALSE(provider_port.registerProvider("echo0", "Echo", service)) << "twice";
}

}  // namespace
