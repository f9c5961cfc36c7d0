// What callers of a manager may change: manager.remote_rights.
#include "core/remote_rights.h"

#include <gtest/gtest.h>
#include <rtm/NVUtil.h>

#include <chrono>
#include <thread>
#include <utility>

#include "manager/rtcd_fixture.h"

namespace manager_test {
namespace {

TEST(RemoteRights, keys_that_name_programs_files_and_doors_are_protected) {
  for (const char* key :
       {"manager.modules.abs_path_allowed", "manager.modules.C++.profile_cmd", "manager.modules.load_path", "logger.file_name",
        "logger.date_format", "corba.args", "corba.open_to", "config_file", "test.X.config_file", "manager.remote_rights",
        "manager.local_service.modules", "manager.preload.modules", "exec_cxt.sim_time.hash_log"}) {
    EXPECT_TRUE(rt::is_protected_key(key)) << key;
  }
  for (const char* key : {"my.key", "test.X.conf.default.gain", "exec_cxt.periodic.rate", "naming.formats", "manager.components.precreate",
                          "manager.modulesque", "loggers", "corbaloc", "my_config_file"}) {
    EXPECT_FALSE(rt::is_protected_key(key)) << key;
  }
}

TEST(RemoteRights, a_caller_names_no_function_but_those_that_make_modules_known) {
  for (const auto& [module, function] : std::vector<std::pair<std::string, std::string>>{
           {"A.so", ""}, {"A.so", "AInit"}, {"A.so", " AInit "}, {"A.so(AInit)", ""}, {"A.so(OtherInit)", "abort"}})
    EXPECT_TRUE(rt::is_init_function(module, function, "", "Init")) << module << " " << function;
  for (const auto& [module, function] : std::vector<std::pair<std::string, std::string>>{
           {"A.so", "abort"}, {"A.so", "_exit"}, {"A.so", "_ZInit"}, {"A.so(system)", "AInit"}, {"A.so( exit )", ""}, {"A.so", "Initial"}})
    EXPECT_FALSE(rt::is_init_function(module, function, "", "Init")) << module << " " << function;
  EXPECT_TRUE(rt::is_init_function("A.so", "my_A_start", "my_", "_start"));
  EXPECT_FALSE(rt::is_init_function("A.so", "AInit", "my_", "_start"));
}

class RemoteRightsOf : public Rtcd {
 protected:
  void start(const std::vector<std::string>& further) {
    port_ = support::free_port();
    std::vector<std::string> words{"-p", std::to_string(port_)};
    words.insert(words.end(), further.begin(), further.end());
    rtcd_ = std::make_unique<support::Process>(command(words));
    manager_ = manager_at(port_);
    ASSERT_FALSE(CORBA::is_nil(manager_)) << rtcd_->output();
  }
  std::string value(const std::string& key) {
    RTM::NVList_var list = manager_->get_configuration();
    return NVUtil::toString(list.in(), key.c_str());
  }
  bool can_create(const std::string& argument) { return !CORBA::is_nil(RTC::RTObject_var(manager_->create_component(argument.c_str()))); }

  int port_ = 0;
  std::unique_ptr<support::Process> rtcd_;
  RTM::Manager_var manager_;
};

TEST_F(RemoteRightsOf, a_caller_sets_no_protected_key_and_the_log_says_who_tried) {
  start({});
  for (const char* key : {"manager.modules.abs_path_allowed", "manager.modules.C++.profile_cmd", "logger.file_name", "logger.date_format",
                          "corba.args", "config_file", "manager.remote_rights"}) {
    const auto before = value(key);
    EXPECT_EQ(manager_->set_configuration(key, "YES"), RTC::RTC_ERROR) << key;
    EXPECT_EQ(value(key), before) << key;
    EXPECT_TRUE(
        eventually([&] { return rtcd_->output().find("asked for the key \"" + std::string(key) + "\": rejected") != std::string::npos; }));
  }
  EXPECT_EQ(manager_->set_configuration("my.key", "x"), RTC::RTC_OK);
  EXPECT_FALSE(can_create("SinkAll?config_file=/etc/hostname"));
  EXPECT_TRUE(can_create("SinkAll"));
  EXPECT_NE(rtcd_->output().find("giop:"), std::string::npos) << "where the caller is";
}

TEST_F(RemoteRightsOf, a_caller_that_is_refused_again_and_again_does_not_fill_the_log) {
  start({});
  const auto begun = std::chrono::steady_clock::now();
  for (int i = 0; i < 3000; ++i) ASSERT_EQ(manager_->set_configuration("config_file", "YES"), RTC::RTC_ERROR);
  const std::string text = rtcd_->output();
  const auto seconds = std::chrono::ceil<std::chrono::seconds>(std::chrono::steady_clock::now() - begun).count();
  std::ptrdiff_t lines = 0;
  for (std::size_t at = text.find(": rejected"); at != std::string::npos; at = text.find(": rejected", at + 1)) ++lines;
  EXPECT_GT(lines, 0);
  EXPECT_LE(lines, 32 + seconds) << "a burst, then one a second";
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(manager_->set_configuration("config_file", "YES"));
    return rtcd_->output().find("more rejected calls are not in the log") != std::string::npos;
  }));
}

