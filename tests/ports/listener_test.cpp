#include <gtest/gtest.h>

#include <map>

#include "ports/support.h"

namespace {

using ports::profile;
using RTC::ConnectorDataListenerT;

class Listeners : public testing::Test {
 protected:
  struct Note : ConnectorDataListenerT<RTC::TimedLong> {
    Note(std::vector<std::string>& told, std::string what) : told(told), what(std::move(what)) {}
    ReturnCode operator()(RTC::ConnectorInfo&, RTC::TimedLong& data) override {
      told.push_back(what + " " + std::to_string(data.data));
      return ConnectorListenerStatus::NO_CHANGE;
    }
    std::vector<std::string>& told;
    std::string what;
  };
  struct NoteEvent : RTC::ConnectorListener {
    NoteEvent(std::vector<std::string>& told, std::string what) : told(told), what(std::move(what)) {}
    ReturnCode operator()(RTC::ConnectorInfo& info) override { return told.push_back(what + " " + info.name), NO_CHANGE; }
    std::vector<std::string>& told;
    std::string what;
  };

  template <class Port>
  void listen(Port& port, const std::string& name) {
    for (int i = 0; i < RTC::CONNECTOR_DATA_LISTENER_NUM; ++i) {
      const auto type = static_cast<RTC::ConnectorDataListenerType>(i);
      port.addConnectorDataListener(type, new Note(told, name + RTC::ConnectorDataListener::toString(type)));
    }
    for (int i = 0; i < RTC::CONNECTOR_LISTENER_NUM; ++i) {
      const auto type = static_cast<RTC::ConnectorListenerType>(i);
      port.addConnectorListener(type, new NoteEvent(told, name + RTC::ConnectorListener::toString(type)));
    }
  }
  std::vector<std::string> take() { return std::exchange(told, {}); }
  using Told = std::vector<std::string>;

