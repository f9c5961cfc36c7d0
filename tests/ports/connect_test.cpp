// Making and taking apart connections: codes, keys, order, and that a refused connection leaves nothing.
#include <gtest/gtest.h>

#include <cstring>

#include "base/id.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/nv_list.h"
#include "corba/ports/disconnect_notice.h"
#include "ports/support.h"
#include "support/memory_limit.h"

namespace {

using ports::profile;

class Connecting : public testing::Test {
 protected:
  std::unique_ptr<corba::Orb> orb = ports::start_orb();
  RTC::TimedLong sent{};
  RTC::TimedLong received{};
  RTC::TimedShort other{};
  RTC::OutPort<RTC::TimedLong> out{"A0.out", sent};
  RTC::InPort<RTC::TimedLong> in{"B0.in", received};
  RTC::InPort<RTC::TimedShort> short_in{"B0.short", other};

  void expect_nothing_left() {
    EXPECT_TRUE(out.connectors().empty());
    EXPECT_TRUE(in.connectors().empty());
    EXPECT_EQ(out.getPortProfile().connector_profiles.length(), 0u);
    EXPECT_EQ(in.getPortProfile().connector_profiles.length(), 0u);
  }
};

TEST_F(Connecting, both_ends_know_the_connection_until_it_is_taken_apart) {
  auto plan = profile({out.getPortRef(), in.getPortRef()});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  EXPECT_EQ(std::strlen(plan.connector_id), 36u);
  EXPECT_EQ(NVUtil::toString(plan.properties, "dataport.serializer.cdr.endian"), "little,big");
  EXPECT_TRUE(NVUtil::toString(plan.properties, "dataport.corba_cdr.inport_ior").starts_with("IOR:"));
  for (RTC::PortBase* port : {static_cast<RTC::PortBase*>(&out), static_cast<RTC::PortBase*>(&in)}) {
    const RTC::ConnectorProfile_var known = port->get_connector_profile(plan.connector_id);
    EXPECT_STREQ(known->name, "test");
    EXPECT_EQ(known->ports.length(), 2u);
  }
  EXPECT_EQ(in.disconnect(plan.connector_id), RTC::RTC_OK);
  expect_nothing_left();
  EXPECT_EQ(out.disconnect(plan.connector_id), RTC::BAD_PARAMETER);
  EXPECT_EQ(out.notify_disconnect(plan.connector_id), RTC::BAD_PARAMETER);
}

TEST_F(Connecting, any_port_of_the_list_can_be_asked_and_any_be_first) {
  auto reversed = profile({in.getPortRef(), out.getPortRef()});
  ASSERT_EQ(out.connect(reversed), RTC::RTC_OK);
  sent.data = 5;
  EXPECT_TRUE(out.write());
  EXPECT_TRUE(in.read());
  EXPECT_EQ(received.data, 5);
  EXPECT_EQ(in.disconnect_all(), RTC::RTC_OK);
  expect_nothing_left();
}

TEST_F(Connecting, what_is_wrong_has_its_code_and_leaves_nothing) {
  const auto code = [&](RTC::ConnectorProfile plan) { return out.connect(plan); };
  const auto both = [&](ports::Pairs pairs) { return profile({out.getPortRef(), in.getPortRef()}, pairs); };
  EXPECT_EQ(code(profile({})), RTC::BAD_PARAMETER);
  EXPECT_EQ(code(profile({in.getPortRef()})), RTC::BAD_PARAMETER) << "the port is not in the list";
  EXPECT_EQ(code(profile({out.getPortRef(), RTC::PortService::_nil()})), RTC::BAD_PARAMETER);
  EXPECT_EQ(code(both({{"dataflow_type", ""}})), RTC::BAD_PARAMETER);
  EXPECT_EQ(code(both({{"interface_type", "carrier_pigeon"}})), RTC::BAD_PARAMETER);
  EXPECT_EQ(code(both({{"serializer.cdr.endian", "middle"}})), RTC::UNSUPPORTED);
  EXPECT_EQ(code(both({{"subscription_type", "periodic"}})), RTC::BAD_PARAMETER);
  for (const char* rate : {"nan", "-nan", "inf", "-1", "0", "1e308", "1e-320", ""}) {
    EXPECT_EQ(code(both({{"subscription_type", "periodic"}, {"publisher.push_rate", rate}})), RTC::BAD_PARAMETER) << rate;
  }
  EXPECT_EQ(code(both({{"data_type", "IDL:RTC/TimedString:1.0"}})), RTC::BAD_PARAMETER);
  EXPECT_EQ(code(profile({out.getPortRef(), short_in.getPortRef()})), RTC::BAD_PARAMETER) << "the types differ";
  EXPECT_EQ(code(profile({out.getPortRef(), out.getPortRef()})), RTC::PRECONDITION_NOT_MET) << "the same port twice";
  auto no_id = profile({out.getPortRef(), in.getPortRef()});
  EXPECT_EQ(out.notify_connect(no_id), RTC::BAD_PARAMETER);
  auto huge = profile({out.getPortRef(), in.getPortRef()}, {}, std::string(1 << 20, 'x').c_str());
  EXPECT_EQ(out.connect(huge), RTC::BAD_PARAMETER);
  expect_nothing_left();
}

TEST_F(Connecting, a_megabyte_in_name_and_properties_is_taken_as_text) {
  const std::string megabyte(1 << 20, 'n');
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"nonsense", megabyte}});
  plan.name = megabyte.c_str();
  EXPECT_EQ(out.connect(plan), RTC::RTC_OK);
  EXPECT_EQ(out.disconnect_all(), RTC::RTC_OK);
  expect_nothing_left();
}

