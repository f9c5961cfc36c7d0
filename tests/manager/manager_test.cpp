// The manager as a program uses it: init, factories, components, listeners, tasks, end. Each test has the process for itself in ctest.
#include <gtest/gtest.h>
#include <rtm/CORBA_RTCUtil.h>
#include <rtm/CorbaNaming.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/ECFactory.h>
#include <rtm/LogstreamBase.h>
#include <rtm/Manager.h>
#include <rtm/ManagerActionListener.h>
#include <rtm/NamingManager.h>
#include <rtm/NumberingPolicyBase.h>
#include <rtm/PeriodicExecutionContext.h>

#include <cerrno>
#include <future>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "base/clock.h"
#include "support/naming_service.h"

namespace {

using namespace std::chrono_literals;

int destroyed = 0;

class Plain : public RTC::DataFlowComponentBase {
 public:
  explicit Plain(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}
  ~Plain() override { ++destroyed; }
  RTC::ReturnCode_t onInitialize() override {
    bindParameter("gain", gain_, "1");
    return gain_ < 0 ? RTC::RTC_ERROR : RTC::RTC_OK;
  }
  double gain_ = 0;
};

const char* const plain_spec[] = {"implementation_id",
                                  "Plain",
                                  "type_name",
                                  "Plain",
                                  "description",
                                  "For tests",
                                  "version",
                                  "1.0",
                                  "vendor",
                                  "rtm-sim",
                                  "category",
                                  "test",
                                  "activity_type",
                                  "PERIODIC",
                                  "kind",
                                  "DataFlowComponent",
                                  "max_instance",
                                  "1",
                                  "language",
                                  "C++",
                                  "lang_type",
                                  "compile",
                                  "exec_cxt.periodic.rate",
                                  "100",
                                  "conf.default.gain",
                                  "2",
                                  ""};

void PlainInit(RTC::Manager* manager) {
  coil::Properties profile(plain_spec);
  manager->registerFactory(profile, RTC::Create<Plain>, RTC::Delete<Plain>);
}

RTC::Manager& started(std::vector<std::string> settings = {}) {
  destroyed = 0;
  settings.insert(settings.begin(), {"naming.enable:NO", "manager.shutdown_on_nortcs:NO"});
  std::vector<std::string> words{"test", "-i", "-f", "none.conf"};
  for (const auto& setting : settings) words.insert(words.end(), {"-o", setting});
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  auto* manager = RTC::Manager::init(static_cast<int>(argv.size()), argv.data());
  manager->setModuleInitProc(PlainInit);
  EXPECT_TRUE(manager->activateManager());
  return *manager;
}

TEST(Manager, makes_numbers_and_deletes_components) {
  auto& manager = started();
  auto* first = manager.createComponent("Plain");
  auto* second = manager.createComponent("Plain?conf.default.gain=3");
  ASSERT_NE(first, nullptr);
  ASSERT_NE(second, nullptr);
  EXPECT_STREQ(first->getInstanceName(), "Plain0");
  EXPECT_STREQ(second->getInstanceName(), "Plain1");
  EXPECT_EQ(dynamic_cast<Plain*>(second)->gain_, 3);
  EXPECT_EQ(manager.getComponent("Plain1"), second);
  EXPECT_EQ(manager.getComponents().size(), 2u);
  EXPECT_EQ(manager.deleteComponent("Plain0"), RTC::RTC_OK);
  manager.cleanupComponents();
  EXPECT_EQ(destroyed, 1);
  EXPECT_EQ(manager.getComponent("Plain0"), nullptr);
  auto* third = manager.createComponent("Plain");
  EXPECT_STREQ(third->getInstanceName(), "Plain0");
  manager.shutdown();
  EXPECT_EQ(destroyed, 3);
  EXPECT_FALSE(manager.isRunning());
  EXPECT_EQ(manager.createComponent("Plain"), nullptr);
}

TEST(Manager, a_stack_that_is_too_large_for_a_thread_is_not_taken) {
  auto& manager = started();
  for (const char* size : {"1048576M", "257M", "1"})
    EXPECT_NE(manager.createComponent("Plain?exec_cxt.periodic.stack_size=" + std::string(size)), nullptr) << size;
  EXPECT_NE(manager.createComponent("Plain?exec_cxt.stack_size=256M"), nullptr);
  manager.shutdown();
  EXPECT_EQ(destroyed, 4);
}

class Threadless : public RTC::PeriodicExecutionContext {
 public:
  RTC::ReturnCode_t onStarted() override { throw std::system_error(EAGAIN, std::generic_category(), "no thread could be made"); }
};

TEST(Manager, a_component_whose_context_gets_no_thread_is_not_made_and_leaves_nothing) {
  auto& manager = started();
  RTC::ExecutionContextFactory::instance().addFactory("Threadless", RTC::ECCreate<Threadless>, RTC::ECDelete<Threadless>);
  EXPECT_EQ(manager.createComponent("Plain?instance_name=mine&exec_cxt.periodic.type=Threadless"), nullptr);
  EXPECT_EQ(destroyed, 1);
  EXPECT_NE(manager.createComponent("Plain?instance_name=mine"), nullptr);
  manager.shutdown();
  EXPECT_EQ(destroyed, 2);
}

class Throwing final : public RTM::NumberingPolicyBase {
 public:
  std::string onCreate(void*) override {
    if (number_++ == 0) throw std::runtime_error("no number");
    return "x";
  }
  void onDelete(void*) override {}

