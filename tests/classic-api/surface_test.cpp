// Every class, function and macro that component authors use, once in the spelling of 1.x and of 2.x where they differ. That it compiles is
// most of the test; what the reference says about behaviour is checked.
#include <gtest/gtest.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>
// The twins.
#include <coil/Affinity.h>
#include <coil/Allocator.h>
#include <coil/Async.h>
#include <coil/ClockManager.h>
#include <coil/Condition.h>
#include <coil/DynamicLib.h>
#include <coil/Factory.h>
#include <coil/File.h>
#include <coil/Guard.h>
#include <coil/Listener.h>
#include <coil/Mutex.h>
#include <coil/OS.h>
#include <coil/PeriodicTask.h>
#include <coil/Process.h>
#include <coil/Properties.h>
#include <coil/Signal.h>
#include <coil/Singleton.h>
#include <coil/Task.h>
#include <coil/Time.h>
#include <coil/TimeMeasure.h>
#include <coil/TimeValue.h>
#include <coil/Timer.h>
#include <coil/UUID.h>
#include <coil/atomic.h>
#include <coil/stringutil.h>
#include <rtm/CORBA_RTCUtil.h>
#include <rtm/CORBA_SeqUtil.h>
#include <rtm/ComponentActionListener.h>
#include <rtm/ConfigurationListener.h>
#include <rtm/ConnectorListener.h>
#include <rtm/CorbaConsumer.h>
#include <rtm/CorbaNaming.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/ECFactory.h>
#include <rtm/EventPort.h>
#include <rtm/ExecutionContextBase.h>
#include <rtm/Manager.h>
#include <rtm/ManagerActionListener.h>
#include <rtm/NVUtil.h>
#include <rtm/PeriodicExecutionContext.h>
#include <rtm/PortConnectListener.h>
#include <rtm/RTC.h>
#include <rtm/StaticFSM.h>
#include <rtm/SystemLogger.h>
#include <rtm/Typename.h>
#include <rtm/Util.h>
#include <rtm/idl/BasicDataTypeStub.h>
#include <rtm/idl/ExtendedDataTypesStub.h>
#include <rtm/idl/InterfaceDataTypesStub.h>
#include <rtm/version.h>

#include <atomic>
#include <set>
#include <sstream>

static_assert(RTM_MAJOR_VERSION >= 2);
static_assert(std::is_same_v<RTC::RtcBase, RTC::RTObject_impl>);

namespace {

RTC::Manager* started() {
  static std::vector<std::string> words{"surface", "-i", "-f", "none.conf", "-o", "naming.enable:NO", "-o", "manager.shutdown_on_nortcs:NO"};
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  RTC::Manager* manager = RTC::Manager::init(static_cast<int>(argv.size()), argv.data());
  manager->activateManager();
  return manager;
}

class Typed : public RTC::ConnectorDataListenerT<RTC::TimedLong> {
  USE_CONNLISTENER_STATUS;

 public:
  ReturnCode operator()(RTC::ConnectorInfo&, RTC::TimedLong&) override { return NO_CHANGE; }
};
class Raw2 : public RTC::ConnectorDataListener {
  USE_CONNLISTENER_STATUS;

 public:
  ReturnCode operator()(RTC::ConnectorInfo&, RTC::ByteData&, const std::string&) override { return INFO_CHANGED; }
};
class Raw12 : public RTC::ConnectorDataListener {
  USE_CONNLISTENER_STATUS;

 public:
  ReturnCode operator()(RTC::ConnectorInfo&, cdrMemoryStream&) override { return BOTH_CHANGED; }
};
class Link : public RTC::ConnectorListener {
  USE_CONNLISTENER_STATUS;

 public:
  ReturnCode operator()(RTC::ConnectorInfo&) override { return DATA_CHANGED; }
};

struct Read : RTC::OnRead<RTC::TimedLong> {
  void operator()() override {}
};
struct ReadConvert : RTC::OnReadConvert<RTC::TimedLong> {
  RTC::TimedLong operator()(const RTC::TimedLong& value) override { return value; }
};
struct Write : RTC::OnWrite<RTC::TimedLong> {
  void operator()(const RTC::TimedLong&) override {}
};
struct WriteConvert : RTC::OnWriteConvert<RTC::TimedLong> {
  RTC::TimedLong operator()(const RTC::TimedLong& value) override { return value; }
};
struct Connected : RTC::ConnectionCallback {
  void operator()(RTC::ConnectorProfile&) override {}
};

class Surface : public RTC::DataFlowComponentBase {
 public:
  explicit Surface(RTC::Manager* manager)
      : RTC::DataFlowComponentBase(manager), in("in", value), out("out", value), second("second", value), third("third", value), port("service") {}

