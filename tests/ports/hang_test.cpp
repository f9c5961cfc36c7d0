// Peers that hang: they cost their own connections alone, and are told when they wake.
#include <gtest/gtest.h>

#include <fstream>
#include <future>
#include <iterator>

#include "corba/orb/call_timeout.h"
#include "ports/fault_support.h"

namespace {

using ports::Count;
using ports::Faults;
using ports::profile;
using ports::StrangeInPort;
using ports::StrangePort;

// The process must really stand still before anything is measured: one of its threads may answer once more.
void stop_process(ports::Peer& peer) {
  peer.process().signal(SIGSTOP);
  ASSERT_TRUE(ports::eventually([&] {
    std::ifstream status("/proc/" + std::to_string(peer.process().pid()) + "/stat");
    const std::string text{std::istreambuf_iterator<char>(status), {}};
    return text.find(") T ") != std::string::npos;
  }));
}

// Writes until then.
bool loses_its_connection(RTC::OutPort<RTC::TimedOctetSeq>& octets) {
  return ports::eventually([&] {
    octets.write();
    return octets.connectors().empty();
  });
}

TEST_F(Faults, a_peer_that_hangs_costs_its_own_connection_only) {
  ports::Peer peer;
  RTC::TimedOctetSeq value{};
  RTC::OutPort<RTC::TimedOctetSeq> octets("A0.octets", value);
  const RTC::PortService_var far = peer.port("in");
  auto plan = profile({octets.getPortRef(), far}, {{"call_timeout", "0.2"}});
  ASSERT_EQ(octets.connect(plan), RTC::RTC_OK);
  peer.process().signal(SIGSTOP);
  // The peer may answer once more before the signal has stopped all of its threads.
  EXPECT_TRUE(ports::eventually([&] { return !octets.write(); }));
  EXPECT_TRUE(octets.connectors().empty());

  // A profile is answered, and a connection to somebody else made, while one to the hanging peer is under way.
  corba::set_port_call_timeout(std::chrono::milliseconds(500));
  auto hanging = profile({octets.getPortRef(), far});
  auto answer = std::async(std::launch::async, [&] { return octets.connect(hanging); });
  const RTC::PortProfile_var shown = octets.get_port_profile();
  EXPECT_EQ(shown->connector_profiles.length(), 0u);
  RTC::InPort<RTC::TimedOctetSeq> near("B0.octets", value);
  auto good = profile({octets.getPortRef(), near.getPortRef()});
  EXPECT_EQ(octets.connect(good), RTC::RTC_OK);
  EXPECT_TRUE(octets.write());
  EXPECT_EQ(answer.get(), RTC::RTC_ERROR);
  EXPECT_EQ(octets.connectors().size(), 1u);
  corba::set_port_call_timeout(std::chrono::seconds(10));
}

TEST_F(Faults, a_peer_that_hangs_bounds_writes_of_every_subscription) {
  for (const char* subscription : {"flush", "new", "periodic"}) {
    ports::Peer peer;
    RTC::TimedOctetSeq value{};
    RTC::TimedOctetSeq result{};
    RTC::OutPort<RTC::TimedOctetSeq> octets("A0.octets", value);
    RTC::InPort<RTC::TimedOctetSeq> near("B0.octets", result);
    auto far_plan = profile({octets.getPortRef(), peer.port("in")},
                            {{"subscription_type", subscription}, {"publisher.push_rate", "1000"}, {"call_timeout", "0.5"}});
    auto near_plan = profile({octets.getPortRef(), near.getPortRef()}, {{"subscription_type", "new"}});
    ASSERT_EQ(octets.connect(far_plan), RTC::RTC_OK);
    ASSERT_EQ(octets.connect(near_plan), RTC::RTC_OK);
    stop_process(peer);
    // The other connection of the port has each sample while the one that hangs still waits for its answer.
    std::atomic<bool> is_written{false};
    std::thread writer([&] {
      value.tm.sec = 17;
      octets.write();
      is_written = true;
    });
    EXPECT_TRUE(ports::eventually([&] { return near.isNew(); }));
    EXPECT_TRUE(std::string(subscription) != "flush" || !is_written) << "the sample came before the time-out";
    writer.join();
    EXPECT_TRUE(near.read());
    EXPECT_EQ(result.tm.sec, 17u);
    EXPECT_TRUE(ports::eventually([&] {
      octets.write();
      return octets.connectors().size() == 1;
    })) << "the connection ends with the time-out of its call";
    EXPECT_TRUE(octets.write());
  }
}

// A robot whose sensor was away for a while drives on without anybody's help, whichever end was first in the connection.
TEST_F(Faults, a_connection_that_is_to_come_back_does_so_when_the_peer_that_hung_wakes) {
  for (const bool ours_first : {true, false}) {
    ports::Peer peer;
    RTC::TimedOctetSeq value{};
    RTC::OutPort<RTC::TimedOctetSeq> octets("A0.octets", value);
    const RTC::PortService_var far = peer.port("in");
    std::vector<RTC::PortService_ptr> ends{octets.getPortRef(), far};
    if (!ours_first) std::swap(ends[0], ends[1]);
    auto plan = profile({ends[0], ends[1]}, {{"subscription_type", "new"}, {"call_timeout", "0.3"}, {"reconnect", "YES"}}, "here again");
    ASSERT_EQ(octets.connect(plan), RTC::RTC_OK);
    stop_process(peer);
    EXPECT_TRUE(loses_its_connection(octets));
    peer.process().signal(SIGCONT);
    EXPECT_TRUE(ports::eventually([&] { return octets.connectors().size() == 1; }));
    EXPECT_STREQ(octets.connectors().at(0)->id(), "here again");
    EXPECT_TRUE(octets.write());
    EXPECT_EQ(octets.disconnect("here again"), RTC::RTC_OK);
  }
}

TEST_F(Faults, a_peer_that_hangs_keeps_its_connection_while_nobody_writes) {
  corba::OrbSettings settings;
  orb.reset();
  settings.peer_check_interval = std::chrono::milliseconds(20);
  auto watching = corba::Orb::start(settings);
  ASSERT_TRUE(watching);
  (*watching)->activate();
  {
    ports::Peer peer;
    RTC::TimedOctetSeq value{};
    RTC::OutPort<RTC::TimedOctetSeq> octets("A0.octets", value);
    RTC::InPort<RTC::TimedOctetSeq> from_afar("B0.octets", value);
    std::atomic<int> disconnected{0};
    octets.addConnectorListener(RTC::ON_DISCONNECT, new Count(disconnected));
    from_afar.addConnectorListener(RTC::ON_DISCONNECT, new Count(disconnected));
    auto forth = profile({octets.getPortRef(), peer.port("in")});
    auto back = profile({peer.port("out"), from_afar.getPortRef()});
    ASSERT_EQ(octets.connect(forth), RTC::RTC_OK);
    ASSERT_EQ(from_afar.connect(back), RTC::RTC_OK);
    stop_process(peer);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // several looks: nothing may happen, so there is nothing to wait for
    EXPECT_EQ(octets.connectors().size() + from_afar.connectors().size(), 2u);
    peer.process().signal(SIGCONT);
    EXPECT_TRUE(octets.write());
    // One that died is found by both sides although nobody writes.
    peer.process().kill();
    EXPECT_TRUE(ports::eventually([&] { return disconnected == 2; }));
    EXPECT_TRUE(ports::eventually(
        [&] { return octets.getPortProfile().connector_profiles.length() + from_afar.getPortProfile().connector_profiles.length() == 0; }));
  }
}

// With the usual pause between two looks, which is what people wait for.
TEST_F(Faults, a_peer_that_has_hung_and_then_dies_is_found_as_soon_as_any_other) {
  ports::Peer peer;
  RTC::TimedOctetSeq value{};
  RTC::OutPort<RTC::TimedOctetSeq> octets("A0.octets", value);
  auto plan = profile({octets.getPortRef(), peer.port("in")});
  ASSERT_EQ(octets.connect(plan), RTC::RTC_OK);
  stop_process(peer);
  const auto two_looks = 2 * corba::OrbSettings().peer_check_interval + std::chrono::seconds(1);
  std::this_thread::sleep_for(two_looks);  // nobody tells that it has been found to hang
  EXPECT_EQ(octets.connectors().size(), 1u);
  const auto died = std::chrono::steady_clock::now();
  peer.process().kill();
  EXPECT_TRUE(ports::eventually([&] { return octets.connectors().empty(); }));
  EXPECT_LT(std::chrono::steady_clock::now() - died, 5 * corba::OrbSettings().peer_check_interval) << "it was asked once in 15 looks";
}

// However many ports of a connection are silent, and wherever they are in it, connecting takes the time of one call.
TEST_F(Faults, connecting_with_silent_ports_has_one_deadline) {
  ports::Peer one, other;
  RTC::TimedOctetSeq value{};
  RTC::OutPort<RTC::TimedOctetSeq> octets("A0.octets", value);
  const RTC::PortService_var in = one.port("in"), out = one.port("out"), also_in = other.port("in");
  stop_process(one);
  stop_process(other);
  const auto limit = std::chrono::milliseconds(1000);
  corba::set_port_call_timeout(limit);
  const std::vector<std::vector<RTC::PortService_ptr>> chains = {
      {octets.getPortRef(), in}, {in, octets.getPortRef()}, {in, also_in, octets.getPortRef()}, {octets.getPortRef(), in, also_in}};
  for (const auto& chain : chains) {
    RTC::ConnectorProfile plan = profile({chain[0]});
    plan.ports.length(static_cast<CORBA::ULong>(chain.size()));
    for (CORBA::ULong i = 0; i < plan.ports.length(); ++i) plan.ports[i] = RTC::PortService::_duplicate(chain[i]);
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(octets.connect(plan), RTC::RTC_ERROR);
    EXPECT_LT(std::chrono::steady_clock::now() - start, 2 * limit) << chain.size() << " ports";
  }
  corba::set_port_call_timeout(std::chrono::seconds(10));
}

// A peer that throws would do so again; only one that hung is connected again.
TEST_F(Faults, a_connection_that_comes_back_does_not_after_an_exception_of_the_peer) {
  auto* in_port = new StrangeInPort([]() -> OpenRTM::PortStatus { throw CORBA::UNKNOWN(); });
  PortableServer::Servant_var<StrangeInPort> in_owner(in_port);
  OpenRTM::InPortCdr_var object = in_port->_this();
  auto* port = new StrangePort("dataport.corba_cdr.inport_ior", object);
  PortableServer::Servant_var<StrangePort> owner(port);
  RTC::PortService_var reference = port->_this();
  std::atomic<int> connects{0};
  port->on_connect = [&] { ++connects; };
  RTC::TimedOctetSeq value{};
  RTC::OutPort<RTC::TimedOctetSeq> octets("A0.octets", value);
  auto plan = profile({octets.getPortRef(), reference}, {{"reconnect", "YES"}});
  ASSERT_EQ(octets.connect(plan), RTC::RTC_OK);
  EXPECT_FALSE(octets.write());
  EXPECT_TRUE(octets.connectors().empty());
  EXPECT_TRUE(ports::eventually([&] { return port->disconnects == 1; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // nothing may happen, so there is nothing to wait for
  EXPECT_EQ(connects, 1);
}

TEST_F(Faults, leaving_a_peer_that_hangs_takes_a_moment_for_all_its_connections_together) {
  ports::Peer peer;
  RTC::TimedOctetSeq value{};
  RTC::OutPort<RTC::TimedOctetSeq> first("A0.octets", value);
  RTC::OutPort<RTC::TimedOctetSeq> second("A0.octets", value);
  RTC::InPort<RTC::TimedOctetSeq> third("A0.octets", value);
  auto forth = profile({first.getPortRef(), peer.port("in")});
  auto also_forth = profile({second.getPortRef(), peer.port("in")});
  auto back = profile({peer.port("out"), third.getPortRef()});  // here the one that hangs is first in the chain
  ASSERT_EQ(first.connect(forth), RTC::RTC_OK);
  ASSERT_EQ(second.connect(also_forth), RTC::RTC_OK);
  ASSERT_EQ(third.connect(back), RTC::RTC_OK);
  stop_process(peer);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(third.disconnect_all(), RTC::RTC_OK);
  EXPECT_EQ(first.disconnect_all(), RTC::RTC_OK);
  EXPECT_EQ(second.disconnect_all(), RTC::RTC_OK);
  EXPECT_LT(std::chrono::steady_clock::now() - start, corba::port_call_timeout()) << "one call of the usual timeout would last as long";
  EXPECT_EQ(first.connectors().size() + second.connectors().size() + third.connectors().size(), 0u);
  // The peer has had the message when it wakes.
  peer.process().signal(SIGCONT);
  const RTC::PortService_var far = peer.port("in");
  EXPECT_TRUE(ports::eventually([&] { return RTC::ConnectorProfileList_var(far->get_connector_profiles())->length() == 0; }));
}

TEST_F(Faults, a_peer_that_was_dropped_while_it_hung_is_told_and_can_be_connected_again) {
  for (const char* subscription : {"flush", "new"}) {
    ports::Peer peer;
    RTC::TimedOctetSeq value{};
    RTC::OutPort<RTC::TimedOctetSeq> octets("A0.octets", value);
    const RTC::PortService_var far = peer.port("in");
    auto plan = profile({octets.getPortRef(), far}, {{"call_timeout", "1"}, {"subscription_type", subscription}});
    plan.connector_id = "the same";
    ASSERT_EQ(octets.connect(plan), RTC::RTC_OK);
    stop_process(peer);
    EXPECT_TRUE(loses_its_connection(octets));
    peer.process().signal(SIGCONT);
    EXPECT_TRUE(ports::eventually([&] { return RTC::ConnectorProfileList_var(far->get_connector_profiles())->length() == 0; }));
    auto again = plan;
    ASSERT_EQ(octets.connect(again), RTC::RTC_OK) << subscription;
    EXPECT_TRUE(octets.write());
    octets.disconnect_all();
  }
}

TEST_F(Faults, the_end_does_not_wait_for_a_peer_that_hangs_and_was_left) {
  ports::Peer peer;
  {
    RTC::TimedOctetSeq value{};
    RTC::OutPort<RTC::TimedOctetSeq> octets("A0.octets", value);
    auto forth = profile({octets.getPortRef(), peer.port("in")});
    ASSERT_EQ(octets.connect(forth), RTC::RTC_OK);
    stop_process(peer);
    EXPECT_EQ(octets.disconnect_all(), RTC::RTC_OK);
  }
  const auto start = std::chrono::steady_clock::now();
  orb.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - start, corba::port_call_timeout() / 2);
}

}  // namespace
