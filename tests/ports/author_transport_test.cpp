// Transports of component authors: registered in the factories, chosen by the connection, used with every subscription, and harmless when
// they fail.
#include <gtest/gtest.h>
#include <rtm/InPortConsumer.h>
#include <rtm/InPortProvider.h>
#include <rtm/OutPortConsumer.h>
#include <rtm/OutPortProvider.h>

#include <atomic>
#include <map>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "ports/support.h"

namespace {

using ports::eventually;
using ports::profile;

std::atomic<int> alive{0};
std::atomic<int> subscriptions{0};
std::mutex town_mutex;

// Who answers in which house.
template <class Provider>
std::map<std::string, Provider*>& town() {
  static std::map<std::string, Provider*> all;
  return all;
}

// What all four ends have in common: an address, half of it from the connection, half from the one who is reached.
template <class Base>
class Pigeon : public Base {
 public:
  Pigeon() { ++alive; }
  ~Pigeon() override { --alive; }
  void init(coil::Properties& properties) override {
    street = properties.getProperty("pigeon.street");
    if (street == "closed") throw std::runtime_error("no pigeon flies there");
  }
  std::string street;
};

template <class Base, class Connector>
class Loft : public Pigeon<Base> {
 public:
  ~Loft() override {
    const std::lock_guard lock(town_mutex);
    std::erase_if(town<Loft>(), [this](const auto& entry) { return entry.second == this; });
  }
  bool publishInterface(SDOPackage::NVList& properties) override {
    CORBA_SeqUtil::push_back(this->m_properties, NVUtil::newNV("dataport.pigeon.house", "7"));
    return Base::publishInterface(properties);
  }
  void setListener(RTC::ConnectorInfo& info, RTC::ConnectorListenersBase* listeners) override {
    EXPECT_EQ(info.name, "test");
    // The port tells them by itself.
    RTC::ByteData data;
    listeners->notifyIn(RTC::ConnectorDataListenerType::ON_RECEIVED, info, data);
    listeners->notify(RTC::ConnectorListenerType::ON_SENDER_EMPTY, info);
  }
  void setConnector(Connector* its) override {
    connector = its;
    const std::lock_guard lock(town_mutex);
    town<Loft>()[this->street + " 7"] = this;
  }
  Connector* connector = nullptr;
};

using InTown = Loft<RTC::InPortProvider, RTC::InPortConnector>;
using OutTown = Loft<RTC::OutPortProvider, RTC::OutPortConnector>;

class InLoft : public InTown {
 public:
  void setBuffer(RTC::BufferBase<RTC::ByteData>* buffer) override { EXPECT_TRUE(buffer->empty()); }
};

class OutLoft : public OutTown {
 public:
  OutLoft() { setInterfaceType("pigeon"); }
  void setBuffer(RTC::CdrBufferBase* buffer) override { EXPECT_TRUE(buffer->empty()); }
};

RTC::DataPortStatus arrived(RTC::BufferStatus status) {
  switch (status) {
    case RTC::BufferStatus::OK:
      return RTC::DataPortStatus::PORT_OK;
    case RTC::BufferStatus::FULL:
      return RTC::DataPortStatus::SEND_FULL;
    case RTC::BufferStatus::EMPTY:
      return RTC::DataPortStatus::BUFFER_EMPTY;
    case RTC::BufferStatus::TIMEOUT:
      return RTC::DataPortStatus::SEND_TIMEOUT;
    default:
      return RTC::DataPortStatus::PORT_ERROR;
  }
}

// The one who flies.
template <class Base, class Reached>
class Flying : public Pigeon<Base> {
 public:
  bool subscribeInterface(const SDOPackage::NVList& properties) override {
    address = this->street + " " + NVUtil::toString(properties, "dataport.pigeon.house");
    if (this->street == "lost") return false;
    ++subscriptions;
    return true;
  }
  void unsubscribeInterface(const SDOPackage::NVList&) override { --subscriptions; }

 protected:
  RTC::DataPortStatus visit(auto&& what) {
    if (this->street == "stormy") throw std::runtime_error("blown away");
    const std::lock_guard lock(town_mutex);
    const auto there = town<Reached>().find(address);
    if (there == town<Reached>().end()) return RTC::DataPortStatus::CONNECTION_LOST;
    return what(*there->second->connector);
  }

