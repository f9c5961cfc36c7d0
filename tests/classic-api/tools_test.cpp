// What sources beside components use: connections by the URL of a port, log plug-ins that take records.
#include <gtest/gtest.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/CORBA_RTCUtil.h>
#include <rtm/CorbaNaming.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/LogstreamBase.h>
#include <rtm/Manager.h>
#include <rtm/ManagerServant.h>
#include <rtm/NamingManager.h>
#include <rtm/RingBuffer.h>
#include <rtm/config_rtc.h>

#include <thread>

#ifndef ORB_IS_OMNIORB
#error "headers that older tools have generated find no ORB"
#endif

namespace tools {
namespace {

class Ported : public RTC::DataFlowComponentBase {
 public:
  explicit Ported(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager), in("in", value), out("out", value) {}
  RTC::ReturnCode_t onInitialize() override {
    addInPort("in", in);
    addOutPort("out", out);
    return RTC::RTC_OK;
  }
  RTC::TimedLong value;
  RTC::InPort<RTC::TimedLong> in;
  RTC::OutPort<RTC::TimedLong> out;
};

RTC::Manager* started() {
  if (RTC::Manager* running = RTC::Manager::instance_if_any()) return running;
  static std::vector<std::string> words{"tools", "-i", "-f", "none.conf", "-o", "naming.enable:NO", "-o", "manager.shutdown_on_nortcs:NO"};
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  RTC::Manager* manager = RTC::Manager::init(static_cast<int>(argv.size()), argv.data());
  manager->activateManager();
  static const char* const spec[] = {"implementation_id", "Ported", "type_name", "Ported", "max_instance", "0", ""};
  coil::Properties profile(spec);
  manager->registerFactory(profile, RTC::Create<Ported>, RTC::Delete<Ported>);
  return manager;
}

TEST(Tools, ports_are_found_and_disconnected_by_url) {
  RTC::Manager* manager = started();
  ASSERT_NE(manager->createComponent("Ported"), nullptr);
  RTC::RTCList found = manager->getNaming()->string_to_component("Ported0");
  ASSERT_EQ(found.length(), 1u);
  RTC::RTObject_var component = RTC::RTObject::_duplicate(found[0]);

  RTC::PortService_var in = CORBA_RTCUtil::get_port_by_url("Ported0.in");
  RTC::PortService_var out = CORBA_RTCUtil::get_port_by_url("Ported0.out");
  RTC::PortService_var none = CORBA_RTCUtil::get_port_by_url("Ported0.none");
  ASSERT_FALSE(CORBA::is_nil(in));
  ASSERT_FALSE(CORBA::is_nil(out));
  EXPECT_TRUE(CORBA::is_nil(none));

  coil::Properties prop;
  prop["dataport.dataflow_type"] = "push";
  const auto wire = [&](const char* name) { return CORBA_RTCUtil::connect(name, prop, in.in(), out.in()); };
  ASSERT_EQ(wire("first"), RTC::RTC_OK);
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names(in.in()), coil::vstring{"first"});
  EXPECT_EQ(CORBA_RTCUtil::get_connector_ids(in.in()), CORBA_RTCUtil::get_connector_ids(component.in(), "Ported0.out"));
  EXPECT_EQ(CORBA_RTCUtil::disconnect_connector_name("Ported0.in", "second"), RTC::BAD_PARAMETER);
  EXPECT_EQ(CORBA_RTCUtil::disconnect_connector_name("Ported0.in", "first"), RTC::RTC_OK);
  EXPECT_TRUE(CORBA_RTCUtil::get_connector_names(out.in()).empty());

