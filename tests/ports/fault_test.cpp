// Peers that die, hang, throw or send nonsense: the others go on, the connection is removed, nothing is left.
#include <gtest/gtest.h>
#include <rtm/idl/DataPort_OpenRTMSkel.h>
#include <rtm/idl/SharedMemorySkel.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <functional>
#include <future>
#include <iterator>

#include "corba/call_timeout.h"
#include "corba/nv_list.h"
#include "ports/support.h"

namespace {

using ports::profile;

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
  std::unique_ptr<corba::Orb> orb = ports::start_orb();
  RTC::TimedLong sent{};
  RTC::TimedLong received{};
  RTC::OutPort<RTC::TimedLong> out{"A0.out", sent};
  RTC::InPort<RTC::TimedLong> in{"B0.in", received};

  // The object through which the OutPort would send to the InPort.
  OpenRTM::InPortCdr_var connect_and_steal(ports::Pairs properties = {}) {
    auto plan = profile({out.getPortRef(), in.getPortRef()}, properties);
    EXPECT_EQ(out.connect(plan), RTC::RTC_OK);
    const CORBA::Object_var object =
        orb->orb()->string_to_object(NVUtil::toString(plan.properties, "dataport.corba_cdr.inport_ior").c_str());
    return OpenRTM::InPortCdr::_narrow(object);
  }
};

TEST_F(Faults, a_receiver_of_any_make_answers_what_it_wants) {
  const std::pair<OpenRTM::PortStatus, RTC::DataPortStatus::Enum> answers[] = {
      {OpenRTM::PORT_OK, RTC::DataPortStatus::PORT_OK},         {OpenRTM::PORT_ERROR, RTC::DataPortStatus::PORT_ERROR},
      {OpenRTM::BUFFER_FULL, RTC::DataPortStatus::SEND_FULL},   {OpenRTM::BUFFER_TIMEOUT, RTC::DataPortStatus::SEND_TIMEOUT},
      {OpenRTM::BUFFER_EMPTY, RTC::DataPortStatus::PORT_ERROR}, {OpenRTM::UNKNOWN_ERROR, RTC::DataPortStatus::UNKNOWN_ERROR}};
  OpenRTM::PortStatus next = OpenRTM::PORT_OK;
  ports::Local<StrangeInPort> receiver([&] { return next; });
  const OpenRTM::InPortCdr_var reference = receiver._this();
  ports::Local<StrangePort> port("dataport.corba_cdr.inport_ior", reference);
  const RTC::PortService_var port_reference = port._this();
  auto plan = profile({out.getPortRef(), port_reference});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  for (const auto& [answer, status] : answers) {
    next = answer;
    EXPECT_EQ(out.write(), answer == OpenRTM::PORT_OK);
    EXPECT_EQ(out.getStatus(0), status);
  }
  EXPECT_EQ(out.connectors().size(), 1u);
  out.disconnect_all();
  EXPECT_EQ(port.disconnects, 1);
}

TEST_F(Faults, a_receiver_that_throws_loses_its_connection) {
  ports::Local<StrangeInPort> receiver([]() -> OpenRTM::PortStatus { throw CORBA::INTERNAL(); });
  const OpenRTM::InPortCdr_var reference = receiver._this();
  ports::Local<StrangePort> port("dataport.corba_cdr.inport_ior", reference);
  const RTC::PortService_var port_reference = port._this();
  std::atomic<int> disconnected{0};
  out.addConnectorListener(RTC::ON_DISCONNECT, new Count(disconnected));
  for (const char* subscription : {"flush", "new"}) {
    auto plan = profile({out.getPortRef(), port_reference, in.getPortRef()}, {{"subscription_type", subscription}});
    plan.ports.length(2);
    ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
    auto good = profile({out.getPortRef(), in.getPortRef()});
    ASSERT_EQ(out.connect(good), RTC::RTC_OK);
    out.write();
    EXPECT_TRUE(ports::eventually([&] { return out.connectors().size() == 1; }));
    EXPECT_TRUE(in.isNew()) << "the other connection got the sample";
    out.disconnect_all();
  }
  EXPECT_EQ(disconnected, 4);
}