TEST_F(Connecting, an_id_is_taken_once) {
  RTC::InPort<RTC::TimedLong> second("C0.in", received);
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {}, "id1");
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  auto again = profile({out.getPortRef(), second.getPortRef()}, {}, "id1");
  EXPECT_EQ(out.connect(again), RTC::PRECONDITION_NOT_MET);
  RTC::OutPort<RTC::TimedLong> another("D0.out", sent);
  auto from_afar = profile({another.getPortRef(), in.getPortRef()}, {}, "id1");
  EXPECT_EQ(another.connect(from_afar), RTC::PRECONDITION_NOT_MET) << "the second port of the chain knows the id";
  EXPECT_EQ(in.connectors().size(), 1u) << "the connection that had the id stays";
  EXPECT_EQ(out.connectors().size(), 1u);
  EXPECT_TRUE(another.connectors().empty());
}

TEST_F(Connecting, two_ports_are_connected_twice_only_if_allowed) {
  auto first = profile({out.getPortRef(), in.getPortRef()});
  auto second = profile({out.getPortRef(), in.getPortRef()});
  auto third = profile({out.getPortRef(), in.getPortRef()}, {{"allow_dup_connection", "YES"}});
  EXPECT_EQ(out.connect(first), RTC::RTC_OK);
  EXPECT_EQ(out.connect(second), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(out.connect(third), RTC::RTC_OK);
  EXPECT_EQ(out.connectors().size(), 2u);
}

TEST_F(Connecting, limits_of_connections_hold) {
  RTC::InPort<RTC::TimedLong> second("C0.in", received);
  coil::Properties limit;
  limit.setProperty("connection_limit", "1");
  out.init(limit);
  auto first = profile({out.getPortRef(), in.getPortRef()});
  auto more = profile({out.getPortRef(), second.getPortRef()});
  EXPECT_EQ(out.connect(first), RTC::RTC_OK);
  EXPECT_EQ(out.connect(more), RTC::RTC_ERROR);
  out.disconnect_all();
  RTC::OutPort<RTC::TimedLong> fan("D0.out", sent);
  auto one = profile({fan.getPortRef(), in.getPortRef()}, {{"outport.fan_out", "1"}});
  auto two = profile({fan.getPortRef(), second.getPortRef()}, {{"outport.fan_out", "1"}});
  EXPECT_EQ(fan.connect(one), RTC::RTC_OK);
  EXPECT_EQ(fan.connect(two), RTC::RTC_ERROR);
  EXPECT_TRUE(second.connectors().empty());
}

TEST_F(Connecting, a_limit_of_connections_larger_than_an_int_is_no_limit_of_none) {
  coil::Properties limit;
  limit.setProperty("connection_limit", "4294967296");
  out.init(limit);
  auto plan = profile({out.getPortRef(), in.getPortRef()});
  EXPECT_EQ(out.connect(plan), RTC::RTC_OK);
}

TEST_F(Connecting, thousands_of_connections_are_made_and_no_more_unless_the_port_says_so) {
  const auto connect_up_to = [](RTC::InPort<RTC::TimedLong>& port, int most) {
    for (int made = 0; made < most; ++made) {
      auto plan = profile({port.getPortRef()});
      if (port.connect(plan) != RTC::RTC_OK) return made;
    }
    return most;
  };
  EXPECT_EQ(connect_up_to(in, 4100), 4096);
  RTC::InPort<RTC::TimedLong> large("C0.in", received);
  coil::Properties limit;
  limit.setProperty("connection_limit", "4098");
  large.init(limit);
  EXPECT_EQ(connect_up_to(large, 4100), 4098);
}

TEST_F(Connecting, a_connection_for_which_there_is_no_thread_is_refused) {
  if (!sim::test::MemoryLimit::is_kept) GTEST_SKIP() << "sanitizers need the memory";
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"subscription_type", "new"}});
  {
    const sim::test::MemoryLimit limit(std::size_t{4} << 20);
    EXPECT_EQ(out.connect(plan), RTC::RTC_ERROR);
  }
  EXPECT_TRUE(in.connectors().empty());
  EXPECT_EQ(out.connect(plan), RTC::RTC_OK);
}

