// Peers that mean harm: deep names, chains of ports that never answer, segments that are cut short, fifos in the place of segments. None of
// them ends the process or holds it longer than its time-outs.
#include <gtest/gtest.h>
#include <omniORB4/CORBA.h>
#include <omniORB4/omniIOR.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>
#include <rtm/idl/SharedMemorySkel.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <future>
#include <span>
#include <vector>

#include "corba/orb/call_timeout.h"
#include "corba/ports/connector_keys.h"
#include "corba/ports/sample_room.h"
#include "ports/support.h"
#include "support/hanging.h"

namespace {

using namespace std::chrono_literals;
using ports::profile;
using std::chrono::steady_clock;

std::string deep_name(std::size_t length) {
  std::string name = "dataport";
  while (name.size() < length) name += ".a";
  return name;
}

class Hostile : public testing::Test {
 protected:
  std::unique_ptr<corba::Orb> orb = ports::start_orb();
  RTC::TimedLong sent{};
  RTC::TimedLong received{};
  RTC::OutPort<RTC::TimedLong> out{"A0.out", sent};
  RTC::InPort<RTC::TimedLong> in{"B0.in", received};

  OpenRTM::PortSharedMemory_var connect_and_steal() {
    auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", "shared_memory"}});
    EXPECT_EQ(out.connect(plan), RTC::RTC_OK);
    const CORBA::Object_var object =
        orb->orb()->string_to_object(NVUtil::toString(plan.properties, "dataport.corba_cdr.inport_ior").c_str());
    return OpenRTM::PortSharedMemory::_narrow(object);
  }
};

// A file in the place of a segment, gone with its owner.
struct Segment {
  std::string name = "/hostile-" + std::to_string(getpid());
  std::string path = "/dev/shm" + name;
  ~Segment() { unlink(path.c_str()); }
};

TEST_F(Hostile, names_too_deep_or_too_many_are_refused_at_every_door) {
  for (const std::size_t length : {std::size_t{1000}, std::size_t{60'000}, std::size_t{120'000}}) {
    auto plan = profile({out.getPortRef(), in.getPortRef()});
    NVUtil::setStringValue(plan.properties, deep_name(length).c_str(), "x");
    EXPECT_EQ(out.connect(plan), RTC::BAD_PARAMETER) << length;
    plan.connector_id = "told";
    EXPECT_EQ(in.notify_connect(plan), RTC::BAD_PARAMETER) << length;
  }
  auto plan = profile({out.getPortRef(), in.getPortRef()});
  const CORBA::ULong first = plan.properties.length();
  plan.properties.length(first + 5000);
  for (CORBA::ULong i = 0; i < 5000; ++i) plan.properties[first + i] = NVUtil::newNV(("x" + std::to_string(i)).c_str(), "");
  EXPECT_EQ(out.connect(plan), RTC::BAD_PARAMETER);
  EXPECT_TRUE(out.connectors().empty());
  auto good = profile({out.getPortRef(), in.getPortRef()}, {{"a.b.c.d.e.f.g.h", "x"}});
  EXPECT_EQ(out.connect(good), RTC::RTC_OK);
}

// The key of the object at the InPort's end, which the guard of an end point knows it by (corba/orb/giop_gate.h).
std::vector<std::byte> key_of(corba::Orb& orb, const RTC::ConnectorProfile& connection) {
  const auto ior_text = NVUtil::toString(connection.properties, "dataport.corba_cdr.inport_ior");
  const CORBA::Object_var object = orb.orb()->string_to_object(ior_text.c_str());
  const omniIOR_var ior = object->_PR_getobj()->_getIOR();
  IIOP::ProfileBody body;
  IIOP::unmarshalProfile(ior->iopProfiles()[0], body);
  const auto octets = std::as_bytes(std::span(body.object_key.get_buffer(), body.object_key.length()));
  return {octets.begin(), octets.end()};
}

TEST_F(Hostile, a_port_lets_samples_in_as_long_as_its_type_may_need_while_it_is_connected) {
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", "corba_cdr"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  const std::size_t numbers = corba::room_for_samples(key_of(*orb, plan));
  EXPECT_GT(numbers, 12u);
  EXPECT_LT(numbers, 100'000u) << "no value of a TimedLong is longer";
  RTC::CameraImage seen{}, shown{};
  RTC::OutPort<RTC::CameraImage> eye{"A0.eye", seen};
  RTC::InPort<RTC::CameraImage> screen{"B0.screen", shown};
  auto view = profile({eye.getPortRef(), screen.getPortRef()}, {{"interface_type", "corba_cdr"}});
  ASSERT_EQ(eye.connect(view), RTC::RTC_OK);
  const auto key = key_of(*orb, view);
  EXPECT_GT(corba::room_for_samples(key), std::size_t{1} << 30) << "the process has the last word";
  ASSERT_EQ(eye.disconnect(view.connector_id), RTC::RTC_OK);
  EXPECT_EQ(corba::room_for_samples(key), 0u) << "a connection that has ended needs nothing";
}

TEST_F(Hostile, a_connection_of_too_many_ports_is_refused) {
  auto plan = profile({out.getPortRef()});
  plan.ports.length(300);
  for (CORBA::ULong i = 1; i < 300; ++i) plan.ports[i] = RTC::PortService::_duplicate(in.getPortRef());
  EXPECT_EQ(out.connect(plan), RTC::BAD_PARAMETER);
}

TEST_F(Hostile, one_deadline_counts_for_a_chain_of_any_length) {
  EXPECT_EQ(corba::chain_timeout(10s, 2, 2), 10s);
  EXPECT_EQ(corba::chain_timeout(10s, 1, 2), 5s);
  EXPECT_EQ(corba::chain_timeout(10s, 200, 200), 10s);
  EXPECT_LT(corba::chain_timeout(10s, 199, 200), 10s);
  EXPECT_GT(corba::chain_timeout(10s, 1, 200), 0s);
  const corba::ChainDeadline deadline(1ms);
  EXPECT_TRUE(ports::eventually([&] { return deadline.is_over(); }));
}

// One port alone is a connection, too; then there is nobody whom the watch for dead peers could miss.
TEST_F(Hostile, a_call_with_a_sample_waits_no_longer_than_calls_of_its_connection_may_take) {
  const ports::Pairs patient = {{"buffer.length", "1"},         {"buffer.write.full_policy", "block"}, {"buffer.write.timeout", "1e6"},
                                {"buffer.read.timeout", "1e6"}, {"buffer.read.empty_policy", "block"}, {"call_timeout", "0.1"}};
  const auto object_of = [&](const RTC::ConnectorProfile& plan, const char* key) {
    return CORBA::Object_var(orb->orb()->string_to_object(NVUtil::toString(plan.properties, key).c_str()));
  };
  auto push = profile({in.getPortRef()}, patient);
  ASSERT_EQ(in.connect(push), RTC::RTC_OK);
  const OpenRTM::InPortCdr_var to = OpenRTM::InPortCdr::_narrow(object_of(push, "dataport.corba_cdr.inport_ior"));
  OpenRTM::CdrData octets;
  octets.length(12);  // a TimedLong
  std::fill_n(octets.get_buffer(), 12, CORBA::Octet{0});
  ASSERT_EQ(to->put(octets), OpenRTM::PORT_OK);
  auto putting = std::async(std::launch::async, [&] { return to->put(octets); });
  EXPECT_EQ(putting.wait_for(support::watchdog), std::future_status::ready);
  in.disconnect(push.connector_id);
  EXPECT_EQ(putting.get(), OpenRTM::BUFFER_TIMEOUT);

  auto pull = profile({out.getPortRef()}, patient);
  NVUtil::setStringValue(pull.properties, "dataport.dataflow_type", "pull");
  ASSERT_EQ(out.connect(pull), RTC::RTC_OK);
  const OpenRTM::OutPortCdr_var from = OpenRTM::OutPortCdr::_narrow(object_of(pull, "dataport.corba_cdr.outport_ior"));
  auto getting = std::async(std::launch::async, [&] {
    OpenRTM::CdrData_var data;
    return from->get(data.out());
  });
  EXPECT_EQ(getting.wait_for(support::watchdog), std::future_status::ready);
  out.disconnect(pull.connector_id);
  EXPECT_EQ(getting.get(), OpenRTM::BUFFER_TIMEOUT);
}

TEST_F(Hostile, a_connection_asks_for_no_longer_timeout_than_a_minute_or_what_the_process_has) {
  rt::ConnectorSettings settings;
  const auto usual = corba::port_call_timeout();
  EXPECT_EQ(corba::line_of(settings).call_timeout, usual);
  settings.call_timeout = 30s;
  EXPECT_EQ(corba::line_of(settings).call_timeout, 30s);
  settings.call_timeout = 1'000'000s;
  EXPECT_EQ(corba::line_of(settings).call_timeout, 60s);
  corba::set_port_call_timeout(3600s);
  EXPECT_EQ(corba::line_of(settings).call_timeout, 3600s);
  corba::set_port_call_timeout(usual);
}

TEST_F(Hostile, a_reference_that_asks_a_server_of_the_senders_choice_is_none) {
  auto plan = profile({in.getPortRef()});
  plan.connector_id = "told";
  plan.ports.length(2);
  plan.ports[1] = RTC::PortService::_duplicate(out.getPortRef());
  for (int i = 0; i < 100; ++i)
    CORBA_SeqUtil::push_back(plan.properties, NVUtil::newNV("dataport.corba_cdr.outport_ior", "corbaname::192.0.2.1:9#x"));
  const auto start = steady_clock::now();
  in.notify_connect(plan);
  EXPECT_LT(steady_clock::now() - start, 5s) << "100 servers were asked";
}

TEST_F(Hostile, a_reference_to_an_object_of_the_orb_itself_is_none) {
  for (const char* text :
       {"corbaloc:rir:/RootPOA", "CORBALOC:rir:/POACurrent", "corbaloc:rir:/DynAnyFactory", "corbaloc:rir:/omniINSPOA"}) {
    auto plan = profile({in.getPortRef(), out.getPortRef()}, {{"corba_cdr.inport_ior", text}}, "told");
    EXPECT_NE(out.notify_connect(plan), RTC::RTC_OK) << text;
    auto back = profile({out.getPortRef(), in.getPortRef()}, {{"corba_cdr.outport_ior", text}, {"dataflow_type", "pull"}}, "told too");
    EXPECT_NE(in.notify_connect(back), RTC::RTC_OK) << text;
  }
}

TEST_F(Hostile, a_segment_that_its_sender_cuts_short_costs_the_receiver_one_sample) {
  const auto port = connect_and_steal();
  Segment segment;
  const int file = open(segment.path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
  ASSERT_EQ(ftruncate(file, 4 << 20), 0);
  port->open_memory(4 << 20, segment.name.c_str());
  const std::uint64_t length = 3 << 20;
  ASSERT_EQ(pwrite(file, &length, 8, 0), 8);
  std::atomic<bool> stop{false};
  std::thread cutter([&] {  // so that it happens in the middle of a read as well
    while (!stop) {
      if (ftruncate(file, 0) != 0 || ftruncate(file, 4 << 20) != 0 || pwrite(file, &length, 8, 0) != 8) return;
    }
  });
  for (int i = 0; i < 300; ++i) EXPECT_NE(port->put(), OpenRTM::UNKNOWN_ERROR);
  stop = true;
  cutter.join();
  close(file);
}

TEST_F(Hostile, a_receiver_that_cuts_the_senders_segment_costs_one_sample) {
  struct Reader : POA_OpenRTM::PortSharedMemory, PortableServer::RefCountServantBase {
    void open_memory(CORBA::ULongLong, const char* name) override {
      file = shm_open(("/" + std::string(name)).c_str(), O_RDWR | O_CLOEXEC, 0);
      if (file < 0) file = shm_open(name, O_RDWR | O_CLOEXEC, 0);
      ++opened;
    }
    void create_memory(CORBA::ULongLong, const char*) override {}
    void close_memory(CORBA::Boolean) override {}
    void setInterface(OpenRTM::PortSharedMemory_ptr) override {}
    void setEndian(CORBA::Boolean) override {}
    OpenRTM::PortStatus put() override { return ftruncate(file, 0) == 0 ? OpenRTM::PORT_OK : OpenRTM::PORT_ERROR; }
    OpenRTM::PortStatus get() override { return OpenRTM::UNKNOWN_ERROR; }
    int file = -1;
    int opened = 0;
  };
  struct Port : POA_RTC::PortService, PortableServer::RefCountServantBase {
    RTC::PortProfile* get_port_profile() override { return new RTC::PortProfile(); }
    RTC::ConnectorProfileList* get_connector_profiles() override { return new RTC::ConnectorProfileList(); }
    RTC::ConnectorProfile* get_connector_profile(const char*) override { return new RTC::ConnectorProfile(); }
    RTC::ReturnCode_t connect(RTC::ConnectorProfile&) override { return RTC::RTC_ERROR; }
    RTC::ReturnCode_t disconnect(const char*) override { return RTC::RTC_OK; }
    RTC::ReturnCode_t disconnect_all() override { return RTC::RTC_OK; }
    RTC::ReturnCode_t notify_connect(RTC::ConnectorProfile& plan) override {
      NVUtil::setStringValue(plan.properties, "dataport.corba_cdr.inport_ior", ior.c_str());
      return RTC::RTC_OK;
    }
    RTC::ReturnCode_t notify_disconnect(const char*) override { return RTC::RTC_OK; }
    std::string ior;
  };
  ports::Local<Reader> reader;
  const OpenRTM::PortSharedMemory_var reference = reader._this();
  ports::Local<Port> port;
  port.ior = CORBA::String_var(orb->orb()->object_to_string(reference)).in();
  const RTC::PortService_var port_reference = port._this();
  auto plan = profile({out.getPortRef(), port_reference}, {{"interface_type", "shared_memory"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  EXPECT_TRUE(out.write());
  EXPECT_FALSE(out.write()) << "the segment is gone";
  EXPECT_TRUE(out.write()) << "there is a new one";
  EXPECT_EQ(reader.opened, 2);
}

TEST_F(Hostile, what_is_no_segment_is_refused_at_once) {
  const auto port = connect_and_steal();
  Segment segment;
  ASSERT_EQ(mkfifo(segment.path.c_str(), 0600), 0);
  const auto start = steady_clock::now();
  EXPECT_THROW(port->open_memory(100, segment.name.c_str()), CORBA::SystemException);
  unlink(segment.path.c_str());
  ASSERT_EQ(symlink("/dev/zero", segment.path.c_str()), 0);
  EXPECT_THROW(port->open_memory(100, segment.name.c_str()), CORBA::SystemException);
  EXPECT_LT(steady_clock::now() - start, 5s);
}

// It would take any file of our account there whose first number fits.
TEST_F(Hostile, a_segment_of_the_simulator_is_none_of_a_sender) {
  const auto port = connect_and_steal();
  Segment segment;
  segment.name = "/rtmsim-0-0.camera." + std::to_string(getpid());
  segment.path = "/dev/shm" + segment.name;
  const int file = open(segment.path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
  ASSERT_EQ(ftruncate(file, 4096), 0);
  close(file);
  EXPECT_THROW(port->open_memory(4096, segment.name.c_str()), CORBA::SystemException);
  EXPECT_THROW(port->open_memory(4096, segment.name.c_str() + 1), CORBA::SystemException);
}

TEST_F(Hostile, a_segment_of_a_terabyte_of_nothing_costs_no_memory) {
  const auto port = connect_and_steal();
  Segment segment;
  const int file = open(segment.path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
  ASSERT_EQ(ftruncate(file, off_t{1} << 40), 0);
  const std::uint64_t length = (std::uint64_t{1} << 40) - 8;
  ASSERT_EQ(pwrite(file, &length, 8, 0), 8);
  close(file);
  port->open_memory(100, segment.name.c_str());
  EXPECT_EQ(port->put(), OpenRTM::PORT_ERROR);
}

}  // namespace
