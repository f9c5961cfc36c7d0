#include <gtest/gtest.h>
#include <rtm/idl/DataPort_OpenRTMSkel.h>

#include "corba/orb/call_timeout.h"
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

TEST_F(ServicePorts, a_reference_of_an_earlier_life_binds_nobody) {
  CORBA::String_var stale;
  {
    ports::Peer peer;
    RTC::CorbaPort probe("D0.probe");
    auto made = ports::profile({probe.getPortRef(), peer.port("service")});
    ASSERT_EQ(probe.connect(made), RTC::RTC_OK);
    stale = CORBA::string_dup(NVUtil::toString(made.properties, "port.Echo.echo0").c_str());
  }
  RTC::CorbaPort nobody("E0.empty");
  for (const char* key : {"port.Echo.echo0", "Peer0.port.service.provided.Echo.echo0"}) {
    for (const char* strictness : {"best_effort", "strict"}) {
      auto made = ports::profile({consumer_port.getPortRef(), nobody.getPortRef()});
      NVUtil::setStringValue(made.properties, key, stale);
      NVUtil::setStringValue(made.properties, "C0.port.service.required.Echo.echo0", "Peer0.port.service.provided.Echo.echo0");
      NVUtil::setStringValue(made.properties, "port.connection.strictness", strictness);
      const bool is_strict = std::string_view(strictness) == "strict";
      EXPECT_EQ(consumer_port.connect(made), is_strict ? RTC::RTC_ERROR : RTC::RTC_OK) << key;
      EXPECT_TRUE(CORBA::is_nil(consumer._ptr()));
      consumer_port.disconnect_all();
      EXPECT_EQ(nobody.getPortProfile().connector_profiles.length(), 0u);
    }
  }
}

TEST_F(ServicePorts, a_provider_of_another_process_is_called_until_that_process_dies) {
  orb.reset();
  corba::OrbSettings settings;
  settings.peer_check_interval = std::chrono::milliseconds(20);
  auto watching = corba::Orb::start(settings);
  ASSERT_TRUE(watching);
  (*watching)->activate();
  RTC::CorbaConsumer<OpenRTM::InPortCdr> far;
  {
    RTC::CorbaPort port("D0.need");
    port.registerConsumer("mine", "Whatever", far);
    ports::Peer peer;
    const RTC::PortService_var service = peer.port("service");
    for (const bool is_first : {true, false}) {
      auto made = is_first ? ports::profile({port.getPortRef(), service}) : ports::profile({service, port.getPortRef()});
      NVUtil::setStringValue(made.properties, "D0.port.need.required.Whatever.mine", "Peer0.port.service.provided.Echo.echo0");
      NVUtil::setStringValue(made.properties, "port.connection.strictness", "strict");
      ASSERT_EQ(is_first ? port.connect(made) : service->connect(made), RTC::RTC_OK);
      EXPECT_EQ(far->put(OpenRTM::CdrData()), OpenRTM::PORT_OK);
      if (!is_first) break;  // this one stays
      EXPECT_EQ(service->disconnect(made.connector_id), RTC::RTC_OK);
      EXPECT_TRUE(CORBA::is_nil(far._ptr()));
    }
    peer.process().kill();
    EXPECT_TRUE(ports::eventually([&] { return port.getPortProfile().connector_profiles.length() == 0; }));
    EXPECT_TRUE(ports::eventually([&] { return CORBA::is_nil(far._ptr()); }));
    EXPECT_THROW(far->put(OpenRTM::CdrData()), CORBA::Exception);
  }
}

TEST_F(ServicePorts, a_provider_that_hangs_costs_a_caller_its_time_out_only) {
  RTC::CorbaConsumer<OpenRTM::InPortCdr> far;
  RTC::CorbaPort port("D0.need");
  port.registerConsumer("echo0", "Echo", far);
  ports::Peer peer;
  corba::set_port_call_timeout(std::chrono::milliseconds(300));
  auto made = ports::profile({port.getPortRef(), peer.port("service")});
  ASSERT_EQ(port.connect(made), RTC::RTC_OK);
  EXPECT_EQ(far->put(OpenRTM::CdrData()), OpenRTM::PORT_OK);
  peer.process().signal(SIGSTOP);
  // One thread of the peer may answer once more.
  EXPECT_TRUE(ports::eventually([&] {
    try {
      far->put(OpenRTM::CdrData());
      return false;
    } catch (const CORBA::SystemException&) {
      return true;
    }
  }));
  EXPECT_EQ(port.disconnect(made.connector_id), RTC::RTC_OK);
  EXPECT_TRUE(CORBA::is_nil(far._ptr()));
  corba::set_port_call_timeout(std::chrono::seconds(10));
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