 private:
  int number_ = 0;
};

TEST(Manager, a_component_on_whose_way_something_is_thrown_leaves_nothing) {
  RTM::NumberingPolicyFactory::instance().addFactory("throwing", coil::Creator<RTM::NumberingPolicyBase, Throwing>,
                                                     coil::Destructor<RTM::NumberingPolicyBase, Throwing>);
  auto& manager = started({"manager.components.naming_policy:throwing"});
  EXPECT_EQ(manager.createComponent("Plain"), nullptr);
  EXPECT_EQ(destroyed, 1);
  EXPECT_NE(manager.createComponent("Plain"), nullptr);
  manager.shutdown();
  EXPECT_EQ(destroyed, 2);
}

TEST(Manager, a_component_that_gets_no_name_is_deleted) {
  auto& manager = started();
  ASSERT_NE(manager.createComponent("PeriodicECSharedComposite?instance_name=mine"), nullptr);
  EXPECT_EQ(manager.createComponent("Plain?instance_name=mine"), nullptr);
  EXPECT_EQ(destroyed, 1);
  manager.shutdown();
}

// A start script that runs twice works.
TEST(Manager, a_component_that_is_there_already_is_given_when_it_is_asked_for_again) {
  auto& manager = started();
  auto* mine = manager.createComponent("Plain?instance_name=mine&conf.default.gain=3");
  ASSERT_NE(mine, nullptr);
  EXPECT_EQ(manager.createComponent("Plain?instance_name=mine&conf.default.gain=4"), mine);
  EXPECT_EQ(dynamic_cast<Plain*>(mine)->gain_, 3) << "it stays as it is";
  EXPECT_EQ(manager.createComponent("PeriodicECSharedComposite?instance_name=mine"), nullptr) << "another type";
  EXPECT_EQ(manager.getComponents().size(), 1u);
  manager.shutdown();
}

TEST(Manager, named_components_of_a_type_count_in_automatic_numbers) {
  auto& manager = started();
  const auto name = [&](const char* argument) { return std::string(manager.createComponent(argument)->getInstanceName()); };
  EXPECT_EQ(name("Plain"), "Plain0");
  EXPECT_EQ(name("Plain?instance_name=mine"), "mine");
  EXPECT_EQ(name("Plain?instance_name=full"), "full");
  EXPECT_EQ(name("Plain"), "Plain3");
  EXPECT_EQ(manager.deleteComponent("mine"), RTC::RTC_OK);
  manager.cleanupComponents();
  EXPECT_EQ(name("Plain"), "Plain1");
  manager.shutdown();
}

TEST(Manager, can_be_started_again_after_its_end) {
  for (int i = 0; i < 3; ++i) {
    auto& manager = started();
    EXPECT_NE(manager.createComponent("Plain"), nullptr) << i;
    manager.shutdown();
    EXPECT_EQ(destroyed, 1);
  }
}

TEST(Manager, a_failing_initialisation_leaves_nothing) {
  auto& manager = started();
  EXPECT_EQ(manager.createComponent("Plain?conf.default.gain=-1"), nullptr);
  manager.cleanupComponents();
  EXPECT_EQ(destroyed, 1);
  EXPECT_TRUE(manager.getComponents().empty());
  EXPECT_STREQ(manager.createComponent("Plain")->getInstanceName(), "Plain0");
  manager.shutdown();
}

TEST(Manager, instance_beats_type_beats_specification) {
  auto& manager = started({"test.Plain.conf.default.gain:5", "test.Special.conf.default.gain:6"});
  EXPECT_EQ(dynamic_cast<Plain*>(manager.createComponent("Plain"))->gain_, 5);
  EXPECT_EQ(dynamic_cast<Plain*>(manager.createComponent("Plain?instance_name=Special"))->gain_, 6);
  EXPECT_EQ(dynamic_cast<Plain*>(manager.createComponent("Plain?instance_name=Other&conf.default.gain=7"))->gain_, 7);
  manager.shutdown();
}

TEST(Manager, a_factory_is_registered_once) {
  auto& manager = started();
  coil::Properties profile(plain_spec);
  EXPECT_FALSE(manager.registerFactory(profile, RTC::Create<Plain>, RTC::Delete<Plain>));
  EXPECT_FALSE(manager.registerFactory(profile, nullptr, RTC::Delete<Plain>));
  manager.shutdown();
}

TEST(Manager, a_factory_that_throws_makes_no_component) {
  auto& manager = started();
  coil::Properties profile(plain_spec);
  profile["implementation_id"] = "Throws";
  const auto throws = [](RTC::Manager*) -> RTC::RTObject_impl* { throw std::runtime_error("expected by the test"); };
  EXPECT_TRUE(manager.registerFactory(profile, throws, RTC::Delete<Plain>));
  EXPECT_EQ(manager.createComponent("Throws"), nullptr);
  manager.shutdown();
}

class Witness final : public RTM::RtcLifecycleActionListener, public RTM::NamingActionListener, public RTM::ManagerActionListener {
 public:
  std::vector<std::string> seen;
  void preCreate(std::string& args) override {
    seen.push_back("preCreate " + args);
    args += "?instance_name=Renamed";
  }
  void postCreate(RTC::RTObject_impl*) override { seen.push_back("postCreate"); }
  void preConfigure(coil::Properties& properties) override { properties["added"] = "here"; }
  void postConfigure(coil::Properties&) override { seen.push_back("postConfigure"); }
  void preInitialize() override { throw std::runtime_error("expected by the test"); }
  void postInitialize() override { seen.push_back("postInitialize"); }
  void preBind(RTC::RTObject_impl*, coil::vstring&) override { seen.push_back("preBind"); }
  void postBind(RTC::RTObject_impl*, coil::vstring&) override { seen.push_back("postBind"); }
  void preUnbind(RTC::RTObject_impl*, coil::vstring&) override { seen.push_back("preUnbind"); }
  void postUnbind(RTC::RTObject_impl*, coil::vstring&) override { seen.push_back("postUnbind"); }
  void preShutdown() override { seen.push_back("preShutdown"); }
  void postShutdown() override { seen.push_back("postShutdown"); }
};

TEST(Manager, listeners_see_what_happens_and_may_change_it) {
  Witness witness;
  auto& manager = started();
  manager.addRtcLifecycleActionListener(&witness, false);
  manager.addNamingActionListener(&witness, false);
  manager.addManagerActionListener(&witness, false);
  auto* component = manager.createComponent("Plain");
  ASSERT_NE(component, nullptr);
  EXPECT_STREQ(component->getInstanceName(), "Renamed");
  EXPECT_EQ(std::as_const(component->getProperties())["added"], "here");
  manager.shutdown();
  EXPECT_EQ(witness.seen, (std::vector<std::string>{"preCreate Plain", "postConfigure", "postInitialize", "preBind", "postBind",
                                                    "postCreate", "preShutdown", "preUnbind", "postUnbind", "postShutdown"}));
}

TEST(Manager, runs_tasks_at_their_period) {
  auto& manager = started();
  std::promise<void> third;
  int runs = 0;
  const auto id = manager.addTask(
      [&] {
        if (++runs == 3) third.set_value();
      },
      1ms);
  EXPECT_EQ(third.get_future().wait_for(support::watchdog), std::future_status::ready);
  EXPECT_TRUE(manager.removeTask(id));
  EXPECT_FALSE(manager.removeTask(id));
  manager.shutdown();
}

TEST(Manager, ends_from_any_thread_while_main_waits) {
  auto& manager = started();
  ASSERT_NE(manager.createComponent("Plain"), nullptr);
  std::thread other([&] { manager.terminate(); });
  manager.runManager();
  other.join();
  EXPECT_EQ(destroyed, 1);
}

TEST(Manager, a_component_may_end_it_from_its_own_callback) {
  class Ender : public Plain {
   public:
    using Plain::Plain;
    RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
      RTC::Manager::instance().shutdown();
      return RTC::RTC_OK;
    }
  };
  auto& manager = started();
  coil::Properties profile(plain_spec);
  profile["implementation_id"] = "Ender";
  ASSERT_TRUE(manager.registerFactory(profile, RTC::Create<Ender>, RTC::Delete<Ender>));
  auto* component = manager.createComponent("Ender");
  ASSERT_NE(component, nullptr);
  RTC::RTObject_var reference = component->getObjRef();
  CORBA_RTCUtil::activate(reference);
  manager.runManager();
  EXPECT_EQ(destroyed, 1);
}