  std::unique_ptr<corba::Orb> orb = ports::start_orb();
  std::vector<std::string> told;
  RTC::TimedLong sent{};
  RTC::TimedLong received{};
  RTC::OutPort<RTC::TimedLong> out{"A0.out", sent};
  RTC::InPort<RTC::TimedLong> in{"B0.in", received};
};

TEST_F(Listeners, a_pushed_sample_is_told_step_by_step) {
  listen(out, "out ");
  listen(in, "in ");
  auto plan = profile(
      {out.getPortRef(), in.getPortRef()},
      {{"inport.buffer.length", "1"}, {"inport.buffer.write.full_policy", "do_nothing"}, {"buffer.read.empty_policy", "do_nothing"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  EXPECT_EQ(take(), (Told{"in ON_CONNECT test", "out ON_CONNECT test"}));
  sent.data = 6;
  out.write();
  EXPECT_EQ(take(), (Told{"out ON_SEND 6", "in ON_RECEIVED 6", "in ON_BUFFER_WRITE 6", "out ON_RECEIVED 6"}));
  out.write();
  EXPECT_EQ(take(), (Told{"out ON_SEND 6", "in ON_RECEIVED 6", "in ON_BUFFER_FULL 6", "in ON_RECEIVER_FULL 6", "out ON_RECEIVER_FULL 6"}));
  in.read();
  EXPECT_EQ(take(), (Told{"in ON_BUFFER_READ 6"}));
  in.read();
  EXPECT_EQ(take(), (Told{"in ON_BUFFER_EMPTY test"}));
  out.disconnect_all();
  EXPECT_EQ(take(), (Told{"in ON_DISCONNECT test", "out ON_DISCONNECT test"}));
}

TEST_F(Listeners, a_pulled_sample_is_told_step_by_step) {
  listen(out, "out ");
  listen(in, "in ");
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"dataflow_type", "pull"}, {"buffer.read.empty_policy", "do_nothing"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  take();
  in.read();
  EXPECT_EQ(take(), (Told{"out ON_BUFFER_EMPTY test", "out ON_SENDER_EMPTY test", "in ON_SENDER_EMPTY test"}));
  sent.data = 2;
  out.write();
  EXPECT_EQ(take(), (Told{"out ON_BUFFER_WRITE 2"}));
  in.read();
  EXPECT_EQ(take(), (Told{"out ON_BUFFER_READ 2", "out ON_SEND 2", "in ON_RECEIVED 2", "in ON_BUFFER_WRITE 2", "in ON_BUFFER_READ 2"}));
}

TEST_F(Listeners, what_a_listener_changes_travels_on) {
  struct Raw1 : RTC::ConnectorDataListener {
    ReturnCode operator()(RTC::ConnectorInfo&, cdrMemoryStream& data) override {
      RTC::TimedLong value;
      value <<= data;
      value.data += 100;
      data.rewindPtrs();
      value >>= data;
      return DATA_CHANGED;
    }
  };
  struct Raw2 : RTC::ConnectorDataListener {
    ReturnCode operator()(RTC::ConnectorInfo&, RTC::ByteData& data, const std::string& marshaling) override {
      EXPECT_EQ(marshaling, "cdr");
      EXPECT_EQ(data.getDataLength(), 12u);
      data.getBuffer()[8] = static_cast<unsigned char>(data.getBuffer()[8] + 10);
      return ConnectorListenerStatus::DATA_CHANGED;
    }
  };
  struct Typed : ConnectorDataListenerT<RTC::TimedLong> {
    ReturnCode operator()(RTC::ConnectorInfo&, RTC::TimedLong& data) override { return ++data.data, DATA_CHANGED; }
  };
  for (const char* interface : {"corba_cdr", "direct", "shared_memory"}) {
    auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", interface}});
    ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
    auto* raw1 = new Raw1;
    auto* raw2 = new Raw2;
    auto* typed = new Typed;
    out.addConnectorDataListener(RTC::ON_SEND, raw1);
    in.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_RECEIVED, raw2);
    in.addConnectorDataListener(RTC::ON_BUFFER_READ, typed);
    sent.data = 5;
    out.write();
    in.read();
    EXPECT_EQ(received.data, 116) << interface;
    EXPECT_EQ(sent.data, 5);
    out.removeConnectorDataListener(RTC::ON_SEND, raw1);
    in.removeConnectorDataListener(RTC::ON_RECEIVED, raw2);
    in.removeConnectorDataListener(RTC::ON_BUFFER_READ, typed);
    out.disconnect_all();
  }
}

TEST_F(Listeners, one_that_throws_harms_nobody) {
  struct Bad : ConnectorDataListenerT<RTC::TimedLong> {
    ReturnCode operator()(RTC::ConnectorInfo&, RTC::TimedLong&) override { throw 42; }
  };
  out.addConnectorDataListener(RTC::ON_SEND, new Bad);
  auto plan = profile({out.getPortRef(), in.getPortRef()});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  EXPECT_TRUE(out.write());
  EXPECT_TRUE(in.isNew());
}

TEST_F(Listeners, the_information_has_the_properties_without_prefix) {
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"subscription_type", "flush"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  for (const auto& info : {out.getConnectorProfiles().at(0), in.getConnectorProfiles().at(0)}) {
    EXPECT_EQ(info.name, "test");
    EXPECT_EQ(info.ports.size(), 2u);
    EXPECT_EQ(info.properties.getProperty("dataflow_type"), "push");
    EXPECT_EQ(info.properties.getProperty("io_mode"), "block") << "the newer name of flush";
    EXPECT_EQ(info.properties.getProperty("serializer.cdr.endian"), "little,big");
    EXPECT_TRUE(info.properties.getProperty("corba_cdr.inport_ior").starts_with("IOR:"));
  }
  RTC::ConnectorInfo found;
  EXPECT_TRUE(in.getConnectorProfileByName("test", found));
  EXPECT_NE(in.getConnectorById(found.id.c_str()), nullptr);
  EXPECT_EQ(in.getConnectorByName("nobody"), nullptr);
}

TEST_F(Listeners, the_information_has_the_properties_of_the_port_below_those_of_the_connection) {
  auto bare = profile({out.getPortRef(), in.getPortRef()});
  ASSERT_EQ(out.connect(bare), RTC::RTC_OK);
  EXPECT_EQ(out.getConnectorProfiles().at(0).properties.getProperty("subscription_type"), "") << "not all that the port could do";
  out.disconnect_all();
  coil::Properties of_port;
  of_port["mine"] = "1";
  of_port["dataport.theirs"] = "2";
  of_port["subscription_type"] = "new";
  out.init(of_port);
  in.init(of_port);
  auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"subscription_type", "flush"}});
  ASSERT_EQ(out.connect(plan), RTC::RTC_OK);
  for (const auto& [info, type] :
       {std::pair(out.getConnectorProfiles().at(0), "DataOutPort"), std::pair(in.getConnectorProfiles().at(0), "DataInPort")}) {
    EXPECT_EQ(info.properties.getProperty("data_type"), "IDL:RTC/TimedLong:1.0");
    EXPECT_EQ(info.properties.getProperty("port.port_type"), type);
    EXPECT_EQ(info.properties.getProperty("mine"), "1");
    EXPECT_EQ(info.properties.getProperty("theirs"), "2");
    EXPECT_EQ(info.properties.getProperty("subscription_type"), "flush");
  }
}

}  // namespace
