// Code of authors is called without locks: it may ask the manager for anything, on its own thread or on one it waits for. Each test hung
// while a lock was held there; a watchdog ends the process then.
#include <gtest/gtest.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/LocalServiceAdmin.h>
#include <rtm/Manager.h>
#include <rtm/ManagerActionListener.h>
#include <rtm/NumberingPolicyBase.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <streambuf>
#include <thread>

namespace locks {
namespace {

using namespace std::chrono_literals;

constexpr unsigned watchdog_s = 60;

class Plain : public RTC::DataFlowComponentBase {
 public:
  explicit Plain(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}
};

// clang-format off
const char* const plain_spec[] = {
    "implementation_id", "Plain", "type_name", "Plain", "category", "test", "kind", "DataFlowComponent", "max_instance", "0", ""};
// clang-format on

void PlainInit(RTC::Manager* manager) {
  coil::Properties profile(plain_spec);
  manager->registerFactory(profile, RTC::Create<Plain>, RTC::Delete<Plain>);
}

RTC::Manager& started(std::vector<std::string> settings) {
  alarm(watchdog_s);
  settings.insert(settings.begin(), {"naming.enable:NO", "manager.shutdown_on_nortcs:NO", "logger.file_name:stderr"});
  std::vector<std::string> words{"test", "-i", "-f", "none.conf"};
  for (const auto& setting : settings) words.insert(words.end(), {"-o", setting});
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  auto* manager = RTC::Manager::init(static_cast<int>(argv.size()), argv.data());
  manager->setModuleInitProc(PlainInit);
  return *manager;
}

class Local final : public RTM::LocalServiceBase {
 public:
  static inline std::function<void()> on_init;
  bool init(const coil::Properties& properties) override {
    profile_.name = "local";
    profile_.service = this;
    profile_.properties = properties;
    on_init();
    return true;
  }
  bool reinit(const coil::Properties&) override { return true; }
  const RTM::LocalServiceProfile& getProfile() const override { return profile_; }
  void finalize() override {}

 private:
  RTM::LocalServiceProfile profile_;
};

void register_local_service(std::function<void()> on_init) {
  Local::on_init = std::move(on_init);
  RTM::LocalServiceFactory::instance().addFactory("local", coil::Creator<RTM::LocalServiceBase, Local>,
                                                  coil::Destructor<RTM::LocalServiceBase, Local>);
}

TEST(Locks, a_local_service_asks_the_manager_for_a_setting_while_it_is_initialised) {
  std::string answer;
  register_local_service([&] { answer = RTC::Manager::instance().configValue("manager.instance_name"); });
  auto& manager = started({});
  EXPECT_EQ(answer, "manager");
  manager.shutdown();
}

TEST(Locks, a_local_service_waits_for_a_thread_that_asks_the_manager) {
  std::string answer;
  register_local_service([&] { std::thread([&] { answer = RTC::Manager::instance().configValue("manager.instance_name"); }).join(); });
  auto& manager = started({});
  EXPECT_EQ(answer, "manager");
  manager.shutdown();
}

TEST(LocksDeathTest, a_signal_ends_a_process_whose_local_service_never_returns) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        register_local_service([] {
          kill(getpid(), SIGTERM);
          while (true) pause();
        });
        started({});
      },
      testing::KilledBySignal(SIGTERM), "");
}

// Makes a component more for the first that it numbers.
class Pairs final : public RTM::NumberingPolicyBase {
 public:
  std::string onCreate(void*) override {
    const int mine = next_++;
    if (mine == 0) RTC::Manager::instance().createComponent("Plain");
    return std::to_string(mine);
  }
  void onDelete(void*) override { ++deleted; }
  static inline int deleted = 0;

 private:
  int next_ = 0;
};

TEST(Locks, a_numbering_policy_has_another_component_made) {
  RTM::NumberingPolicyFactory::instance().addFactory("pairs", coil::Creator<RTM::NumberingPolicyBase, Pairs>,
                                                     coil::Destructor<RTM::NumberingPolicyBase, Pairs>);
  auto& manager = started({"manager.components.naming_policy:pairs"});
  ASSERT_TRUE(manager.activateManager());
  auto* first = manager.createComponent("Plain");
  ASSERT_NE(first, nullptr);
  EXPECT_STREQ(first->getInstanceName(), "Plain0");
  EXPECT_NE(manager.getComponent("Plain1"), nullptr);
  manager.shutdown();
  EXPECT_EQ(Pairs::deleted, 2);
}

// Waits for a thread that logs.
class Talkative final : public std::streambuf {
 public:
  int lines = 0;

 protected:
  std::streamsize xsputn(const char*, std::streamsize size) override {
    ++lines;
    if (lines == 1) std::thread([] { RTC::Logger("other").write(RTC::Logger::RTL_ERROR, "from the other thread"); }).join();
    return size;
  }
};

TEST(Locks, a_log_buffer_waits_for_a_thread_that_logs) {
  alarm(watchdog_s);
  Talkative buffer;
  RTC::addLogStreamBuffer(&buffer);
  RTC::Logger("test").write(RTC::Logger::RTL_ERROR, "first");
  RTC::removeLogStreamBuffer(&buffer);
  EXPECT_EQ(buffer.lines, 2) << "the line of the other thread comes after the one that is being written";
}

// Takes another listener away when it is deleted.
class Leaving final : public RTM::ManagerActionListener {
 public:
  Leaving(RTC::Manager& manager, RTM::ManagerActionListener* other) : manager_(manager), other_(other) {}
  ~Leaving() override { manager_.removeManagerActionListener(other_); }
  void preShutdown() override {}
  void postShutdown() override {}

 private:
  RTC::Manager& manager_;
  RTM::ManagerActionListener* other_;
};

TEST(Locks, a_listener_of_the_manager_takes_another_away_while_it_is_deleted) {
  auto& manager = started({});
  Leaving other(manager, nullptr);
  manager.addManagerActionListener(&other, false);
  auto* listener = new Leaving(manager, &other);
  manager.addManagerActionListener(listener, true);
  manager.removeManagerActionListener(listener);
  manager.shutdown();
}

}  // namespace
}  // namespace locks