  RTC::ReturnCode_t onInitialize() override {
    registerInPort("in", in);
    registerOutPort("out", out);
    addInPort("second", second);
    addOutPort("third", third);
    registerPort(port);
    listen();
    call_ports();
    removeInPort(second);
    removeOutPort(third);
    deletePort(port);
    addPort(port);
    removePort(port);
    addPort(port);
    deletePortByName("service");
    bindParameter("number", number, "3");
    bindParameter("other", number, "4", coil::stringTo<int>);
    updateParameters("default");
    return RTC::RTC_OK;
  }
  RTC::ReturnCode_t onFinalize() override { return RTC::RTC_OK; }
  RTC::ReturnCode_t onStartup(RTC::UniqueId) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t onShutdown(RTC::UniqueId) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override {
    rate = getExecutionRate(ec_id);
    own = isOwnExecutionContext(ec_id);
    RTC::ExecutionContext_var context = getExecutionContext(ec_id);
    return CORBA::is_nil(context) ? RTC::RTC_ERROR : RTC::RTC_OK;
  }
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t onExecute(RTC::UniqueId) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t onAborting(RTC::UniqueId) override { return RTC::BAD_PARAMETER; }
  RTC::ReturnCode_t onError(RTC::UniqueId) override { return RTC::UNSUPPORTED; }
  RTC::ReturnCode_t onReset(RTC::UniqueId) override { return RTC::OUT_OF_RESOURCES; }
  RTC::ReturnCode_t onStateUpdate(RTC::UniqueId) override { return RTC::RTC_OK; }
  RTC::ReturnCode_t onRateChanged(RTC::UniqueId) override { return RTC::RTC_OK; }

  void listen() {
    using namespace RTC;
    in.addConnectorDataListener(ConnectorDataListenerType::ON_RECEIVED, new Typed());
    in.addConnectorDataListener(ON_BUFFER_READ, new Raw2(), true);
    out.addConnectorDataListener(ON_SEND, new Raw12());
    for (auto type : {ON_BUFFER_WRITE, ON_BUFFER_FULL, ON_BUFFER_WRITE_TIMEOUT, ON_BUFFER_OVERWRITE, ON_RECEIVER_FULL, ON_RECEIVER_TIMEOUT,
                      ON_RECEIVER_ERROR}) {
      Typed listener;
      out.addConnectorDataListener(type, &listener, false);
      out.removeConnectorDataListener(type, &listener);
    }
    for (auto type : {ON_BUFFER_EMPTY, ON_BUFFER_READ_TIMEOUT, ON_SENDER_EMPTY, ON_SENDER_TIMEOUT, ON_SENDER_ERROR, ON_CONNECT, ON_DISCONNECT}) {
      Link listener;
      in.addConnectorListener(type, &listener, false);
      in.removeConnectorListener(type, &listener);
    }
    out.addConnectorListener(ConnectorListenerType::ON_CONNECT, new Link());
    auto* pre = addPreComponentActionListener(PreComponentActionListenerType::PRE_ON_ACTIVATED, *this, &Surface::before);
    addPostComponentActionListener(POST_ON_ACTIVATED, *this, &Surface::after);
    addPortActionListener(PortActionListenerType::ADD_PORT, *this, &Surface::port_action);
    addExecutionContextActionListener(ExecutionContextActionListenerType::EC_ATTACHED, *this, &Surface::before);
    addPortConnectListener(ON_NOTIFY_CONNECT, *this, &Surface::connect);
    addPortConnectRetListener(ON_CONNECTED, *this, &Surface::connected);
    addConfigurationParamListener(ON_UPDATE_CONFIG_PARAM, *this, &Surface::parameter);
    addConfigurationSetListener(ON_SET_CONFIG_SET, *this, &Surface::set);
    addConfigurationSetNameListener(ON_ACTIVATE_CONFIG_SET, *this, &Surface::set_name);
    addPreFsmActionListener(PRE_ON_INIT, *this, &Surface::state);
    addPostFsmActionListener(POST_ON_INIT, *this, &Surface::state_after);
    removePreComponentActionListener(PRE_ON_ACTIVATED, pre);
  }
  void before(RTC::UniqueId) {}
  void after(RTC::UniqueId, RTC::ReturnCode_t) { ++count; }
  void port_action(const RTC::PortProfile&) {}
  void connect(const char*, RTC::ConnectorProfile&) {}
  void connected(const char*, RTC::ConnectorProfile&, RTC::ReturnCode_t) {}
  void parameter(const char*, const char*) {}
  void set(const coil::Properties&) {}
  void set_name(const char*) {}
  void state(const char*) {}
  void state_after(const char*, RTC::ReturnCode_t) {}