TEST_F(Faults, a_peer_that_was_killed_loses_its_connection_and_others_go_on) {
  for (const char* subscription : {"flush", "new"}) {
    for (const char* interface : {"corba_cdr", "shared_memory"}) {
      ports::Peer peer;
      RTC::TimedOctetSeq value{};
      RTC::TimedOctetSeq result{};
      RTC::OutPort<RTC::TimedOctetSeq> octets("A0.octets", value);
      RTC::InPort<RTC::TimedOctetSeq> near("B0.octets", result);
      std::atomic<int> disconnected{0};
      octets.addConnectorListener(RTC::ON_DISCONNECT, new Count(disconnected));
      auto far_plan = profile({octets.getPortRef(), peer.port("in")}, {{"subscription_type", subscription}, {"interface_type", interface}});
      auto near_plan = profile({octets.getPortRef(), near.getPortRef()});
      ASSERT_EQ(octets.connect(far_plan), RTC::RTC_OK);
      ASSERT_EQ(octets.connect(near_plan), RTC::RTC_OK);
      EXPECT_TRUE(octets.write());
      peer.process().kill();
      EXPECT_TRUE(ports::eventually([&] {
        octets.write();
        return octets.connectors().size() == 1;
      }));
      EXPECT_TRUE(octets.write());
      EXPECT_EQ(disconnected, 1);
      EXPECT_EQ(octets.getPortProfile().connector_profiles.length(), 1u);
    }
  }
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

// The process must really stand still before anything is measured: one of its threads may answer once more.
void stop_process(ports::Peer& peer) {
  peer.process().signal(SIGSTOP);
  ASSERT_TRUE(ports::eventually([&] {
    std::ifstream status("/proc/" + std::to_string(peer.process().pid()) + "/stat");
    const std::string text{std::istreambuf_iterator<char>(status), {}};
    return text.find(") T ") != std::string::npos;
  }));
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
    EXPECT_TRUE(ports::eventually([&] {
      octets.write();
      return octets.connectors().empty();
    }));
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
  EXPECT_LT(std::chrono::steady_clock::now() - start, corba::port_call_timeout()) << "one call of the usual patience would last as long";
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
    EXPECT_TRUE(ports::eventually([&] {
      octets.write();
      return octets.connectors().empty();
    }));
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

TEST_F(Faults, a_peer_that_answers_with_another_connection_leaves_nothing_behind) {
  class Liar : public StrangePort {
   public:
    using StrangePort::StrangePort;
    RTC::ReturnCode_t notify_connect(RTC::ConnectorProfile& plan) override {
      if (changes_ports)
        plan.ports.length(0);
      else
        plan.connector_id = "another";
      return RTC::RTC_OK;
    }
    bool changes_ports = false;
  };
  ports::Local<Liar> liar("dataport.corba_cdr.inport_ior", in.getPortRef());
  const RTC::PortService_var reference = liar._this();
  for (const bool changes_ports : {false, true}) {
    liar.changes_ports = changes_ports;
    auto plan = profile({out.getPortRef(), reference});
    plan.connector_id = "mine";
    EXPECT_EQ(out.connect(plan), RTC::RTC_ERROR);
    EXPECT_TRUE(out.connectors().empty());
    auto good = profile({out.getPortRef(), in.getPortRef()});
    good.connector_id = "mine";
    EXPECT_EQ(out.connect(good), RTC::RTC_OK) << "the id is free";
    EXPECT_EQ(out.disconnect_all(), RTC::RTC_OK);
  }
}

TEST_F(Faults, a_dead_port_in_the_list_ends_the_connection) {
  RTC::PortService_var dead;
  {
    ports::Peer peer;
    dead = peer.port("in");
  }
  for (const bool is_first : {false, true}) {
    auto plan = is_first ? profile({dead, out.getPortRef()}) : profile({out.getPortRef(), dead});
    EXPECT_EQ(out.connect(plan), RTC::RTC_ERROR);
    EXPECT_TRUE(out.connectors().empty());
    EXPECT_EQ(out.getPortProfile().connector_profiles.length(), 0u);
  }
}

TEST_F(Faults, a_peer_that_refuses_or_gives_no_object_leaves_nothing) {
  const OpenRTM::InPortCdr_var nothing;
  ports::Local<StrangePort> port("dataport.nonsense", nothing);
  const RTC::PortService_var reference = port._this();
  auto plan = profile({out.getPortRef(), reference});
  EXPECT_EQ(out.connect(plan), RTC::RTC_ERROR);
  EXPECT_EQ(port.disconnects, 1) << "the peer is told, since it thinks that it is connected";
  for (const char* text : {"", "IOR:", "IOR:zz", "corbaname::", "nonsense"}) {
    port.on_connect = nullptr;
    auto wrong = profile({out.getPortRef(), reference});
    NVUtil::setStringValue(wrong.properties, "dataport.corba_cdr.inport_ior", text);
    EXPECT_EQ(out.connect(wrong), RTC::RTC_ERROR) << text;
  }
  // An object of another interface.
  ports::Local<StrangePort> of_another_kind("dataport.corba_cdr.inport_ior", in.getPortRef());
  const RTC::PortService_var other = of_another_kind._this();
  auto mistaken = profile({out.getPortRef(), other});
  EXPECT_EQ(out.connect(mistaken), RTC::RTC_ERROR);
  port.answer = RTC::RTC_ERROR;
  auto refused = profile({out.getPortRef(), reference});
  EXPECT_EQ(out.connect(refused), RTC::RTC_ERROR);
  EXPECT_TRUE(out.connectors().empty());
}

TEST_F(Faults, payloads_that_are_no_value_are_refused) {
  const auto port = connect_and_steal();
  sent.data = 3;
  ASSERT_TRUE(out.write());
  ASSERT_TRUE(in.read());
  for (const CORBA::ULong size : {0u, 3u, 11u}) {
    OpenRTM::CdrData octets(size);
    octets.length(size);
    EXPECT_EQ(port->put(octets), OpenRTM::PORT_ERROR);
    EXPECT_FALSE(in.isNew()) << size;
  }
  EXPECT_TRUE(in.read()) << "the last good one again";
  EXPECT_EQ(received.data, 3);
  sent.data = 4;
  EXPECT_TRUE(out.write());
  EXPECT_TRUE(in.read());
  EXPECT_EQ(received.data, 4);
}

TEST_F(Faults, a_refused_payload_takes_no_place_of_one_that_waits) {
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"inport.buffer.length", "1"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  const CORBA::Object_var object = orb->orb()->string_to_object(NVUtil::toString(plan.properties, "dataport.corba_cdr.inport_ior").c_str());
  const OpenRTM::InPortCdr_var port = OpenRTM::InPortCdr::_narrow(object);
  sent.data = 5;
  ASSERT_TRUE(out.write());
  EXPECT_EQ(port->put(OpenRTM::CdrData()), OpenRTM::PORT_ERROR);
  ASSERT_TRUE(in.read());
  EXPECT_EQ(received.data, 5);
}

// What only decoding shows.
TEST_F(Faults, a_text_without_its_end_is_dropped_when_it_is_read) {
  RTC::TimedString text{};
  text.data = "before";
  RTC::OutPort<RTC::TimedString> text_out("A0.text", text);
  RTC::InPort<RTC::TimedString> text_in("B0.text", text);
  auto plan = profile({text_out.getPortRef(), text_in.getPortRef()});
  ASSERT_EQ(text_out.connect(plan), RTC::RTC_OK);
  const CORBA::Object_var object = orb->orb()->string_to_object(NVUtil::toString(plan.properties, "dataport.corba_cdr.inport_ior").c_str());
  const OpenRTM::InPortCdr_var port = OpenRTM::InPortCdr::_narrow(object);
  OpenRTM::CdrData octets(16);
  octets.length(16);
  std::memset(octets.get_buffer(), 'x', 16);
  const CORBA::ULong length = 4;
  std::memcpy(octets.get_buffer() + 8, &length, 4);
  EXPECT_EQ(port->put(octets), OpenRTM::PORT_OK);
  EXPECT_FALSE(text_in.read());
  EXPECT_STREQ(text.data, "before");
}

TEST_F(Faults, lengths_without_the_octets_are_refused) {
  RTC::TimedOctetSeq octets{};
  RTC::OutPort<RTC::TimedOctetSeq> seq_out("A0.seq", octets);
  RTC::InPort<RTC::TimedOctetSeq> seq_in("B0.seq", octets);
  auto plan = profile({seq_out.getPortRef(), seq_in.getPortRef()});
  ASSERT_EQ(seq_out.connect(plan), RTC::RTC_OK);
  const CORBA::Object_var object = orb->orb()->string_to_object(NVUtil::toString(plan.properties, "dataport.corba_cdr.inport_ior").c_str());
  const OpenRTM::InPortCdr_var port = OpenRTM::InPortCdr::_narrow(object);
  octets.data.length(2);
  for (const CORBA::ULong length : {100u, 0x7fffffffu, 0xffffffffu}) {
    OpenRTM::CdrData lie(20);
    lie.length(20);
    std::memset(lie.get_buffer(), 0, 20);
    std::memcpy(lie.get_buffer() + 8, &length, 4);
    EXPECT_EQ(port->put(lie), OpenRTM::PORT_ERROR);
    EXPECT_FALSE(seq_in.read());
    EXPECT_EQ(octets.data.length(), 2u);
  }
}

TEST_F(Faults, a_reference_of_a_connection_that_is_gone_takes_nothing) {
  const auto port = connect_and_steal();
  out.disconnect_all();
  OpenRTM::CdrData octets(12);
  octets.length(12);
  EXPECT_THROW(port->put(octets), CORBA::SystemException);
  EXPECT_FALSE(in.isNew());
}

TEST_F(Faults, a_segment_that_lies_is_refused) {
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", "shared_memory"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  const CORBA::Object_var object = orb->orb()->string_to_object(NVUtil::toString(plan.properties, "dataport.corba_cdr.inport_ior").c_str());
  const OpenRTM::PortSharedMemory_var port = OpenRTM::PortSharedMemory::_narrow(object);
  EXPECT_EQ(port->put(), OpenRTM::PORT_ERROR) << "no segment yet";
  for (const char* name : {"", "/", "..", "../../etc/passwd", "no-such-segment"}) {
    EXPECT_THROW(port->open_memory(100, name), CORBA::SystemException) << name;
  }
  const std::string name = "/rtmsim-test-" + std::to_string(getpid());
  const int file = shm_open(name.c_str(), O_CREAT | O_RDWR, 0600);
  ASSERT_EQ(ftruncate(file, 64), 0);
  port->open_memory(64, name.c_str());
  for (const std::uint64_t length : {std::uint64_t{57}, std::uint64_t{1} << 32, ~std::uint64_t{0}}) {
    ASSERT_EQ(pwrite(file, &length, 8, 0), 8);
    EXPECT_EQ(port->put(), OpenRTM::PORT_ERROR) << length;
  }
  ASSERT_EQ(ftruncate(file, 4), 0);
  EXPECT_EQ(port->put(), OpenRTM::PORT_ERROR);
  close(file);
  shm_unlink(name.c_str());
  EXPECT_FALSE(in.isNew());
}

TEST_F(Faults, a_port_may_die_while_others_hold_references) {
  RTC::PortService_var gone;
  {
    RTC::InPort<RTC::TimedLong> brief("C0.in", received);
    auto plan = profile({out.getPortRef(), brief.getPortRef()}, {{"subscription_type", "new"}});
    ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
    gone = RTC::PortService::_duplicate(brief.getPortRef());
  }
  EXPECT_THROW(RTC::PortProfile_var(gone->get_port_profile()), CORBA::OBJECT_NOT_EXIST);
  EXPECT_TRUE(ports::eventually([&] {
    out.write();
    return out.connectors().empty();
  }));
}

}  // namespace