// A type that is not known is looked for as a module of that name, and another manager would see a caller of our account.
TEST_F(RemoteRightsOf, a_caller_of_an_open_process_loads_no_file_and_reaches_no_other_manager_by_the_way_of_a_component) {
  start({"-o", "corba.open_to:host"});
  for (const std::string argument :
       {"/tmp/nobody/x.so", "../../../tmp/nobody/x", "RTC:v:c:/tmp/nobody/x.so:C++:1.0", "/tmp/nobody/x.so?my.key=1"}) {
    EXPECT_FALSE(can_create(argument));
    EXPECT_TRUE(eventually([&] { return rtcd_->output().find("the component \"" + argument + "\": rejected") != std::string::npos; }))
        << argument;
  }
  EXPECT_FALSE(can_create("SinkAll?manager_address=127.0.0.1:" + std::to_string(port_)));
  EXPECT_TRUE(eventually([&] { return rtcd_->output().find("a component at another manager: rejected") != std::string::npos; }));
  EXPECT_TRUE(can_create("SinkAll"));
}

// The loader finds the functions of the C library through every module.
TEST_F(RemoteRightsOf, a_function_that_a_caller_names_does_not_end_the_process) {
  start({});
  for (const char* function : {"abort", "exit", "_exit", "raise", "pause"}) {
    EXPECT_EQ(manager_->load_module("SinkAll.so", function), RTC::BAD_PARAMETER) << function;
    EXPECT_EQ(manager_->load_module(("SinkAll.so(" + std::string(function) + ")").c_str(), ""), RTC::BAD_PARAMETER) << function;
  }
  EXPECT_EQ(manager_->load_module("SinkAll.so", "SinkAllInit"), RTC::RTC_OK) << rtcd_->output();
}

// Who makes components of a module, and who takes it out of memory, may be different callers at the same time.
TEST_F(RemoteRightsOf, a_module_stays_while_a_component_of_it_is_being_made) {
  start({"-o", "manager.shutdown_auto:NO"});
  ASSERT_EQ(manager_->load_module("Hangs.so", "HangsInMakingInit"), RTC::RTC_OK) << rtcd_->output();
  bool is_made = false;
  std::thread maker([&] { is_made = can_create("HangsInMaking"); });
  EXPECT_TRUE(eventually([&] { return rtcd_->output().find("being made") != std::string::npos; }));
  EXPECT_EQ(manager_->unload_module("Hangs"), RTC::PRECONDITION_NOT_MET);
  maker.join();
  EXPECT_TRUE(is_made) << rtcd_->output();
}

TEST_F(RemoteRightsOf, a_manager_may_be_for_looking_only) {
  start({"-o", "manager.remote_rights:read", "SinkAll"});
  EXPECT_TRUE(eventually([&] { return RTC::RTCList_var(manager_->get_components())->length() == 1; }));
  EXPECT_EQ(manager_->set_configuration("my.key", "x"), RTC::RTC_ERROR);
  EXPECT_EQ(manager_->load_module("SinkAll.so", ""), RTC::RTC_ERROR);
  EXPECT_EQ(manager_->delete_component("SinkAll0"), RTC::RTC_ERROR);
  EXPECT_EQ(manager_->shutdown(), RTC::RTC_ERROR);
  EXPECT_FALSE(can_create("SinkAll"));
  EXPECT_EQ(RTC::RTCList_var(manager_->get_components())->length(), 1u);
}

TEST_F(RemoteRightsOf, a_key_of_rtc_conf_allows_everything) {
  start({"-o", "manager.remote_rights:everything"});
  EXPECT_EQ(manager_->set_configuration("logger.log_level", "DEBUG"), RTC::RTC_OK);
  EXPECT_EQ(manager_->set_configuration("manager.modules.search_auto", "NO"), RTC::RTC_OK);
  EXPECT_EQ(value("manager.modules.search_auto"), "NO");
}

}  // namespace
}  // namespace manager_test