  void call_ports() {
    in.setOnRead(&on_read);
    in.setOnReadConvert(&on_read_convert);
    out.setOnWrite(&on_write);
    out.setOnWriteConvert(&on_write_convert);
    for (RTC::PortBase* base : {static_cast<RTC::PortBase*>(&in), static_cast<RTC::PortBase*>(&out)}) {
      base->setOnPublishInterfaces(&callback);
      base->setOnSubscribeInterfaces(&callback);
      base->setOnConnected(&callback);
      base->setOnUnsubscribeInterfaces(&callback);
      base->setOnDisconnected(&callback);
      base->setOnConnectionLost(&callback);
      EXPECT_STREQ(base->getName(), base == &in ? "Surface0.in" : "Surface0.out");
      RTC::PortService_var reference = RTC::PortService::_duplicate(base->getPortRef());
      EXPECT_FALSE(CORBA::is_nil(reference));
      coil::Properties& properties = base->properties();
      properties["mine"] = "1";
    }
    EXPECT_FALSE(in.isNew());
    EXPECT_TRUE(in.isEmpty());
    coil::vstring names;
    EXPECT_FALSE(in.isNew(names));
    EXPECT_FALSE(in.isNew("nobody"));
    EXPECT_FALSE(in.waitNew(0.001));
    EXPECT_FALSE(in.waitNew(-1));
    EXPECT_FALSE(RTC::inSimulatedTime());
    EXPECT_FALSE(in.read());
    EXPECT_FALSE(in.read("nobody"));
    in.update();
    RTC::TimedLong other;
    in >> other;
    EXPECT_FALSE(out.write());
    EXPECT_FALSE(out.write(value));
    EXPECT_FALSE(out << value);
    EXPECT_TRUE(in.getStatusList().empty());
    EXPECT_TRUE(out.getStatusList().empty());
    EXPECT_TRUE(in.connectors().empty());
    EXPECT_TRUE(in.getConnectorProfiles().empty());
    EXPECT_TRUE(out.getConnectorIds().empty());
    EXPECT_TRUE(out.getConnectorNames().empty());
    EXPECT_EQ(in.getConnectorById("x"), nullptr);
    EXPECT_EQ(in.getConnectorByName("x"), nullptr);
    RTC::ConnectorInfo info;
    EXPECT_FALSE(out.getConnectorProfileById("x", info));
    EXPECT_FALSE(out.getConnectorProfileByName("x", info));
    setTimestamp(value);
    EXPECT_GT(value.tm.sec, 0u);
    setReadAll(true, true);
    setWriteAll(false);
    readAll();
    writeAll();
    EXPECT_EQ(getInPorts().size(), 2u);
    EXPECT_EQ(getOutPorts().size(), 2u);
  }

  using RTC::RTObject_impl::m_configsets;
  using RTC::RTObject_impl::m_properties;
  using RTC::RTObject_impl::rtclog;