TEST(Manager, finds_components_by_name_and_address) {
  support::NamingService names;
  const int port = support::free_port();
  auto& manager = started({"naming.enable:YES", "corba.nameservers:" + names.address(), "naming.formats:a.cxt/%n.rtc",
                           "corba.endpoints::" + std::to_string(port)});
  ASSERT_NE(manager.createComponent("Plain"), nullptr);
  const auto at = "127.0.0.1:" + std::to_string(port);
  for (const auto& address : {std::string("Plain0"), "rtcname://" + names.address() + "/a.cxt/Plain0", std::string("rtcname://*/Plain0"),
                              "rtcname://" + names.address() + "/*/Plain0", "rtcloc://" + at + "/test/Plain0"}) {
    EXPECT_EQ(manager.getNaming()->string_to_component(address).length(), 1u) << address;
  }
  for (const auto* address : {"Plain1", "rtcname://127.0.0.1:1/x", "rtcname://*/Nobody", "rtcname://", "rtcloc://x"}) {
    EXPECT_EQ(manager.getNaming()->string_to_component(address).length(), 0u) << address;
  }
  manager.activateComponents("rtcname://*/Plain0");
  RTC::RTObject_var reference = manager.getComponent("Plain0")->getObjRef();
  EXPECT_TRUE(CORBA_RTCUtil::is_in_active(reference));
  manager.shutdown();
}

