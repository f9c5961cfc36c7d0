// Serializers of component authors: chosen by the connection, used by every transport but direct, and harmless when they fail.
#include <gtest/gtest.h>
#include <rtm/ByteDataStreamBase.h>
#include <rtm/CORBA_CdrMemoryStream.h>

#include <atomic>
#include <stdexcept>

#include "ports/support.h"

namespace serializers {
namespace {

using ports::profile;

std::atomic<int> serialized{0};
std::atomic<bool> saw_big_endian{false};

// Values as decimal text. Values above 1000 cannot be encoded, 1000 makes it throw.
class Text : public RTC::ByteDataStream<RTC::TimedLong> {
 public:
  void init(const coil::Properties& properties) override { end_ = properties.getProperty("text.end", "."); }
  void writeData(const unsigned char* buffer, unsigned long length) override {
    text_.assign(reinterpret_cast<const char*>(buffer), length);
  }
  void readData(unsigned char* buffer, unsigned long length) const override { std::copy_n(text_.data(), length, buffer); }
  unsigned long getDataLength() const override { return text_.size(); }
  void isLittleEndian(bool little) override { saw_big_endian = !little; }
  bool serialize(const RTC::TimedLong& data) override {
    ++serialized;
    if (data.data == 1000) throw std::runtime_error("not this one");
    text_ = std::to_string(data.data) + end_;
    return data.data < 1000;
  }
  bool deserialize(RTC::TimedLong& data) override {
    if (text_.size() < 2 || !text_.ends_with(end_)) return false;
    data.data = std::stoi(text_);
    return true;
  }

 private:
  std::string text_;
  std::string end_;
};

// A short that travels as a double.
class ShortAsDouble : public RTC::CORBA_CdrSerializer<RTC::TimedShort> {
 public:
  bool serialize(const RTC::TimedShort& data) override {
    RTC::TimedDouble wide;
    wide.tm = data.tm;
    wide.data = data.data;
    return m_cdr.serializeCDR(wide);
  }
  bool deserialize(RTC::TimedShort& data) override {
    RTC::TimedDouble wide;
    if (!m_cdr.deserializeCDR(wide)) return false;
    data.tm = wide.tm;
    data.data = static_cast<CORBA::Short>(wide.data);
    return true;
  }
};

const char* const double_name = "cdr:RTC/TimedDouble:RTC/TimedShort";

struct Way {
  const char* interface;
  const char* dataflow;
};

class Serializing : public testing::TestWithParam<Way> {
 protected:
  Serializing() {
    RTC::addSerializer<RTC::TimedLong, Text>("text");
    RTC::addSerializer<RTC::TimedShort, ShortAsDouble>(double_name);
  }
  ~Serializing() override {
    RTC::removeSerializer<RTC::TimedLong>("text");
    RTC::removeSerializer<RTC::TimedShort>(double_name);
  }

  std::unique_ptr<corba::Orb> orb = ports::start_orb();
  RTC::TimedLong sent{};
  RTC::TimedLong received{};
  RTC::OutPort<RTC::TimedLong> out{"A0.out", sent};
  RTC::InPort<RTC::TimedLong> in{"B0.in", received};