  RTC::TimedLong value;
  RTC::InPort<RTC::TimedLong> in;
  RTC::OutPort<RTC::TimedLong> out;
  RTC::InPort<RTC::TimedLong> second;
  RTC::OutPort<RTC::TimedLong> third;
  RTC::CorbaPort port;
  Read on_read;
  ReadConvert on_read_convert;
  Write on_write;
  WriteConvert on_write_convert;
  Connected callback;
  int number = 0;
  std::atomic<int> count = 0;
  double rate = 0;
  bool own = false;
};

const char* surface_spec[] = {"implementation_id", "Surface", "type_name",     "Surface", "description", "All of it", "version",
                              "1.0",               "vendor",  "rtm-sim",       "category", "test",       "activity_type", "PERIODIC",
                              "language",          "C++",     "lang_type",     "compile", "exec_cxt.periodic.rate", "50", ""};

struct Old {
  DATAPORTSTATUS_ENUM
  ReturnCode code() const { return PORT_OK; }
};

class Context : public virtual RTC::PeriodicExecutionContext {};

TEST(Surface, components_have_what_authors_inherit) {
  RTC::Manager* manager = started();
  EXPECT_EQ(manager, &RTC::Manager::instance());
  coil::Properties profile(surface_spec);
  EXPECT_TRUE(manager->registerFactory(profile, RTC::Create<Surface>, RTC::Delete<Surface>));
  EXPECT_TRUE(manager->registerECFactory("SurfaceContext", RTC::ECCreate<Context>, RTC::ECDelete<Context>));
  using Maker = RTC::ExecutionContextFactory;
  EXPECT_EQ(Maker::instance().addFactory("SurfaceContext2", coil::Creator<RTC::ExecutionContextBase, Context>,
                                         coil::Destructor<RTC::ExecutionContextBase, Context>),
            coil::FactoryReturn::OK);
  RTC::RtcBase* base = manager->createComponent("Surface?exec_cxt.periodic.type=SurfaceContext");
  auto* component = dynamic_cast<Surface*>(base);
  ASSERT_NE(component, nullptr);
  EXPECT_STREQ(component->getInstanceName(), "Surface0");
  EXPECT_STREQ(component->getTypeName(), "Surface");
  EXPECT_STREQ(component->getDescription(), "All of it");
  EXPECT_STREQ(component->getVersion(), "1.0");
  EXPECT_STREQ(component->getVendor(), "rtm-sim");
  EXPECT_STREQ(component->getCategory(), "test");
  EXPECT_TRUE(component->getNamingNames().empty());
  EXPECT_EQ(component->number, 4);
  EXPECT_EQ(component->getProperties().getProperty("implementation_id"), "Surface");
  coil::Properties added;
  added["mine"] = "x";
  component->setProperties(added);
  EXPECT_EQ(component->m_properties.getProperty("mine"), "x");
  RTC::ConfigAdmin& configuration = component->getConfigService();
  EXPECT_STREQ(configuration.getActiveId(), "default");
  RTC::RTObject_var reference = component->getObjRef();
  EXPECT_FALSE(CORBA::is_nil(reference));
  EXPECT_EQ(component->setExecutionRate(0, 60), RTC::RTC_OK);
  EXPECT_EQ(component->activate(0), RTC::RTC_OK);
  EXPECT_EQ(component->rate, 60);
  EXPECT_TRUE(component->own);
  EXPECT_EQ(component->count, 1);
  EXPECT_EQ(component->reset(0), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(component->deactivate(0), RTC::RTC_OK);
  EXPECT_EQ(component->getExecutionRate(7), 0);
  EXPECT_TRUE(manager->bindExecutionContext(component));
  EXPECT_EQ(manager->getComponent("Surface0"), component);
  EXPECT_EQ(manager->getComponents().size(), 1u);
  EXPECT_FALSE(CORBA::is_nil(manager->getORB()) || CORBA::is_nil(manager->theORB()));
  EXPECT_FALSE(CORBA::is_nil(manager->getPOA()) || CORBA::is_nil(manager->thePOA()) || CORBA::is_nil(manager->theShortCutPOA()));
  EXPECT_EQ(manager->getConfig()["naming.enable"], "NO");
  EXPECT_EQ(manager->load("nowhere"), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->unload("nowhere"), RTC::BAD_PARAMETER);
  EXPECT_TRUE(manager->getLoadedModules().empty());
  manager->getLoadableModules();
  const auto task = manager->addTask([] {}, std::chrono::seconds(1));
  EXPECT_TRUE(manager->removeTask(task));
  manager->deleteComponent("Surface0");
  manager->terminate();
  manager->shutdown();
}

TEST(Surface, log_macros_take_double_parentheses_and_streams) {
  std::ostringstream lines;
  RTC::setLogSettings({.level = RTC::Logger::RTL_PARANOID, .files = {}, .date_format = ""});
  RTC::addLogStreamBuffer(lines.rdbuf());
  RTC::Logger rtclog("me");
  rtclog.setLevel("PARANOID");
  RTC_FATAL(("%d", 1));
  RTC_ERROR(("%d", 2));
  RTC_WARN(("%d", 3));
  RTC_INFO(("%d", 4));
  RTC_DEBUG(("%d", 5));
  RTC_TRACE(("%d", 6));
  RTC_VERBOSE(("%d", 7));
  RTC_PARANOID(("%d", 8));
  RTC_LOG(RTC::Logger::RTL_INFO, ("%s", "nine"));
  RTC_INFO_STR("ten " << 10);
  RTC_WARN_STR(std::string("eleven"));
  RTC::removeLogStreamBuffer(lines.rdbuf());
  RTC::setLogSettings({});
  EXPECT_EQ(lines.str(),
            "FATAL: me: 1\nERROR: me: 2\nWARN: me: 3\nINFO: me: 4\nDEBUG: me: 5\nTRACE: me: 6\nVERBOSE: me: 7\nPARANOID: me: 8\nINFO: me: nine\n"
            "INFO: me: ten 10\nWARN: me: eleven\n");
}

TEST(Surface, enumerations_have_both_spellings) {
  EXPECT_EQ(RTC::ConnectorDataListenerType::ON_BUFFER_WRITE, RTC::ON_BUFFER_WRITE);
  EXPECT_EQ(RTC::ConnectorListenerType::ON_CONNECT, RTC::ON_CONNECT);
  EXPECT_EQ(RTC::PreComponentActionListenerType::PRE_ON_EXECUTE, RTC::PRE_ON_EXECUTE);
  EXPECT_EQ(RTC::PostComponentActionListenerType::POST_ON_EXECUTE, RTC::POST_ON_EXECUTE);
  RTC::DataPortStatus status = RTC::DataPortStatus::PORT_OK;
  RTC::DataPortStatus::Enum old = RTC::DataPortStatus::BUFFER_FULL;
  EXPECT_TRUE(status == RTC::DataPortStatus::PORT_OK);
  EXPECT_TRUE(old != RTC::DataPortStatus::PORT_OK);
  EXPECT_STREQ(RTC::DataPortStatus::toString(RTC::DataPortStatus::BUFFER_FULL), "BUFFER_FULL");
  EXPECT_TRUE(Old().code() == RTC::DataPortStatus::PORT_OK);
}

TEST(Surface, properties_are_a_tree_of_values_and_defaults) {
  const char* defaults[] = {"a.b", "1", "a.c", "2", ""};
  coil::Properties properties(defaults);
  EXPECT_EQ(properties.getProperty("a.b"), "1");
  EXPECT_EQ(properties.getProperty("x", "none"), "none");
  EXPECT_EQ(properties["a.c"], "2");
  properties["d.e"] = "3";
  EXPECT_EQ(properties.setProperty("d.e", "4"), "3");
  EXPECT_NE(properties.findNode("d"), nullptr);
  EXPECT_EQ(properties.findNode("z"), nullptr);
  EXPECT_NE(properties.hasKey("a"), nullptr);
  EXPECT_TRUE(properties.createNode("f.g"));
  EXPECT_FALSE(properties.createNode("f.g"));
  EXPECT_EQ(properties.getNode("a").getLeaf().size(), 2u);
  coil::Properties* removed = properties.removeNode("f");
  EXPECT_NE(removed, nullptr);
  delete removed;
  std::istringstream text("h: 5\nlong = 1, \\\n  2\n# no\n");
  properties.load(text);
  EXPECT_EQ(properties.getProperty("long"), "1, 2");
  coil::Properties other;
  other["a.b"] = "6";
  properties << other;
  EXPECT_EQ(properties.getProperty("a.b"), "6");
  EXPECT_EQ(properties.getProperty("a.c"), "2");
  const auto names = properties.propertyNames();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()), (std::set<std::string>{"a.b", "a.c", "d.e", "h", "long"}));
}