TEST(CorbaNaming, binds_lists_and_clears) {
  support::NamingService names;
  auto& manager = started();
  RTC::RTObject_var object = manager.createComponent("Plain")->getObjRef();
  RTC::CorbaNaming naming(manager.getORB(), names.address().c_str());
  EXPECT_TRUE(naming.isAlive());
  naming.bindByString("a.cxt/b.cxt/x.rtc", object);
  EXPECT_THROW(naming.bindByString("a.cxt/b.cxt/x.rtc", object), CosNaming::NamingContext::AlreadyBound);
  naming.rebindByString("a.cxt/b.cxt/x.rtc", object);
  naming.rebindByString("y.other", object);
  CORBA::Object_var found = naming.resolve("a.cxt/b.cxt/x.rtc");
  EXPECT_TRUE(found->_is_equivalent(object));
  found = naming.resolveStr("y.other");
  EXPECT_FALSE(CORBA::is_nil(found));
  CosNaming::BindingList_var list;
  naming.listByKind("a.cxt/b.cxt", "rtc", list);
  EXPECT_EQ(list->length(), 1u);
  naming.unbind("y.other");
  EXPECT_THROW(found = naming.resolve("y.other"), CosNaming::NamingContext::NotFound);
  EXPECT_THROW(found = naming.resolve(""), CosNaming::NamingContext::InvalidName);
  naming.clearAll();
  naming.list("", list);
  EXPECT_EQ(list->length(), 0u);
  manager.shutdown();
}