  ASSERT_EQ(wire("third"), RTC::RTC_OK);
  EXPECT_EQ(CORBA_RTCUtil::disconnect_connector_id("Ported0.out", CORBA_RTCUtil::get_connector_ids(in.in()).at(0)), RTC::RTC_OK);
  ASSERT_EQ(wire("fourth"), RTC::RTC_OK);
  EXPECT_EQ(CORBA_RTCUtil::disconnect_all("Ported0.out"), RTC::RTC_OK);
  ASSERT_EQ(wire("fifth"), RTC::RTC_OK);
  EXPECT_EQ(CORBA_RTCUtil::disconnect_all(in.in()), RTC::RTC_OK);
  EXPECT_TRUE(CORBA_RTCUtil::get_connector_names(in.in()).empty());
  EXPECT_EQ(CORBA_RTCUtil::disconnect_all("Nobody0.out"), RTC::BAD_PARAMETER);
}

TEST(Tools, what_a_naming_service_throws_can_be_caught_under_classic_names) {
  CosNaming::Name name;
  EXPECT_THROW(throw CosNaming::NamingContext::NotFound(CosNaming::NamingContext::not_object, name), RTC::CorbaNaming::NotFound);
  EXPECT_THROW(throw CORBA::TRANSIENT(), RTC::CorbaNaming::SystemException);
  EXPECT_TRUE((std::is_same_v<RTC::CorbaNaming::InvalidName, CosNaming::NamingContext::InvalidName>));
  EXPECT_TRUE((std::is_same_v<RTC::CorbaNaming::CannotProceed, CosNaming::NamingContext::CannotProceed>));
}

struct Record {
  int level;
  std::string name, date, message;
  bool operator==(const Record&) const = default;
  friend std::ostream& operator<<(std::ostream& out, const Record& record) {
    return out << record.level << ' ' << record.date << ' ' << record.name << ": " << record.message;
  }
};

class Records : public coil::LogStreamBuffer {
 public:
  void write(int level, const std::string& name, const std::string& date, const std::string& message) override {
    seen.push_back({level, name, date, message});
    RTC::Logger rtclog("records");
    RTC_ERROR(("seen %s", message.c_str()));  // does not come back
  }
  std::vector<Record> seen;
};

class Plugin : public RTC::LogstreamBase {
 public:
  bool init(const coil::Properties& prop) override { return prop.getProperty("header") == "x"; }
  coil::LogStreamBuffer* getStreamBuffer() override { return &records; }
  Records records;
};

TEST(Tools, a_log_plugin_gets_the_parts_of_each_record) {
  Plugin plugin;
  coil::Properties node;
  node["header"] = "x";
  ASSERT_TRUE(plugin.init(node));
  started();
  RTC::setLogSettings({.level = RTC::Logger::RTL_WARN, .files = {}, .date_format = "day"});
  RTC::LogStreamBuf& log = RTC::Manager::instance().getLogStreamBuf();
  log.addStream(plugin.getStreamBuffer());
  RTC::Logger rtclog("speaker");
  RTC_INFO(("unwanted"));
  RTC_WARN(("wanted %d", 1));
  EXPECT_TRUE(log.removeStream(plugin.getStreamBuffer()));
  RTC_WARN(("too late"));
  RTC::setLogSettings({});
  EXPECT_EQ(plugin.records.seen, (std::vector<Record>{{RTC::Logger::RTL_WARN, "speaker", "day", "wanted 1"}}));
}

TEST(Tools, what_a_factory_answers_can_be_compared_with_numbers) {
  auto& factory = RTC::LogstreamFactory::instance();
  const auto add = [&] { return factory.addFactory("tools", coil::Creator<RTC::LogstreamBase, Plugin>, coil::Destructor<RTC::LogstreamBase, Plugin>); };
  EXPECT_TRUE(add() == 0);
  EXPECT_TRUE(add() != 0);
  EXPECT_TRUE(0 == factory.removeFactory("tools"));
}

// A port of an author's own and a host of components reach what their base classes hold.
class OwnPort : public RTC::CorbaPort {
 public:
  using RTC::CorbaPort::CorbaPort;
  RTC::PortService_ptr own() { return m_objref.in(); }
};

class Host : public RTC::Manager {
 public:
  RTM::ManagerServant* servant() { return m_mgrservant; }
};

TEST(Tools, protected_members_of_ports_and_the_manager_are_there) {
  RTC::Manager* manager = started();
  auto* component = manager->createComponent("Ported");
  ASSERT_NE(component, nullptr);
  OwnPort port("own");
  EXPECT_TRUE(CORBA::is_nil(port.own()));
  ASSERT_TRUE(component->addPort(port));
  ASSERT_FALSE(CORBA::is_nil(port.own()));
  EXPECT_TRUE(port.own()->_is_equivalent(port.getPortRef()));
  component->removePort(port);
  auto* host = static_cast<Host*>(manager);
  ASSERT_NE(host->servant(), nullptr);
  EXPECT_EQ(host->servant(), &manager->getManagerServant());
  // As hosts do that are not sure.
  const RTM::Manager_var before = RTM::Manager::_duplicate(host->servant()->getObjRef());
  EXPECT_TRUE(host->servant()->createINSManager());
  EXPECT_TRUE(before->_is_equivalent(host->servant()->getObjRef()));
}

// Data ports of an author's own look after their connections by themselves.
class CountingOut : public RTC::OutPort<RTC::TimedLong> {
 public:
  using RTC::OutPort<RTC::TimedLong>::OutPort;
  using RTC::OutPort<RTC::TimedLong>::write;
  bool write(RTC::TimedLong& value) override {
    Guard guard(m_connectorsMutex);
    if (m_connectors.empty()) return false;
    names.clear();
    for (size_t i(0), len(m_connectors.size()); i < len; ++i) names.push_back(m_connectors[i]->name());
    for (ConnectorList::value_type connector : m_connectors) names.push_back(connector->profile().name);
    return OutPort::write(value);
  }
  std::vector<std::string> names;
};

class LookingIn : public RTC::InPort<RTC::TimedLong> {
 public:
  using RTC::InPort<RTC::TimedLong>::InPort;
  bool waits() { return m_connectors.size() == 1 && m_connectors.at(0)->getBuffer()->readable() == 1; }
  std::size_t before() const {
    const ConnectorList list = m_connectors;
    return list.size();
  }
};

TEST(Tools, data_ports_of_authors_find_their_connections) {
  RTC::Manager* manager = started();
  auto* component = manager->createComponent("Ported");
  ASSERT_NE(component, nullptr);
  RTC::TimedLong sent, received;
  CountingOut out("counted", sent);
  LookingIn in("looked", received);
  ASSERT_TRUE(component->addOutPort("counted", out));
  ASSERT_TRUE(component->addInPort("looked", in));
  EXPECT_EQ(in.before(), 0u);
  EXPECT_FALSE(out.write());
  RTC::PortService_ptr from = out.getPortRef();
  RTC::PortService_ptr to = in.getPortRef();
  coil::Properties settings;
  ASSERT_EQ(CORBA_RTCUtil::connect("wire", settings, from, to), RTC::RTC_OK);
  sent.data = 7;
  EXPECT_TRUE(out.write());
  EXPECT_EQ(out.names, (std::vector<std::string>{"wire", "wire"}));
  EXPECT_TRUE(in.waits());
  EXPECT_TRUE(in.read());
  EXPECT_EQ(received.data, 7);
  ASSERT_EQ(out.disconnect_all(), RTC::RTC_OK);
  EXPECT_FALSE(out.write());
  EXPECT_EQ(in.before(), 0u);
  component->removeOutPort(out);
  component->removeInPort(in);
}

TEST(Tools, interfaces_have_repository_ids_as_data_types_have) {
  EXPECT_STREQ(CORBA_Util::toRepositoryId<RTC::TimedLong>(), "IDL:RTC/TimedLong:1.0");
  EXPECT_STREQ(CORBA_Util::toRepositoryId<RTC::RTObject>(), "IDL:omg.org/RTC/RTObject:1.0");
  EXPECT_STREQ(CORBA_Util::toRepositoryIdOfObject<RTC::RTObject>(), "IDL:omg.org/RTC/RTObject:1.0");
}

TEST(Tools, a_ring_buffer_keeps_its_length_and_its_policies) {
  RTC::RingBuffer<int> buffer(2);
  int value = 0;
  EXPECT_EQ(buffer.read(value), RTC::BufferStatus::BUFFER_EMPTY);
  for (int i = 1; i <= 3; ++i) EXPECT_EQ(buffer.write(i), RTC::BufferStatus::BUFFER_OK);
  EXPECT_TRUE(buffer.full());
  EXPECT_EQ(buffer.get(value), RTC::BufferStatus::BUFFER_OK);
  EXPECT_EQ(value, 2);
  EXPECT_EQ(buffer.read(value), RTC::BufferStatus::BUFFER_OK);
  EXPECT_EQ(buffer.read(value), RTC::BufferStatus::BUFFER_OK);
  EXPECT_EQ(value, 3);
  EXPECT_TRUE(buffer.empty());
  value = 0;
  EXPECT_EQ(buffer.read(value), RTC::BufferStatus::BUFFER_OK);  // the last again
  EXPECT_EQ(value, 3);
  EXPECT_EQ(buffer.read(value, 0, 1000), RTC::BufferStatus::TIMEOUT);

  coil::Properties policies;
  policies["length"] = "1";
  policies["write.full_policy"] = "do_nothing";
  policies["read.empty_policy"] = "block";
  policies["read.timeout"] = "60";
  buffer.init(policies);
  EXPECT_EQ(buffer.length(), 1u);
  EXPECT_EQ(buffer.write(5), RTC::BufferStatus::BUFFER_OK);
  EXPECT_EQ(buffer.write(6), RTC::BufferStatus::BUFFER_FULL);
  EXPECT_EQ(buffer.read(value), RTC::BufferStatus::BUFFER_OK);
  std::thread writer([&] { buffer.write(7); });
  EXPECT_EQ(buffer.read(value), RTC::BufferStatus::BUFFER_OK);
  EXPECT_EQ(value, 7);
  writer.join();
  EXPECT_STREQ(RTC::BufferStatus::toString(RTC::BufferStatus::TIMEOUT), "TIMEOUT");
}

}  // namespace
}  // namespace tools