 private:
  std::string address;
};

class Outbound : public Flying<RTC::InPortConsumer, InTown> {
 public:
  RTC::DataPortStatus put(RTC::ByteData& data) override {
    return visit([&](RTC::InPortConnector& there) { return arrived(there.write(data)); });
  }
};

class Homing : public Flying<RTC::OutPortConsumer, OutTown> {
 public:
  RTC::DataPortStatus get(RTC::ByteData& data) override {
    return visit([&](RTC::OutPortConnector& there) { return arrived(there.read(data)); });
  }
};

const char* const options[] = {"street.__value__", "main", ""};

template <class End, class Made>
void add() {
  coil::GlobalFactory<End>::instance().addFactory("pigeon", ::coil::Creator<End, Made>, ::coil::Destructor<End, Made>,
                                                  coil::Properties(options));
}

class AuthorTransport : public testing::Test {
 protected:
  AuthorTransport() {
    add<RTC::InPortProvider, InLoft>();
    add<RTC::InPortConsumer, Outbound>();
    add<RTC::OutPortProvider, OutLoft>();
    add<RTC::OutPortConsumer, Homing>();
  }
  ~AuthorTransport() override {
    RTC::InPortProviderFactory::instance().removeFactory("pigeon");
    RTC::InPortConsumerFactory::instance().removeFactory("pigeon");
    RTC::OutPortProviderFactory::instance().removeFactory("pigeon");
    RTC::OutPortConsumerFactory::instance().removeFactory("pigeon");
  }

  RTC::ReturnCode_t connect(const char* street, const char* dataflow = "push", const char* subscription = "flush",
                            const char* endian = "little", const char* interface = "pigeon") {
    auto plan = profile({out.getPortRef(), in.getPortRef()}, {{"interface_type", interface},
                                                              {"dataflow_type", dataflow},
                                                              {"subscription_type", subscription},
                                                              {"publisher.push_rate", "500"},
                                                              {"serializer.cdr.endian", endian},
                                                              {"pigeon.street", street}});
    return out.connect(plan);
  }
  void disconnect() {
    EXPECT_EQ(out.disconnect_all(), RTC::RTC_OK);
    EXPECT_TRUE(eventually([] { return alive == 0 && subscriptions == 0; })) << alive << subscriptions;
    EXPECT_TRUE(town<InTown>().empty());
  }

  std::unique_ptr<corba::Orb> orb = ports::start_orb();
  RTC::TimedLong sent{};
  RTC::TimedLong received{};
  RTC::OutPort<RTC::TimedLong> out{"A0.out", sent};
  RTC::InPort<RTC::TimedLong> in{"B0.in", received};
};

TEST_F(AuthorTransport, carries_what_is_pushed_and_what_is_pulled) {
  int number = 0;
  for (const char* endian : {"little", "big"}) {
    for (const char* subscription : {"flush", "new", "periodic", "pull"}) {
      const bool pulls = std::string(subscription) == "pull";
      ASSERT_EQ(connect("main", pulls ? "pull" : "push", pulls ? "flush" : subscription, endian), RTC::RTC_OK) << subscription;
      EXPECT_EQ(alive, 2);
      EXPECT_FALSE(in.isNew()) << subscription;
      for (int i = 0; i < 3; ++i) {
        sent.data = ++number;
        ASSERT_TRUE(out.write()) << subscription;
        ASSERT_TRUE(eventually([&] { return in.isNew(); })) << subscription;
        ASSERT_TRUE(in.read());
        EXPECT_EQ(received.data, number) << subscription << endian;
      }
      disconnect();
      EXPECT_FALSE(out.write());
    }
  }
}

TEST_F(AuthorTransport, tells_listeners_and_fills_the_buffer_of_the_port) {
  struct Seen : RTC::ConnectorDataListenerT<RTC::TimedLong> {
    std::atomic<int> values{0};
    ReturnCode operator()(RTC::ConnectorInfo&, RTC::TimedLong& value) override {
      values += value.data;
      return NO_CHANGE;
    }
  } sends, receives, writes;
  out.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_SEND, &sends, false);
  in.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_RECEIVED, &receives, false);
  in.addConnectorDataListener(RTC::ConnectorDataListenerType::ON_BUFFER_WRITE, &writes, false);
  ASSERT_EQ(connect("main"), RTC::RTC_OK);
  for (sent.data = 1; sent.data <= 4; ++sent.data) ASSERT_TRUE(out.write());
  EXPECT_EQ(in.connectors().at(0)->getBuffer()->readable(), 4u);
  EXPECT_TRUE(in.connectors().at(0)->isLittleEndian());
  EXPECT_EQ(sends.values, 10);
  EXPECT_EQ(receives.values, 10);
  EXPECT_EQ(writes.values, 10);
  for (int i = 1; i <= 4; ++i) {
    ASSERT_TRUE(in.read());
    EXPECT_EQ(received.data, i);
  }
  // What was not read yet outlives the two ends.
  sent.data = 5;
  ASSERT_TRUE(out.write());
  disconnect();
  ASSERT_TRUE(in.read());
  EXPECT_EQ(received.data, 5);
  out.removeConnectorDataListener(RTC::ConnectorDataListenerType::ON_SEND, &sends);
  in.removeConnectorDataListener(RTC::ConnectorDataListenerType::ON_RECEIVED, &receives);
  in.removeConnectorDataListener(RTC::ConnectorDataListenerType::ON_BUFFER_WRITE, &writes);
}