  RTC::ReturnCode_t connect(ports::Pairs properties) {
    auto plan = profile({out.getPortRef(), in.getPortRef()}, properties);
    return out.connect(plan);
  }
};

INSTANTIATE_TEST_SUITE_P(Ways, Serializing,
                         testing::Values(Way{"corba_cdr", "push"}, Way{"corba_cdr", "pull"}, Way{"data_service", "push"},
                                         Way{"data_service", "pull"}, Way{"shared_memory", "push"}, Way{"shared_memory", "pull"}),
                         [](const auto& way) { return std::string(way.param.interface) + "_" + way.param.dataflow; });
using SerializingOnce = Serializing;
INSTANTIATE_TEST_SUITE_P(Once, SerializingOnce, testing::Values(Way{"corba_cdr", "push"}),
                         [](const auto&) { return std::string("corba_cdr_push"); });

TEST_P(Serializing, the_one_that_the_connection_names_makes_the_octets) {
  struct Raw : RTC::ConnectorDataListener {
    std::string octets;
    std::string type;
    ReturnCode operator()(RTC::ConnectorInfo&, RTC::ByteData& data, const std::string& marshaling) override {
      octets.assign(reinterpret_cast<const char*>(data.getBuffer()), data.getDataLength());
      type = marshaling;
      return NO_CHANGE;
    }
  } raw;
  in.addConnectorDataListener(RTC::ON_RECEIVED, &raw, false);
  ASSERT_EQ(connect({{"interface_type", GetParam().interface},
                     {"dataflow_type", GetParam().dataflow},
                     {"marshaling_type", " text "},
                     {"text.end", "!"},
                     {"serializer.cdr.endian", "big,little"}}),
            RTC::RTC_OK);
  for (sent.data = 40; sent.data < 43; ++sent.data) {
    ASSERT_TRUE(out.write());
    ASSERT_TRUE(in.read());
    EXPECT_EQ(received.data, sent.data);
  }
  EXPECT_EQ(raw.octets, "42!") << "the properties of the connection reach init";
  EXPECT_EQ(raw.type, "text");
  EXPECT_TRUE(saw_big_endian);
  in.removeConnectorDataListener(RTC::ON_RECEIVED, &raw);
}

TEST_P(Serializing, one_end_may_turn_a_type_into_another) {
  RTC::TimedShort small{};
  RTC::TimedDouble large{};
  RTC::OutPort<RTC::TimedShort> short_out("A0.short", small);
  RTC::InPort<RTC::TimedDouble> double_in("B0.double", large);
  for (const bool is_own : {false, true}) {
    auto plan = profile({double_in.getPortRef(), short_out.getPortRef()},
                        {{"interface_type", GetParam().interface}, {"dataflow_type", GetParam().dataflow}});
    if (is_own) {
      coil::Properties own;
      own.setProperty("marshaling_type", double_name);
      short_out.init(own);
    } else {
      EXPECT_EQ(double_in.connect(plan), RTC::BAD_PARAMETER) << "without it the types do not fit";
      plan = profile({double_in.getPortRef(), short_out.getPortRef()}, {{"interface_type", GetParam().interface},
                                                                        {"dataflow_type", GetParam().dataflow},
                                                                        {"inport.marshaling_type", "cdr"},
                                                                        {"outport.marshaling_type", double_name}});
    }
    if (is_own) plan = profile({short_out.getPortRef(), double_in.getPortRef()}, {{"interface_type", GetParam().interface}});
    ASSERT_EQ(double_in.connect(plan), RTC::RTC_OK) << is_own;
    small.data = -7;
    small.tm.sec = 3;
    ASSERT_TRUE(short_out.write());
    ASSERT_TRUE(double_in.read());
    EXPECT_EQ(large.data, -7.0);
    EXPECT_EQ(large.tm.sec, 3u);
    short_out.disconnect_all();
  }
}

TEST_P(SerializingOnce, publishers_and_typed_listeners_meet_the_value) {
  struct Typed : RTC::ConnectorDataListenerT<RTC::TimedLong> {
    ReturnCode operator()(RTC::ConnectorInfo&, RTC::TimedLong& value) override {
      value.data += 100;
      return DATA_CHANGED;
    }
  } typed;
  in.addConnectorDataListener(RTC::ON_RECEIVED, &typed, false);
  ASSERT_EQ(connect({{"marshaling_type", "text"}, {"subscription_type", "new"}, {"timestamp_policy", "on_send"}}), RTC::RTC_OK);
  sent.data = 5;
  ASSERT_TRUE(out.write());
  ASSERT_TRUE(ports::eventually([&] { return in.isNew(); }));
  ASSERT_TRUE(in.read());
  EXPECT_EQ(received.data, 105);
  EXPECT_EQ(received.tm.sec, 0u) << "the text has no room for stamps";
  in.removeConnectorDataListener(RTC::ON_RECEIVED, &typed);
}

TEST_P(SerializingOnce, connections_that_name_none_are_not_touched) {
  RTC::TimedLong also{};
  RTC::InPort<RTC::TimedLong> plain("C0.in", also);
  ASSERT_EQ(connect({{"marshaling_type", "text"}}), RTC::RTC_OK);
  auto plan = profile({out.getPortRef(), plain.getPortRef()}, {{"marshaling_type", "cdr"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  sent.data = 11;
  sent.tm.sec = 2;
  ASSERT_TRUE(out.write());
  ASSERT_TRUE(in.read());
  ASSERT_TRUE(plain.read());
  EXPECT_EQ(received.data, 11);
  EXPECT_EQ(also.data, 11);
  EXPECT_EQ(also.tm.sec, 2u);
}

TEST_P(SerializingOnce, direct_hands_over_the_value) {
  ASSERT_EQ(connect({{"marshaling_type", "text"}, {"interface_type", "direct"}}), RTC::RTC_OK);
  const int before = serialized;
  sent.data = 12;
  sent.tm.sec = 9;
  ASSERT_TRUE(out.write());
  ASSERT_TRUE(in.read());
  EXPECT_EQ(received.data, 12);
  EXPECT_EQ(received.tm.sec, 9u);
  EXPECT_EQ(serialized, before);
}

TEST_P(SerializingOnce, an_unknown_one_is_refused_and_leaves_nothing) {
  for (const char* key : {"marshaling_type", "inport.marshaling_type", "outport.marshaling_type"}) {
    for (const char* interface : {"corba_cdr", "shared_memory", "direct"}) {
      for (const char* dataflow : {"push", "pull"}) {
        EXPECT_EQ(connect({{"interface_type", interface}, {"dataflow_type", dataflow}, {key, "TEXT"}}), RTC::RTC_ERROR) << key;
        EXPECT_EQ(connect({{"interface_type", interface}, {"dataflow_type", dataflow}, {key, double_name}}), RTC::RTC_ERROR)
            << "registered for another type";
      }
    }
  }
  EXPECT_TRUE(out.connectors().empty());
  EXPECT_TRUE(in.connectors().empty());
}

TEST_P(SerializingOnce, what_it_cannot_encode_or_throws_at_fails_the_write_alone) {
  ASSERT_EQ(connect({{"marshaling_type", "text"}}), RTC::RTC_OK);
  for (const int bad : {1000, 1001}) {
    sent.data = bad;
    EXPECT_FALSE(out.write());
    EXPECT_EQ(out.getStatus(0), RTC::DataPortStatus::PORT_ERROR);
    EXPECT_FALSE(in.isNew());
  }
  sent.data = 13;
  EXPECT_TRUE(out.write());
  ASSERT_TRUE(in.read());
  EXPECT_EQ(received.data, 13);
}

TEST_P(SerializingOnce, octets_that_are_no_value_are_dropped) {
  ASSERT_EQ(connect({{"inport.marshaling_type", "text"}}), RTC::RTC_OK);
  received.data = 3;
  sent.data = 14;
  EXPECT_TRUE(out.write()) << "plain CDR";
  EXPECT_TRUE(in.isNew());
  EXPECT_FALSE(in.read());
  EXPECT_EQ(received.data, 3);
}

TEST_P(SerializingOnce, the_profile_lists_cdr_and_what_is_registered_by_then) {
  const auto shown = [&](RTC::PortBase& port) {
    const RTC::PortProfile_var profile = port.get_port_profile();
    return NVUtil::toString(profile->properties, "dataport.marshaling_types");
  };
  EXPECT_EQ(shown(in), "cdr,text");
  EXPECT_EQ(shown(out), "cdr,text");
  RTC::addSerializer<RTC::TimedLong, Text>("a later one");
  EXPECT_EQ(shown(in), "cdr,a later one,text");
  RTC::removeSerializer<RTC::TimedLong>("a later one");
  EXPECT_EQ(shown(in), "cdr,text");
}

TEST_P(SerializingOnce, cdr_is_there_for_authors_too) {
  auto& factory = coil::GlobalFactory<RTC::ByteDataStream<RTC::TimedLong>>::instance();
  auto* cdr = factory.createObject("cdr");
  ASSERT_NE(cdr, nullptr);
  sent.data = 15;
  ASSERT_TRUE(cdr->serialize(sent));
  const RTC::ByteData octets(*cdr);
  EXPECT_EQ(octets.getDataLength(), 12u);
  RTC::CORBA_CdrSerializer<RTC::TimedLong> other;
  other.writeData(octets.getBuffer(), octets.getDataLength());
  const RTC::CORBA_CdrSerializer<RTC::TimedLong> copied = other;
  EXPECT_EQ(copied.getDataLength(), 12u);
  ASSERT_TRUE(other.deserialize(received));
  EXPECT_EQ(received.data, 15);
  EXPECT_FALSE(other.deserialize(received)) << "there is no second one in it";
  factory.deleteObject(cdr);
}

}  // namespace
}  // namespace serializers