TEST(Surface, string_functions_change_or_return) {
  EXPECT_EQ(coil::split("a, b,,c", ","), (coil::vstring{"a", "b", "", "c"}));
  EXPECT_EQ(coil::split("a, b,,c", ",", true), (coil::vstring{"a", "b", "c"}));
  EXPECT_EQ(coil::flatten({"a", "b"}), "a, b");
  EXPECT_EQ(coil::flatten({"a", "b"}, "-"), "a-b");
  std::string text("  Two Words ");
  EXPECT_EQ(coil::normalize(text), "two words");
  EXPECT_EQ(text, "  Two Words ");
  coil::normalize(text);
  EXPECT_EQ(text, "two words");
  coil::eraseBlank(text);
  EXPECT_EQ(text, "twowords");
  coil::replaceString(text, "two", "2");
  EXPECT_EQ(text, "2words");
  coil::toUpper(text);
  EXPECT_EQ(text, "2WORDS");
  coil::toLower(text);
  EXPECT_EQ(text, "2words");
  std::string blanks(" x ");
  coil::eraseHeadBlank(blanks);
  EXPECT_EQ(blanks, "x ");
  coil::eraseTailBlank(blanks);
  EXPECT_EQ(blanks, "x");
  coil::eraseBothEndsBlank(blanks);
  EXPECT_TRUE(coil::toBool("Yes", "YES", "NO"));
  EXPECT_FALSE(coil::toBool("nothing", "YES", "NO", false));
  int number = 7;
  EXPECT_TRUE(coil::stringTo(number, "42"));
  EXPECT_FALSE(coil::stringTo(number, "word"));
  EXPECT_EQ(number, 42);
  bool flag = false;
  EXPECT_TRUE(coil::stringTo(flag, "true"));
  EXPECT_TRUE(flag);
  std::chrono::milliseconds time{};
  EXPECT_TRUE(coil::stringTo(time, "0.5"));
  EXPECT_EQ(time.count(), 500);
  EXPECT_EQ(coil::otos(1.5), "1.5");
  EXPECT_EQ(coil::escape("a\tb"), "a\\tb");
  EXPECT_EQ(coil::unescape("a\\tb"), "a\tb");
  EXPECT_TRUE(coil::isURL("http://x") && coil::isAbsolutePath("/x") && coil::isIPv4("127.0.0.1") && coil::isIPv6("::1"));
  EXPECT_EQ(coil::urlparam2map("x?a=1&b=2"), (coil::mapstring{{"a", "1"}, {"b", "2"}}));
  EXPECT_EQ(coil::sprintf("%d-%s", 1, "x"), "1-x");
  setenv("RTMSIM_SURFACE", "here", 1);
  EXPECT_EQ(coil::replaceEnv(std::string("${RTMSIM_SURFACE}/x")), "here/x");
}

TEST(Surface, old_threads_and_times_work) {
  coil::Mutex mutex;
  {
    coil::Guard<coil::Mutex> guard(mutex);
  }
  coil::Condition<coil::Mutex> condition(mutex);
  condition.broadcast();
  coil::TimeValue time(1, 500000);
  EXPECT_EQ(static_cast<double>(time), 1.5);
  coil::TimeValue now(coil::gettimeofday());
  EXPECT_GT(now.sec(), 0);
  coil::usleep(1);
  coil::sleep(coil::TimeValue(0, 1));
  coil::TimeMeasure measure;
  measure.tick();
  measure.tack();
  EXPECT_EQ(measure.count(), 1u);
  EXPECT_EQ(RTC::toVector(RTC::toStringList({"a", "b"})), (coil::vstring{"a", "b"}));
  int argc = 0;
  const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);  // omniORB has no values of type any before
  SDOPackage::NVList list;
  CORBA_SeqUtil::push_back(list, NVUtil::newNV("key", "value"));
  EXPECT_EQ(NVUtil::toString(list, "key"), "value");
  EXPECT_TRUE(NVUtil::isStringValue(list, "key", "value"));
}

}  // namespace
