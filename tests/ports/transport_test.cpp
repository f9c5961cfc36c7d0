// Samples over every transport, inside a process and between two.
#include <gtest/gtest.h>
#include <rtm/CORBA_CdrMemoryStream.h>
#include <rtm/idl/DataPort_OpenRTMSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <algorithm>
#include <cstring>
#include <tuple>

#include "base/hash64.h"
#include "base/tick.h"
#include "component/runtime_access.h"
#include "corba/orb/call_timeout.h"
#include "corba/transport/cdr.h"
#include "ports/support.h"

namespace {

using ports::profile;

struct Way {
  const char* interface;
  const char* dataflow;
};

class Transport : public testing::TestWithParam<Way> {
 protected:
  std::unique_ptr<corba::Orb> orb = ports::start_orb();
  std::string interface = GetParam().interface;
  std::string dataflow = GetParam().dataflow;
};

void PrintTo(const Way& way, std::ostream* out) { *out << way.interface << ' ' << way.dataflow; }

std::string name_of(const testing::TestParamInfo<Way>& way) { return std::string(way.param.interface) + "_" + way.param.dataflow; }

INSTANTIATE_TEST_SUITE_P(Ways, Transport,
                         testing::Values(Way{"corba_cdr", "push"}, Way{"corba_cdr", "pull"}, Way{"data_service", "push"},
                                         Way{"data_service", "pull"}, Way{"direct", "push"}, Way{"direct", "pull"},
                                         Way{"shared_memory", "push"}, Way{"shared_memory", "pull"}),
                         name_of);

// Keeps a hash of each sample that passes.
class KeepingTick final : public ports::LookingTick {
 public:
  void passed(const base::Passage& passage) override {
    base::Hash64 hash;
    for (const auto& part : passage.octets) hash.add(part);
    if (passage.hash != nullptr) *passage.hash = hash.value();
    hashes.push_back(hash.value());
  }
  bool passed_again(const base::Passage&, std::uint64_t hash) override {
    if (!takes_hashes) return false;
    ++again;
    hashes.push_back(hash);
    return true;
  }
  std::vector<std::uint64_t> hashes;
  int again = 0;
  bool takes_hashes = true;
};

// A connection for pictures.
struct Line {
  RTC::CameraImage sent{};
  RTC::CameraImage received{};
  RTC::OutPort<RTC::CameraImage> out{"A0.out", sent};
  RTC::InPort<RTC::CameraImage> in{"B0.in", received};
  void connect(const std::string& interface, const std::string& dataflow) {
    auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", interface}, {"dataflow_type", dataflow}});
    ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  }
  void pass() {
    ASSERT_TRUE(out.write());
    ASSERT_TRUE(ports::eventually([&] { return in.isNew(); }));
    ASSERT_TRUE(in.read());
  }
};

TEST_P(Transport, a_tick_sees_the_same_octets_when_they_are_read_as_when_they_were_written) {
  Line line;
  line.connect(interface, dataflow);
  for (const bool takes_hashes : {true, false}) {
    KeepingTick tick;
    tick.takes_hashes = takes_hashes;
    const base::ScopedTick scope(tick);
    for (const CORBA::ULong size : {1u, 5000u}) {
      line.sent.pixels.length(size);
      line.sent.pixels[size - 1] = static_cast<CORBA::Octet>(size);
      line.pass();
    }
    ASSERT_EQ(tick.hashes.size(), 4U);
    EXPECT_EQ(tick.hashes[0], tick.hashes[1]);
    EXPECT_EQ(tick.hashes[2], tick.hashes[3]);
    EXPECT_NE(tick.hashes[0], tick.hashes[2]);
    // A value that is handed over as it is need not be encoded once more.
    EXPECT_EQ(tick.again, takes_hashes && interface == "direct" ? 2 : 0);
  }
}

TEST_P(Transport, a_tick_sees_what_listeners_of_the_reader_have_made_of_the_data) {
  struct Darker : RTC::ConnectorDataListenerT<RTC::CameraImage> {
    ReturnCode operator()(RTC::ConnectorInfo&, RTC::CameraImage& image) override { return --image.pixels[0], DATA_CHANGED; }
  };
  struct Brighter : RTC::ConnectorDataListener {
    ReturnCode operator()(RTC::ConnectorInfo&, RTC::ByteData& data, const std::string&) override {
      auto& last = data.getBuffer()[data.getDataLength() - 1];
      last = static_cast<unsigned char>(last + 1);
      return DATA_CHANGED;
    }
  };
  for (const auto event : {RTC::ConnectorDataListenerType::ON_RECEIVED, RTC::ConnectorDataListenerType::ON_BUFFER_READ}) {
    for (const bool is_raw : {false, true}) {
      Line line;
      line.connect(interface, dataflow);
      line.in.addConnectorDataListener(event, is_raw ? static_cast<RTC::ConnectorDataListener*>(new Brighter) : new Darker);
      KeepingTick tick;
      const base::ScopedTick scope(tick);
      line.sent.pixels.length(5000);
      line.sent.pixels[0] = 7;
      line.pass();
      ASSERT_EQ(tick.hashes.size(), 2U);
      EXPECT_NE(tick.hashes[0], tick.hashes[1]) << is_raw;
      EXPECT_TRUE(is_raw || line.received.pixels[0] == 6);
    }
  }
}

// Of what the InPort has received; with pull, what was not fetched has not been.
class Push : public Transport {};
INSTANTIATE_TEST_SUITE_P(Ways, Push,
                         testing::Values(Way{"corba_cdr", "push"}, Way{"data_service", "push"}, Way{"direct", "push"},
                                         Way{"shared_memory", "push"}),
                         name_of);

TEST_P(Transport, samples_of_all_sizes_arrive_whole_and_once) {
  for (const char* order : {"little,big", "big,little"}) {
    RTC::CameraImage sent{};
    RTC::CameraImage received{};
    RTC::OutPort<RTC::CameraImage> out("A0.out", sent);
    RTC::InPort<RTC::CameraImage> in("B0.in", received);
    auto plan = profile({out.getPortRef(), in.getPortRef()},
                        {{"interface_type", interface}, {"dataflow_type", dataflow}, {"serializer.cdr.endian", order}});
    ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
    EXPECT_FALSE(in.isNew());
    EXPECT_FALSE(in.read());
    for (const CORBA::ULong size : {0u, 1u, 100u, 4095u, 4096u, 100'001u, 3'000'000u}) {
      sent.tm.sec = size;
      sent.width = 7;
      sent.format = "rgb";
      sent.fDiv = 0.25;
      sent.pixels.length(size);
      for (CORBA::ULong i = 0; i < size; ++i) sent.pixels[i] = static_cast<CORBA::Octet>(i * 7);
      ASSERT_TRUE(out.write()) << size;
      ASSERT_TRUE(in.isNew()) << size;
      ASSERT_TRUE(in.read()) << size;
      EXPECT_EQ(received.tm.sec, size);
      EXPECT_EQ(received.width, 7);
      EXPECT_STREQ(received.format, "rgb");
      EXPECT_EQ(received.fDiv, 0.25);
      ASSERT_EQ(received.pixels.length(), size);
      EXPECT_TRUE(std::equal(sent.pixels.get_buffer(), sent.pixels.get_buffer() + size, received.pixels.get_buffer()));
      EXPECT_FALSE(in.isNew());
    }
    EXPECT_TRUE(in.read()) << "readback";
    EXPECT_EQ(in.getStatus(0), RTC::DataPortStatus::PORT_OK);
  }
}

TEST_P(Transport, a_disconnected_port_reads_and_writes_nothing) {
  RTC::TimedLong value{};
  RTC::OutPort<RTC::TimedLong> out("A0.out", value);
  RTC::InPort<RTC::TimedLong> in("B0.in", value);
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", interface}, {"dataflow_type", dataflow}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  out.write();
  in.read();
  out.disconnect_all();
  EXPECT_FALSE(in.isNew());
  EXPECT_FALSE(in.read());
  EXPECT_FALSE(out.write());
}

TEST_P(Push, what_was_received_is_read_after_the_connection_has_ended) {
  RTC::TimedLong sent{};
  RTC::TimedLong received{};
  RTC::OutPort<RTC::TimedLong> out("A0.out", sent);
  RTC::InPort<RTC::TimedLong> in("B0.in", received);
  // A tool that connects, puts a value and disconnects, several times before the component looks.
  for (sent.data = 1; sent.data <= 3; ++sent.data) {
    auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", interface}, {"dataflow_type", dataflow}});
    ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
    ASSERT_TRUE(out.write());
    ASSERT_EQ(out.disconnect_all(), RTC::RTC_OK);
  }
  EXPECT_TRUE(in.connectors().empty());
  for (int i = 1; i <= 3; ++i) {
    EXPECT_TRUE(in.isNew());
    EXPECT_TRUE(in.isNew("test"));
    ASSERT_TRUE(i == 2 ? in.read("test") : in.read());
    EXPECT_EQ(received.data, i);
  }
  EXPECT_FALSE(in.isNew());
  EXPECT_FALSE(in.read());
  // Then in order with what comes over a living connection.
  auto first = profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", interface}, {"dataflow_type", dataflow}});
  auto second = first;
  ASSERT_EQ(out.connect(first), RTC::RTC_OK);
  out.write();
  out.disconnect_all();
  ASSERT_EQ(out.connect(second), RTC::RTC_OK);
  sent.data = 17;
  out.write();
  EXPECT_TRUE(in.read());
  EXPECT_EQ(received.data, 4);
  EXPECT_TRUE(in.read());
  EXPECT_EQ(received.data, 17);
  EXPECT_TRUE(in.read()) << "readback";
}

TEST_P(Transport, the_buffers_of_a_connection_show_what_waits) {
  RTC::TimedLong value{};
  RTC::OutPort<RTC::TimedLong> out("A0.out", value);
  RTC::InPort<RTC::TimedLong> in("B0.in", value);
  auto plan =
      profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", interface}, {"dataflow_type", dataflow}, {"buffer.length", "3"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  // Where the samples stay until they are read.
  RTC::CdrBufferBase* keeping = dataflow == "push" ? in.connectors()[0]->getBuffer() : out.connectors()[0]->getBuffer();
  RTC::CdrBufferBase* other = dataflow == "push" ? out.connectors()[0]->getBuffer() : in.connectors()[0]->getBuffer();
  EXPECT_EQ(keeping->length(), 3u);
  EXPECT_TRUE(keeping->empty());
  for (value.data = 0; value.data < 5; ++value.data) ASSERT_TRUE(out.write());
  EXPECT_EQ(keeping->readable(), 3u);
  EXPECT_EQ(keeping->writable(), 0u);
  EXPECT_TRUE(keeping->full());
  EXPECT_TRUE(other->empty());
  ASSERT_TRUE(in.read());
  EXPECT_EQ(value.data, 2);
  EXPECT_EQ(keeping->readable(), 2u);
  keeping->reset();
  EXPECT_EQ(keeping->readable(), 0u);
  EXPECT_EQ(keeping->writable(), 3u);
  EXPECT_FALSE(dataflow == "push" && in.read()) << "nor is the last one read again";
  out.disconnect_all();
}

TEST_P(Push, what_nobody_reads_of_closed_connections_is_bounded) {
  RTC::TimedLong sent{};
  RTC::TimedLong received{};
  RTC::OutPort<RTC::TimedLong> out("A0.out", sent);
  RTC::InPort<RTC::TimedLong> in("B0.in", received);
  for (sent.data = 0; sent.data < 100; ++sent.data) {
    auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", interface}, {"dataflow_type", dataflow}});
    ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
    ASSERT_TRUE(out.write());
    ASSERT_EQ(out.disconnect_all(), RTC::RTC_OK);
  }
  int count = 0;
  while (in.isNew()) {
    ASSERT_TRUE(in.read());
    ++count;
  }
  EXPECT_EQ(count, 64);
  EXPECT_EQ(received.data, 99);
}

TEST_P(Transport, works_between_processes_in_both_directions) {
  ports::Peer peer;
  RTC::TimedOctetSeq value{};
  RTC::OutPort<RTC::TimedOctetSeq> out("A0.out", value);
  RTC::InPort<RTC::TimedOctetSeq> in("B0.in", value);
  const RTC::PortService_var far_in = peer.port("in");
  const RTC::PortService_var far_out = peer.port("out");
  for (int turn = 0; turn < 2; ++turn) {
    auto forth = turn ? profile({far_in, out.getPortRef()}, {{"interface_type", interface}, {"dataflow_type", dataflow}})
                      : profile({out.getPortRef(), far_in}, {{"interface_type", interface}, {"dataflow_type", dataflow}});
    auto back = turn ? profile({in.getPortRef(), far_out}, {{"interface_type", interface}, {"dataflow_type", dataflow}})
                     : profile({far_out, in.getPortRef()}, {{"interface_type", interface}, {"dataflow_type", dataflow}});
    if (interface == "direct") {
      EXPECT_EQ(out.connect(forth), RTC::RTC_ERROR);
      EXPECT_TRUE(out.connectors().empty());
      const RTC::ConnectorProfileList_var left = far_in->get_connector_profiles();
      EXPECT_EQ(left->length(), 0u);
      continue;
    }
    ASSERT_EQ(turn ? far_in->connect(forth) : out.connect(forth), RTC::RTC_OK);
    value.data.length(3'000'000);
    EXPECT_TRUE(out.write());
    value.data.length(10);
    EXPECT_TRUE(out.write());
    ASSERT_EQ(in.connect(back), RTC::RTC_OK);
    EXPECT_FALSE(in.isNew()) << "the peer has written nothing";
    EXPECT_EQ(out.disconnect_all(), RTC::RTC_OK);
    EXPECT_EQ(in.disconnect_all(), RTC::RTC_OK);
    const RTC::ConnectorProfileList_var left = far_out->get_connector_profiles();
    EXPECT_EQ(left->length(), 0u);
  }
  EXPECT_EQ(peer.process().stop(), 0);
}

class Samples : public testing::Test {
 protected:
  std::unique_ptr<corba::Orb> orb = ports::start_orb();
  RTC::TimedLong sent{};
  RTC::TimedLong received{};
  RTC::OutPort<RTC::TimedLong> out{"A0.out", sent};
  RTC::InPort<RTC::TimedLong> in{"B0.in", received};

  void connect(ports::Pairs properties) {
    auto plan = profile({out.getPortRef(), in.getPortRef()}, properties);
    ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  }
};

TEST_F(Samples, a_subscription_new_delivers_the_last_value) {
  connect({{"subscription_type", "new"}});
  for (int i = 1; i <= 300; ++i) {
    sent.data = 2 * i;
    EXPECT_TRUE(out.write());
    sent.data = 2 * i + 1;
    EXPECT_TRUE(out.write());
    ASSERT_TRUE(ports::eventually([&] { return in.read() && received.data == 2 * i + 1; }));
  }
}

TEST_F(Samples, a_periodic_subscription_delivers) {
  connect({{"subscription_type", "periodic"}, {"publisher.push_rate", "1000"}, {"publisher.push_policy", "all"}});
  sent.data = 11;
  EXPECT_TRUE(out.write());
  EXPECT_TRUE(ports::eventually([&] { return in.isNew(); }));
}

TEST_F(Samples, the_status_says_that_the_receiver_is_full) {
  connect({{"inport.buffer.length", "1"}, {"inport.buffer.write.full_policy", "do_nothing"}});
  EXPECT_TRUE(out.write());
  EXPECT_FALSE(out.write());
  EXPECT_EQ(out.getStatus(0), RTC::DataPortStatus::SEND_FULL);
  EXPECT_EQ(out.getStatus(1), RTC::DataPortStatus::UNKNOWN_ERROR);
}

TEST_F(Samples, stamps_are_set_where_the_policy_says) {
  for (const char* policy : {"on_write", "on_send", "on_received", "on_read"}) {
    for (const char* subscription : {"flush", "new"}) {
      connect({{"timestamp_policy", policy}, {"subscription_type", subscription}});
      sent.tm.sec = 0;
      received.tm.sec = 0;
      out.write();
      ASSERT_TRUE(ports::eventually([&] { return in.isNew(); }));
      in.read();
      EXPECT_GT(received.tm.sec, 1'000'000'000u) << policy << ' ' << subscription;
      EXPECT_EQ(sent.tm.sec, 0u) << "the component's variable is its own";
      out.disconnect_all();
    }
  }
}

TEST_F(Samples, connections_have_a_buffer_each) {
  RTC::OutPort<RTC::TimedLong> second("C0.out", sent);
  connect({{"buffer.length", "1"}});
  auto plan = profile({second.getPortRef(), in.getPortRef()}, {{"buffer.length", "4"}});
  plan.name = "second";
  ASSERT_EQ(second.connect(plan), RTC::RTC_OK);
  sent.data = 1;
  out.write();
  for (sent.data = 10; sent.data < 14; ++sent.data) second.write();
  EXPECT_TRUE(in.isNew("second"));
  in.read();
  EXPECT_EQ(received.data, 1);
  in.read("second");
  EXPECT_EQ(received.data, 10);
  coil::vstring names;
  EXPECT_TRUE(in.isNew(names));
  EXPECT_EQ(names, coil::vstring{"second"});
}

TEST_F(Samples, convert_callbacks_change_the_value) {
  struct Twice : RTC::OnWriteConvert<RTC::TimedLong> {
    RTC::TimedLong operator()(const RTC::TimedLong& value) override {
      RTC::TimedLong twice = value;
      twice.data *= 2;
      return twice;
    }
  } twice;
  struct PlusOne : RTC::OnReadConvert<RTC::TimedLong> {
    RTC::TimedLong operator()(const RTC::TimedLong& value) override {
      RTC::TimedLong more = value;
      more.data += 1;
      return more;
    }
  } plus_one;
  connect({});
  out.setOnWriteConvert(&twice);
  in.setOnReadConvert(&plus_one);
  sent.data = 4;
  out << sent;
  in >> received;
  EXPECT_EQ(received.data, 9);
}

TEST_F(Samples, writers_in_two_threads_and_disconnecting_do_not_disturb_each_other) {
  for (const char* subscription : {"flush", "new"}) {
    std::atomic<bool> ends{false};
    std::vector<std::thread> writers;
    for (int i = 0; i < 2; ++i) {
      writers.emplace_back([&] {
        RTC::TimedLong own{};
        while (!ends) out.write(own);
      });
    }
    for (int i = 0; i < 100; ++i) {
      connect({{"subscription_type", subscription}});
      in.read();
      EXPECT_EQ(out.disconnect_all(), RTC::RTC_OK);
    }
    ends = true;
    for (auto& writer : writers) writer.join();
    EXPECT_TRUE(in.connectors().empty());
  }
}

std::vector<unsigned char> octets_of(const RTC::ByteDataStreamBase& stream) {
  std::vector<unsigned char> octets(stream.getDataLength());
  stream.readData(octets.data(), octets.size());
  return octets;
}

TEST(Payload, the_octets_are_the_plain_encoding) {
  RTC::TimedLong value{};
  value.tm.sec = 0x240;
  value.data = 0x12345678;
  RTC::CORBA_CdrSerializer<RTC::TimedLong> stream;
  ASSERT_TRUE(stream.serialize(value));
  const std::vector<unsigned char> expected = {0x40, 2, 0, 0, 0, 0, 0, 0, 0x78, 0x56, 0x34, 0x12};
  EXPECT_EQ(octets_of(stream), expected);
}

TEST(Payload, the_octets_between_members_are_zero_whatever_was_encoded_before) {
  const auto orb = ports::start_orb();
  RTC::TimedOctetSeq full{};
  full.data.length(2000);
  std::fill_n(full.data.get_buffer(), 2000, CORBA::Octet{0xff});
  RTC::TimedDoubleSeq value{};
  value.data.length(2);
  value.data[0] = 0.0;
  value.data[1] = 1.0;
  RTC::CORBA_CdrMemoryStream own;
  for (const auto order : {rt::ByteOrder::little, rt::ByteOrder::big}) {
    std::ignore = corba::encode(RTC::RuntimeAccess::ops(RTC::detail::data_type<RTC::TimedOctetSeq>()), &full, order);
    const auto block = corba::encode(RTC::RuntimeAccess::ops(RTC::detail::data_type<RTC::TimedDoubleSeq>()), &value, order);
    ASSERT_TRUE(own.serializeCDR(full));
    own.setEndian(order == rt::ByteOrder::little);
    ASSERT_TRUE(own.serializeCDR(value));
    ASSERT_EQ(block->size(), 32u);
    ASSERT_EQ(own.getCdrDataLength(), 32u);
    EXPECT_EQ(std::memcmp(block->data(), own.getBuffer(), 32), 0);
    for (int i = 12; i < 24; ++i) EXPECT_EQ(block->data()[i], std::byte{0}) << "octet " << i;
  }
}

TEST(Payload, lengths_that_overflow_32_bits_are_refused) {
  const auto orb = ports::start_orb();
  RTC::TimedDoubleSeq value{};
  value.data.length(2);
  for (const CORBA::ULong length : {0x20000000u, 0x20000001u, 0x80000000u, 0xffffffffu}) {
    alignas(8) std::byte octets[64] = {};
    std::memcpy(octets + 8, &length, 4);
    EXPECT_FALSE(
        corba::decode_safely(RTC::RuntimeAccess::ops(RTC::detail::data_type<RTC::TimedDoubleSeq>()), &value, octets, rt::ByteOrder::little))
        << length;
    EXPECT_EQ(value.data.length(), 2u);
  }
}

TEST(Payload, long_arrays_are_aligned_as_if_copied) {
  const auto orb = ports::start_orb();  // brings the code sets of strings
  for (CORBA::ULong size = 5000; size < 5009; ++size) {
    RTC::CameraImage image{};
    image.format = "x";
    image.pixels.length(size);
    RTC::CORBA_CdrSerializer<RTC::CameraImage> stream;
    ASSERT_TRUE(stream.serialize(image));
    cdrMemoryStream plain;
    image >>= plain;
    ASSERT_EQ(stream.getDataLength(), plain.bufSize());
    EXPECT_EQ(std::memcmp(octets_of(stream).data(), plain.bufPtr(), plain.bufSize()), 0);
  }
}

}  // namespace