TEST(CorbaNaming, clears_contexts_in_a_circle) {
  support::NamingService names;
  auto& manager = started();
  RTC::CorbaNaming naming(manager.getORB(), names.address().c_str());
  CosNaming::NamingContext_ptr root = naming.getRootContext();
  CosNaming::NamingContext_var a = naming.bindNewContext("a.cxt");
  for (const char* name : {"up.cxt", "again.cxt"}) {
    naming.bindContext(name, root);
    naming.bindContext((std::string("a.cxt/") + name).c_str(), root);
    naming.bindContext((std::string("a.cxt/") + name + "a").c_str(), a);
  }
  naming.clearAll();
  CosNaming::BindingList_var list;
  naming.list("", list);
  EXPECT_EQ(list->length(), 0u);
  manager.shutdown();
}

// --- the log

std::string lines_of(const RTC::LogSettings& settings, const std::function<void(RTC::Logger&)>& speak) {
  std::stringbuf lines;
  RTC::setLogSettings(settings);
  RTC::addLogStreamBuffer(&lines);
  RTC::Logger logger("speaker");
  speak(logger);
  RTC::removeLogStreamBuffer(&lines);
  RTC::setLogSettings({});
  return lines.str();
}

TEST(Logger, formats_only_what_somebody_wants) {
  int formatted = 0;
  const auto text = lines_of({.level = RTC::Logger::RTL_WARN, .files = {}, .date_format = ""}, [&](RTC::Logger& rtclog) {
    const auto count = [&] { return ++formatted; };
    RTC_INFO(("unwanted %d", count()));
    RTC_WARN(("wanted %d", count()));
    RTC_ERROR_STR("streamed " << count());
    rtclog.level(RTC::Logger::RTL_DEBUG) << "unwanted";
  });
  EXPECT_EQ(text, "WARN: speaker: wanted 1\nERROR: speaker: streamed 2\n");
}

TEST(Logger, puts_simulated_time_beside_wall_time) {
  base::ManualClock clock;
  clock.set(12'345ms);
  const auto text = lines_of({.files = {}, .date_format = ""}, [&](RTC::Logger& rtclog) {
    base::ScopedClock scope(clock);
    RTC_INFO(("moved"));
  });
  EXPECT_EQ(text, "[12.345000] INFO: speaker: moved\n");
}

TEST(Logger, sinks_have_levels_of_their_own) {
  std::vector<std::string> got;
  const auto id = RTC::addLogSink(RTC::Logger::RTL_DEBUG, [&](const RTC::LogRecord& record) { got.emplace_back(record.message); });
  const auto text = lines_of({.level = RTC::Logger::RTL_ERROR, .files = {}}, [&](RTC::Logger& rtclog) {
    RTC_DEBUG(("for the sink"));
    RTC_TRACE(("for nobody"));
    RTC::removeLogSink(id);
    RTC_DEBUG(("too late"));
  });
  EXPECT_EQ(got, std::vector<std::string>{"for the sink"});
  EXPECT_EQ(text, "");
}

TEST(Logger, level_names_are_read_in_any_case) {
  EXPECT_EQ(RTC::Logger::strToLevel("paranoid"), RTC::Logger::RTL_PARANOID);
  EXPECT_EQ(RTC::Logger::strToLevel("WARN"), RTC::Logger::RTL_WARN);
  EXPECT_EQ(RTC::Logger::parseLevel("LOUD"), std::nullopt);
}

}  // namespace
