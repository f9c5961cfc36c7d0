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

#include "corba/orb/call_timeout.h"
#include "ports/fault_support.h"

namespace {

using ports::Count;
using ports::Faults;
using ports::profile;
using ports::StrangeInPort;
using ports::StrangePort;

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
  const std::string name = "/test-" + std::to_string(getpid());
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