// A process that does not answer is told later, on a thread.
TEST_F(Connecting, a_port_for_whose_farewell_there_is_no_thread_costs_nothing_but_that_farewell) {
  if (!sim::test::MemoryLimit::is_kept) GTEST_SKIP() << "sanitizers need the memory";
  auto plan = profile({in.getPortRef()}, {}, "left");
  ASSERT_EQ(in.connect(plan), RTC::RTC_OK);
  {
    const sim::test::MemoryLimit limit(std::size_t{4} << 20);
    EXPECT_NO_THROW(corba::notify_disconnect_later(in.getPortRef(), "left"));
  }
  EXPECT_EQ(in.connectors().size(), 1u);
  corba::notify_disconnect_later(in.getPortRef(), "left");
  EXPECT_TRUE(ports::eventually([&] { return in.connectors().empty(); })) << "a later one gets through";
}

TEST_F(Connecting, stale_references_in_the_profile_are_not_used) {
  auto plan =
      profile({out.getPortRef(), in.getPortRef()}, {{"corba_cdr.inport_ior", "IOR:000000"}, {"inport.data_type", "IDL:RTC/TimedLong:1.0"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  sent.data = 1;
  EXPECT_TRUE(out.write());
  EXPECT_TRUE(in.isNew());
}

TEST_F(Connecting, both_sides_connecting_at_once_end_with_one_connection) {
  for (int i = 0; i < 50; ++i) {
    auto forth = profile({out.getPortRef(), in.getPortRef()}, {}, base::make_uuid().c_str());
    auto back = profile({in.getPortRef(), out.getPortRef()}, {}, base::make_uuid().c_str());
    RTC::ReturnCode_t codes[2];
    std::thread other_side([&] { codes[1] = in.connect(back); });
    codes[0] = out.connect(forth);
    other_side.join();
    EXPECT_EQ((codes[0] == RTC::RTC_OK) + (codes[1] == RTC::RTC_OK), 1) << codes[0] << ' ' << codes[1];
    EXPECT_EQ(out.connectors().size(), 1u);
    EXPECT_EQ(in.connectors().size(), 1u);
    out.disconnect_all();
  }
  expect_nothing_left();
}

TEST_F(Connecting, the_profile_advertises_what_tools_look_for) {
  const RTC::PortProfile_var shown = in.get_port_profile();
  const auto value = [&](const char* key) { return NVUtil::toString(shown->properties, key); };
  EXPECT_STREQ(shown->name, "B0.in");
  EXPECT_EQ(value("port.port_type"), "DataInPort");
  EXPECT_EQ(value("dataport.data_type"), "IDL:RTC/TimedLong:1.0");
  EXPECT_EQ(value("dataport.subscription_type"), "Any");
  EXPECT_EQ(value("dataport.dataflow_type"), "push,pull");
  EXPECT_EQ(value("dataport.interface_type"), "corba_cdr,data_service,direct,shared_memory");
  const RTC::PortProfile_var out_shown = out.get_port_profile();
  EXPECT_EQ(NVUtil::toString(out_shown->properties, "dataport.io_mode"), "block,flush,new,nonblock,periodic");
}

TEST_F(Connecting, the_peer_sees_what_the_outports_own_properties_say) {
  coil::Properties own;
  own.setProperty("buffer.read.empty_policy", "do_nothing");
  own.setProperty("dataport.buffer.length", "3");
  own.setProperty("outport.buffer.write.timeout", "0.5");
  own.setProperty("io_mode", "block");
  out.init(own);
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"buffer.length", "5"}, {"outport.io_mode", "nonblock"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  const auto value = [&](const char* key) { return NVUtil::toString(plan.properties, key); };
  EXPECT_EQ(value("dataport.outport.buffer.read.empty_policy"), "do_nothing");
  EXPECT_EQ(value("dataport.outport.buffer.write.timeout"), "0.5");
  EXPECT_EQ(value("dataport.outport.buffer.length"), "") << "whoever connects knows better";
  EXPECT_EQ(value("dataport.outport.io_mode"), "nonblock");
}

TEST_F(Connecting, calls_between_ports_keep_the_time_out_of_the_orb) {
  orb.reset();
  corba::OrbSettings settings;
  settings.arguments = {"-ORBclientCallTimeOutPeriod", "1234"};
  auto other_orb = corba::Orb::start(settings);
  ASSERT_TRUE(other_orb);
  EXPECT_EQ(corba::port_call_timeout(), std::chrono::milliseconds(1234));
  other_orb->reset();
  orb = ports::start_orb();
  EXPECT_EQ(corba::port_call_timeout(), std::chrono::seconds(10));
}

TEST_F(Connecting, steps_are_told_in_their_order) {
  struct Step : RTC::PortConnectRetListener {
    Step(std::vector<std::string>& told, const char* what) : told(told), what(what) {}
    void operator()(const char*, RTC::ConnectorProfile&, RTC::ReturnCode_t) override { told.emplace_back(what); }
    std::vector<std::string>& told;
    const char* what;
  };
  std::vector<std::string> told;
  RTC::PortConnectListeners listeners;
  for (int i = 0; i < RTC::PORT_CONNECT_RET_LISTENER_NUM; ++i) {
    const auto type = static_cast<RTC::PortConnectRetListenerType>(i);
    listeners.portconnret_[i].addListener(new Step(told, RTC::PortConnectRetListener::toString(type)), true);
  }
  out.setPortConnectListenerHolder(&listeners);
  auto plan = profile({out.getPortRef(), in.getPortRef()});
  out.connect(plan);
  out.disconnect_all();
  EXPECT_EQ(told, (std::vector<std::string>{"ON_PUBLISH_INTERFACES", "ON_CONNECT_NEXTPORT", "ON_SUBSCRIBE_INTERFACES", "ON_CONNECTED",
                                            "ON_DISCONNECT_NEXT", "ON_DISCONNECTED"}));
  out.setPortConnectListenerHolder(nullptr);
}

TEST_F(Connecting, three_ports_make_one_connection) {
  RTC::InPort<RTC::TimedLong> second("C0.in", received);
  auto plan = profile({out.getPortRef(), in.getPortRef(), second.getPortRef()});
  // Only the last published reference is in the profile, as everywhere; what counts is that all three know and forget it.
  EXPECT_EQ(out.connect(plan), RTC::RTC_OK);
  EXPECT_EQ(second.connectors().size(), 1u);
  EXPECT_EQ(second.disconnect(plan.connector_id), RTC::RTC_OK);
  EXPECT_TRUE(second.connectors().empty());
  expect_nothing_left();
}

}  // namespace