TEST_F(AuthorTransport, is_in_the_profile_of_ports_made_before_it_with_its_options) {
  for (RTC::PortService_ptr port : {out.getPortRef(), in.getPortRef()}) {
    RTC::PortProfile_var shown = port->get_port_profile();
    EXPECT_EQ(NVUtil::toString(shown->properties, "dataport.interface_type"), "corba_cdr,data_service,direct,shared_memory,pigeon");
    EXPECT_EQ(NVUtil::toString(shown->properties, "dataport.interface_option.pigeon.street.__value__"), "main");
  }
  RTC::InPortProviderFactory::instance().removeFactory("pigeon");
  RTC::OutPortConsumerFactory::instance().removeFactory("pigeon");
  RTC::PortProfile_var shown = in.getPortRef()->get_port_profile();
  EXPECT_EQ(NVUtil::toString(shown->properties, "dataport.interface_type"), "corba_cdr,data_service,direct,shared_memory");
  EXPECT_EQ(connect("main"), RTC::BAD_PARAMETER);
  EXPECT_EQ(connect("main", "push", "flush", "little", "raven"), RTC::BAD_PARAMETER);
  EXPECT_EQ(alive, 0);
}

TEST_F(AuthorTransport, says_what_it_is_in_a_profile) {
  OutLoft loft;
  SDOPackage::NVList profile;
  NVUtil::setStringValue(profile, "dataport.interface_type", "corba_cdr");
  loft.publishInterfaceProfile(profile);
  EXPECT_EQ(NVUtil::toString(profile, "dataport.interface_type"), "corba_cdr,pigeon");
  EXPECT_EQ(NVUtil::find_index(profile, "dataport.dataflow_type"), -1);
  // A connection for another interface is none for it.
  EXPECT_FALSE(loft.publishInterface(profile));
}

TEST_F(AuthorTransport, refuses_connections_that_one_of_its_ends_refuses) {
  for (const char* dataflow : {"push", "pull"}) {
    for (const char* street : {"closed", "lost"}) {
      EXPECT_EQ(connect(street, dataflow), RTC::RTC_ERROR) << street << dataflow;
      EXPECT_EQ(alive, 0);
      EXPECT_TRUE(out.connectors().empty());
      EXPECT_TRUE(in.connectors().empty());
    }
  }
  // An end of the other direction is of no use.
  RTC::InPortConsumerFactory::instance().removeFactory("pigeon");
  EXPECT_EQ(connect("main"), RTC::RTC_ERROR);
  EXPECT_EQ(connect("main", "pull"), RTC::RTC_OK);
  disconnect();
}

TEST_F(AuthorTransport, fails_the_write_or_the_read_when_it_throws_and_the_connection_when_the_peer_is_gone) {
  ASSERT_EQ(connect("stormy"), RTC::RTC_OK);
  EXPECT_FALSE(out.write());
  EXPECT_EQ(out.getStatus(0), RTC::DataPortStatus::PORT_ERROR);
  disconnect();
  ASSERT_EQ(connect("stormy", "pull"), RTC::RTC_OK);
  EXPECT_TRUE(out.write());
  EXPECT_FALSE(in.isNew());
  disconnect();
  ASSERT_EQ(connect("main"), RTC::RTC_OK);
  {
    const std::lock_guard lock(town_mutex);
    town<InTown>().clear();
  }
  EXPECT_FALSE(out.write());
  EXPECT_TRUE(eventually([&] { return out.connectors().empty(); }));
  in.disconnect_all();
  EXPECT_TRUE(eventually([] { return alive == 0; }));
}

}  // namespace
