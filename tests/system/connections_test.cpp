#include "system/connections.h"

#include <gtest/gtest.h>

#include "system/fake_components.h"

namespace tools {
namespace {

class ConnectionsTest : public testing::Test {
 protected:
  ConnectionsTest() {
    out_view_.object = out_->_this();
    in_view_.object = in_->_this();
  }
  Result<void> connect(const Properties& properties = {}) { return connect_ports({&out_view_, &in_view_}, "id1", "", properties); }
  std::string error(const Properties& properties = {}) {
    const auto done = connect(properties);
    return done ? "" : done.error().message;
  }

  const Orb orb_;
  Served<FakePort> out_, in_;
  PortView out_view_ = port_view("A0.out", "DataOutPort"), in_view_ = port_view("B0.in", "DataInPort");
};

TEST_F(ConnectionsTest, the_first_port_is_asked_with_what_a_data_connection_needs) {
  ASSERT_TRUE(connect({{"dataport.subscription_type", "new"}}));
  ASSERT_EQ(out_->asked.size(), 1u);
  EXPECT_TRUE(in_->asked.empty());
  const auto& profile = out_->asked.front();
  EXPECT_STREQ(profile.connector_id.in(), "id1");
  EXPECT_STREQ(profile.name.in(), "A0.out_B0.in");
  ASSERT_EQ(profile.ports.length(), 2u);
  EXPECT_TRUE(profile.ports[1]->_is_equivalent(in_view_.object));
  const Properties expected = {{"dataport.data_type", "IDL:RTC/TimedLong:1.0"},
                               {"dataport.dataflow_type", "push"},
                               {"dataport.interface_type", "corba_cdr"},
                               {"dataport.subscription_type", "new"}};
  EXPECT_EQ(to_properties(profile.properties), expected);
}

TEST_F(ConnectionsTest, two_ports_of_one_direction_are_not_connected) {
  out_view_.properties["port.port_type"] = "DataInPort";
  EXPECT_EQ(error(), "ports A0.out and B0.in: are both DataInPort, expected an OutPort and an InPort");
  EXPECT_TRUE(out_->asked.empty());
}

TEST_F(ConnectionsTest, ports_of_different_types_are_connected_with_an_encoding_only) {
  in_view_.properties["dataport.data_type"] = "IDL:RTC/TimedDouble:1.0";
  EXPECT_EQ(error(), "ports A0.out and B0.in: carry different types, IDL:RTC/TimedLong:1.0 and IDL:RTC/TimedDouble:1.0");
  EXPECT_EQ(error({{"dataport.marshaling_type", "json"}}), "");
}

TEST_F(ConnectionsTest, a_port_of_events_takes_every_type) {
  in_view_.properties["dataport.data_type"] = "Any";
  EXPECT_EQ(error(), "");
}

TEST_F(ConnectionsTest, a_property_that_a_port_does_not_offer_is_an_error) {
  in_view_.properties["dataport.interface_type"] = "corba_cdr, shared_memory";
  EXPECT_EQ(error({{"dataport.interface_type", "carrier_pigeon"}}),
            "port B0.in: does not offer dataport.interface_type \"carrier_pigeon\", it offers corba_cdr, shared_memory");
}

TEST_F(ConnectionsTest, a_port_is_not_connected_to_itself) {
  auto service = port_view("A0.service", "CorbaPort", "");
  service.object = out_->_this();
  const auto done = connect_ports({&service, &service}, "", "", {});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "port A0.service: cannot be connected to itself");
}

TEST_F(ConnectionsTest, a_refusal_says_whether_the_id_is_in_use_or_the_ports_are_connected) {
  out_->answer = RTC::PRECONDITION_NOT_MET;
  EXPECT_NE(error().find("they are connected already"), std::string::npos) << error();
  in_->connectors.length(1);
  in_->connectors[0].connector_id = "id1";
  EXPECT_NE(error().find("connector id \"id1\" is in use"), std::string::npos) << error();
}

TEST_F(ConnectionsTest, a_connection_is_ended_by_its_id) {
  EXPECT_TRUE(disconnect_connector(in_view_, "id7"));
  EXPECT_EQ(in_->disconnected, std::vector<std::string>{"id7"});
  in_->answer = RTC::BAD_PARAMETER;
  EXPECT_FALSE(disconnect_connector(in_view_, "id8"));
}

TEST_F(ConnectionsTest, a_connection_that_its_port_dropped_meanwhile_is_ended) {
  in_view_.connectors.emplace_back().id = "id7";
  in_->answer = RTC::BAD_PARAMETER;
  EXPECT_TRUE(disconnect_connector(in_view_, "id7"));
  in_->connectors.length(1);
  in_->connectors[0].connector_id = "id7";
  EXPECT_FALSE(disconnect_connector(in_view_, "id7")) << "it has it still";
}

}  // namespace
}  // namespace tools
