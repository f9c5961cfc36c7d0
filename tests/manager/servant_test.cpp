// RTM::Manager over the wire, operation by operation: what tools ask of a manager, a master and a slave.
#include <gtest/gtest.h>
#include <rtm/CORBA_RTCUtil.h>
#include <rtm/NVUtil.h>
#include <rtm/idl/ManagerSkel.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <future>

#include "manager/hanging_slave.h"
#include "manager/rtcd_fixture.h"

namespace manager_test {
namespace {

using namespace std::chrono_literals;
using Strings = std::set<std::string>;

Strings values_of(const RTM::ModuleProfileList& modules, const char* key) {
  Strings values;
  for (CORBA::ULong i = 0; i < modules.length(); ++i) values.insert(NVUtil::toString(modules[i].properties, key));
  return values;
}

Strings instance_names(RTM::Manager_ptr manager) {
  RTC::ComponentProfileList_var profiles = manager->get_component_profiles();
  Strings names;
  for (CORBA::ULong i = 0; i < profiles->length(); ++i) names.insert(profiles[i].instance_name.in());
  return names;
}

std::string property_of(RTC::RTObject_ptr component, const std::string& key) {
  const auto properties = CORBA_RTCUtil::get_component_profile(component);
  return std::as_const(properties).getProperty(key);
}

class Servant : public Rtcd {
 protected:
  std::vector<std::string> at_port(int port, const std::vector<std::string>& further) const {
    std::vector<std::string> words{"-p", std::to_string(port)};
    words.insert(words.end(), further.begin(), further.end());
    return command(words);
  }
  std::vector<std::string> slave_of(int master, int port, const std::string& name, const std::vector<std::string>& further) const {
    auto words = at_port(port, {"-o", "corba.master_manager:127.0.0.1:" + std::to_string(master), "-o",
                                "corba.update_master_manager.interval:0.1", "-o", "manager.instance_name:" + name});
    words.insert(words.end(), further.begin(), further.end());
    return words;
  }
  RTC::RTObject_var make(RTM::Manager_ptr manager, const std::string& argument) const {
    return manager->create_component(argument.c_str());
  }
};

TEST_F(Servant, every_value_of_profile_and_configuration_is_a_string) {
  const int port = support::free_port();
  support::Process rtcd(at_port(port, {"-o", "manager.instance_name:me", "-o", "test.Any.conf.default.x:1"}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();
  RTM::ManagerProfile_var profile = manager->get_profile();
  EXPECT_EQ(NVUtil::toString(profile->properties, "instance_name"), "me");
  EXPECT_EQ(NVUtil::toString(profile->properties, "is_master"), "NO");
  EXPECT_LT(NVUtil::find_index(profile->properties, "corba.id"), 0);  // the subtree alone
  RTM::NVList_var configuration = manager->get_configuration();
  EXPECT_EQ(NVUtil::toString(configuration, "manager.instance_name"), "me");
  EXPECT_EQ(NVUtil::toString(configuration, "test.Any.conf.default.x"), "1");
  EXPECT_EQ(NVUtil::toString(configuration, "corba.endpoints"), ":" + std::to_string(port));
  for (CORBA::ULong i = 0; i < configuration->length(); ++i) {
    CORBA::TypeCode_var type = configuration[i].value.type();
    EXPECT_EQ(type->kind(), CORBA::tk_string) << configuration[i].name;
  }
  EXPECT_EQ(manager->set_configuration("test.Any.conf.default.x", "2"), RTC::RTC_OK);
  configuration = manager->get_configuration();
  EXPECT_EQ(NVUtil::toString(configuration, "test.Any.conf.default.x"), "2");
  EXPECT_FALSE(manager->is_master());
  EXPECT_EQ(manager->fork(), RTC::RTC_OK);
  EXPECT_EQ(manager->restart(), RTC::RTC_OK);
  CORBA::Object_var service = manager->get_service("any");
  EXPECT_TRUE(CORBA::is_nil(service));
  EXPECT_TRUE(rtcd.running());
}

TEST_F(Servant, callers_set_a_limited_number_of_keys_of_a_limited_length) {
  const int port = support::free_port();
  support::Process rtcd(at_port(port, {}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();
  const std::string long_value(60'000, 'x');
  int taken = 0;
  while (taken < 1000 && manager->set_configuration(("test.a." + std::to_string(taken)).c_str(), long_value.c_str()) == RTC::RTC_OK)
    ++taken;
  EXPECT_EQ(taken, 139) << "8 MiB";
  for (int i = 0; i < taken; ++i) ASSERT_EQ(manager->set_configuration(("test.a." + std::to_string(i)).c_str(), ""), RTC::RTC_OK);
  while (taken < 5000 && manager->set_configuration(("test.a." + std::to_string(taken)).c_str(), "x") == RTC::RTC_OK) ++taken;
  EXPECT_EQ(taken, 4096);
  EXPECT_EQ(manager->set_configuration("test.a.9", "y"), RTC::RTC_OK);
  EXPECT_TRUE(rtcd.wait_for_output("key \"test.a.4096\" is rejected")) << rtcd.output();
}

TEST_F(Servant, a_limit_of_seconds_that_no_clock_can_hold_is_refused) {
  const int port = support::free_port();
  support::Process rtcd(at_port(port, {}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();
  for (const char* limit : {"1e300", "1e7", "0", "soon"}) {
    EXPECT_TRUE(CORBA::is_nil(make(manager, "SimTimeProxy?sim_time_proxy.alone_limit=" + std::string(limit)))) << limit;
    EXPECT_TRUE(rtcd.wait_for_output("at most 1e6, got \"" + std::string(limit) + "\"")) << rtcd.output();
  }
  EXPECT_FALSE(CORBA::is_nil(make(manager, "SimTimeProxy?sim_time_proxy.alone_limit=1e6"))) << rtcd.output();
}

TEST_F(Servant, modules_are_shown_with_what_tools_look_for) {
  const int port = support::free_port();
  support::Process rtcd(at_port(port, {}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();
  RTM::ModuleProfileList_var list = manager->get_loaded_modules();
  EXPECT_EQ(list->length(), 0u);
  ASSERT_EQ(manager->load_module("FailOnRequest.so", ""), RTC::RTC_OK);
  list = manager->get_loaded_modules();
  ASSERT_EQ(list->length(), 1u);
  const auto file = NVUtil::toString(list[0].properties, "file_path");
  EXPECT_TRUE(file.starts_with("/") && file.ends_with("/FailOnRequest.so")) << file;
  EXPECT_EQ(NVUtil::toString(list[0].properties, "init_func"), "FailOnRequestInit");
  EXPECT_EQ(NVUtil::toString(list[0].properties, "language"), "C++");
  list = manager->get_loadable_modules();
  EXPECT_TRUE(values_of(list, "module_file_name").contains("FailOnRequest.so"));
  EXPECT_TRUE(values_of(list, "module_file_path").contains(file));
  for (CORBA::ULong i = 0; i < list->length(); ++i) {
    for (const auto* key : {"implementation_id", "type_name", "category", "vendor", "version", "language", "description"}) {
      EXPECT_NE(NVUtil::toString(list[i].properties, key), "") << NVUtil::toString(list[i].properties, "module_file_name") << ' ' << key;
    }
  }
  list = manager->get_factory_profiles();
  EXPECT_EQ(values_of(list, "implementation_id"), (Strings{"FailOnRequest", "PeriodicECSharedComposite"}));
  EXPECT_EQ(manager->unload_module(file.c_str()), RTC::RTC_OK);
  list = manager->get_factory_profiles();
  EXPECT_EQ(values_of(list, "implementation_id"), Strings{"PeriodicECSharedComposite"});
}

TEST_F(Servant, a_module_that_is_cut_short_or_fails_is_refused) {
  const int port = support::free_port();
  support::Process rtcd(at_port(port, {}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();
  const auto file = std::filesystem::temp_directory_path() / ("Cut" + std::to_string(getpid()) + ".so");
  std::filesystem::copy_file(modules + "/FailOnRequest.so", file);
  // Each within what the loader maps: behind that stand names for debuggers, without which a module runs.
  for (const std::uintmax_t size : {12000, 3000, 100, 0}) {
    ASSERT_LT(size, std::filesystem::file_size(file));
    std::filesystem::resize_file(file, size);
    EXPECT_EQ(manager->load_module(file.c_str(), "FailOnRequestInit"), RTC::RTC_ERROR) << size;
  }
  std::filesystem::remove(file);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(manager->load_module("Hangs.so", "HangsFailInit"), RTC::RTC_ERROR) << "each time";
  RTM::ModuleProfileList_var list = manager->get_factory_profiles();
  EXPECT_EQ(values_of(list, "implementation_id"), Strings{"PeriodicECSharedComposite"}) << "what it registered has gone";
  EXPECT_EQ(manager->load_module("Hangs.so", ""), RTC::RTC_OK);
}

TEST_F(Servant, the_log_follows_the_configuration_at_once) {
  const int port = support::free_port();
  support::Process rtcd(at_port(port, {"-o", "manager.remote_rights:everything"}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();
  EXPECT_EQ(manager->set_configuration("logger.log_level", "LOUD"), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->set_configuration("logger.log_level", "DEBUG"), RTC::RTC_OK);
  EXPECT_EQ(manager->load_module("FailOnRequest.so", ""), RTC::RTC_OK);
  EXPECT_TRUE(rtcd.wait_for_output("DEBUG: manager: module FailOnRequest.so loaded")) << rtcd.output();
}

TEST_F(Servant, create_component_understands_every_form_of_its_argument) {
  support::TemporaryFolder folder;
  const auto file = (folder.path() / "own.conf").string();
  std::ofstream(file) << "conf.default.how: throw\nconf.special.how: throw_number\nexec_cxt.periodic.rate: 25\n";
  const int port = support::free_port();
  // A file is named over the wire below, which has to be allowed.
  support::Process rtcd(at_port(port, {"-o", "manager.shutdown_on_nortcs:NO", "-o", "manager.remote_rights:everything"}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();

  for (const auto& [argument, name] : std::vector<std::pair<std::string, std::string>>{
           {"FailOnRequest", "FailOnRequest0"},
           {"FailOnRequest?", "FailOnRequest1"},
           {"FailOnRequest?&instance_name=A", "A"},
           {"RTC:::FailOnRequest:", ""},                                       // five fields
           {"RTC::::FailOnRequest::", ""},                                     // too many
           {"RTC:rtm-sim:example:FailOnRequest:C++:1.0.0", "FailOnRequest3"},  // A counts too
           {"RTC:::FailOnRequest::?instance_name=B", "B"},
           {"RTC:rtm-sim::FailOnRequest::?instance_name=C&conf.default.how=throw", "C"},
           {"RTC:someone:example:FailOnRequest:C++:1.0.0", ""},
           {"RTC:rtm-sim:example:FailOnRequest:Python:1.0.0", ""},
           {"RTC:rtm-sim:example:FailOnRequest:C++:9.9", ""},
           {"FailOnRequest?manager_name=me&instance_name=D", "D"},
           {"FailOnRequest?manager_name=nobody&instance_name=E", "E"},
           {"FailOnRequest?instance_name=A", "A"},  // the one that is there
       }) {
    RTC::RTObject_var made = make(manager, argument);
    if (CORBA::is_nil(made)) {
      EXPECT_EQ(name, "") << argument;
      continue;
    }
    CORBA::String_var id = made->get_sdo_id();
    EXPECT_EQ(id.in(), name) << argument;
  }

  RTC::RTObject_var by_file = make(manager, "FailOnRequest?instance_name=F&config_file=" + file + "&conf.special.how=return&my.own=x");
  ASSERT_FALSE(CORBA::is_nil(by_file)) << rtcd.output();
  EXPECT_EQ(property_of(by_file, "conf.default.how"), "throw");
  EXPECT_EQ(property_of(by_file, "conf.special.how"), "return");  // the argument beats the file
  EXPECT_EQ(property_of(by_file, "my.own"), "x");
  EXPECT_EQ(property_of(by_file, "exec_cxt.periodic.rate"), "25");
  EXPECT_EQ(property_of(by_file, "manager_name"), "");
  EXPECT_EQ(CORBA_RTCUtil::get_current_rate(by_file, 0), 25);

  RTC::RTObject_var source = make(manager, "SourceAll?instance_name=S");
  ASSERT_FALSE(CORBA::is_nil(source));
  RTC::RTObject_var composite =
      make(manager, "PeriodicECSharedComposite?instance_name=Both&conf.default.members=S,F&exported_ports=S.long");
  ASSERT_FALSE(CORBA::is_nil(composite));
  RTC::PortService_var port_of_composite = CORBA_RTCUtil::get_port_by_name(composite, "S.long");
  EXPECT_FALSE(CORBA::is_nil(port_of_composite)) << rtcd.output();
}

TEST_F(Servant, a_master_shows_and_uses_what_its_slaves_have) {
  const int master_port = support::free_port();
  support::TemporaryFolder nothing;
  auto words = at_port(master_port, {"-d", "-o", "manager.modules.load_path:" + nothing.path().string()});
  support::Process master_process(words);
  RTM::Manager_var master = manager_at(master_port);
  ASSERT_FALSE(CORBA::is_nil(master)) << master_process.output();
  const int slave_port = support::free_port();
  support::Process slave_process(slave_of(master_port, slave_port, "helper", {"FailOnRequest"}));
  RTM::Manager_var slave = manager_at(slave_port);
  const auto slaves = [&] {
    RTM::ManagerList_var list = master->get_slave_managers();
    return list->length();
  };
  ASSERT_TRUE(eventually([&] { return slaves() == 1 && instance_names(master) == Strings{"FailOnRequest0"}; })) << slave_process.output();
  RTM::ManagerList_var masters = slave->get_master_managers();
  ASSERT_EQ(masters->length(), 1u);
  EXPECT_TRUE(RTM::Manager_var(masters[0])->is_master());

  RTM::ModuleProfileList_var list = master->get_loaded_modules();
  EXPECT_EQ(list->length(), 1u);
  list = master->get_loadable_modules();
  EXPECT_TRUE(values_of(list, "implementation_id").contains("SinkAll"));
  list = master->get_factory_profiles();
  EXPECT_TRUE(values_of(list, "implementation_id").contains("FailOnRequest"));

  RTC::RTObject_var made = make(master, "SinkAll");  // the master has no module of it
  EXPECT_FALSE(CORBA::is_nil(made));
  made = make(master, "PeriodicECSharedComposite?instance_name=There&manager_name=helper");
  EXPECT_FALSE(CORBA::is_nil(made));
  made = make(master, "PeriodicECSharedComposite?instance_name=Also&manager_address=127.0.0.1:" + std::to_string(slave_port));
  EXPECT_FALSE(CORBA::is_nil(made));
  made = make(master, "PeriodicECSharedComposite?instance_name=Here");
  EXPECT_FALSE(CORBA::is_nil(made));
  made = make(master, "PeriodicECSharedComposite?manager_address=127.0.0.1:" + std::to_string(support::free_port()));
  EXPECT_TRUE(CORBA::is_nil(made));
  EXPECT_EQ(instance_names(slave), (Strings{"FailOnRequest0", "SinkAll0", "There", "Also"}));
  EXPECT_EQ(instance_names(master), (Strings{"FailOnRequest0", "SinkAll0", "There", "Also", "Here"}));
  RTC::RTCList_var local = master->get_components_by_name("SinkAll0");
  EXPECT_EQ(local->length(), 0u);
  local = master->get_components_by_name("*/Here");
  EXPECT_EQ(local->length(), 1u);
  EXPECT_EQ(master->delete_component("There"), RTC::RTC_OK);
  EXPECT_EQ(master->delete_component("There"), RTC::BAD_PARAMETER);

  EXPECT_EQ(master->add_slave_manager(slave), RTC::BAD_PARAMETER);  // it is one
  EXPECT_EQ(slave->shutdown(), RTC::RTC_OK);
  EXPECT_EQ(slave_process.wait(), 0);
  EXPECT_EQ(slaves(), 0u);
  EXPECT_EQ(instance_names(master), Strings{"Here"});
  EXPECT_EQ(master->shutdown(), RTC::RTC_OK);
  EXPECT_EQ(master_process.wait(), 0);
  EXPECT_TRUE(entries().empty());
}

TEST_F(Servant, masters_and_slaves_are_listed_once_and_forgotten_when_told) {
  const int port = support::free_port();
  const int other_port = support::free_port();
  support::Process rtcd(at_port(port, {"-o", "corba.update_master_manager.enable:NO"}));
  support::Process other_process(at_port(other_port, {"-o", "corba.update_master_manager.enable:NO"}));
  RTM::Manager_var manager = manager_at(port);
  RTM::Manager_var other = manager_at(other_port);
  ASSERT_FALSE(CORBA::is_nil(manager) || CORBA::is_nil(other));
  EXPECT_EQ(manager->add_master_manager(other), RTC::RTC_OK);
  EXPECT_EQ(manager->add_master_manager(other), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->add_slave_manager(other), RTC::RTC_OK);
  EXPECT_EQ(manager->add_slave_manager(other), RTC::BAD_PARAMETER);
  RTM::ManagerList_var list = manager->get_master_managers();
  EXPECT_EQ(list->length(), 1u);
  list = manager->get_slave_managers();
  EXPECT_EQ(list->length(), 1u);
  EXPECT_EQ(manager->remove_master_manager(other), RTC::RTC_OK);
  EXPECT_EQ(manager->remove_master_manager(other), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->remove_slave_manager(other), RTC::RTC_OK);
  EXPECT_EQ(manager->remove_slave_manager(other), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->add_master_manager(RTM::Manager::_nil()), RTC::BAD_PARAMETER);
}

TEST_F(Servant, a_slave_that_hangs_delays_one_call_and_is_told_that_it_was_dropped) {
  const int port = support::free_port();
  support::Process process(at_port(port, {"-d"}));
  RTM::Manager_var master = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(master)) << process.output();
  auto* slave = new HangingSlave;
  PortableServer::Servant_var<HangingSlave> owner(slave);
  RTM::Manager_var reference = slave->_this();
  orb_->activate();
  ASSERT_EQ(master->add_slave_manager(reference), RTC::RTC_OK);
  for (int i = 0; i < 3; ++i) RTC::RTCList_var components = master->get_components();
  EXPECT_EQ(slave->asked, 1) << "nobody waits for it twice";
  EXPECT_EQ(RTM::ManagerList_var(master->get_slave_managers())->length(), 0u);
  EXPECT_TRUE(eventually([&] { return slave->told == 1; }));
  EXPECT_EQ(master->add_slave_manager(reference), RTC::BAD_PARAMETER) << "not so soon";
  slave->end();
}

TEST_F(Servant, slaves_that_hang_cost_the_time_of_one_and_hide_no_other) {
  const int port = support::free_port();
  support::Process process(at_port(port, {"-d"}));
  RTM::Manager_var master = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(master)) << process.output();
  std::vector<std::unique_ptr<support::Process>> slaves;
  for (int i = 0; i < 6; ++i) {
    const int its_port = support::free_port();
    slaves.push_back(
        std::make_unique<support::Process>(at_port(its_port, {"-o", "corba.update_master_manager.enable:NO", "FailOnRequest"})));
    RTM::Manager_var slave = manager_at(its_port);
    ASSERT_FALSE(CORBA::is_nil(slave)) << slaves.back()->output();
    ASSERT_EQ(master->add_slave_manager(slave), RTC::RTC_OK);
  }
  for (std::size_t i = 0; i + 1 < slaves.size(); ++i) slaves[i]->signal(SIGSTOP);
  EXPECT_EQ(RTC::RTCList_var(master->get_components())->length(), 1u);
  EXPECT_EQ(RTM::ManagerList_var(master->get_slave_managers())->length(), 1u) << "one call has found all that hang";
  for (std::size_t i = 0; i + 1 < slaves.size(); ++i) slaves[i]->signal(SIGCONT);
}

// Slaves that answer only when all of them have been asked: asked one after another, each would be waited for in vain.
TEST_F(Servant, slaves_are_asked_at_the_same_time) {
  const int port = support::free_port();
  support::Process process(at_port(port, {"-d"}));
  RTM::Manager_var master = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(master)) << process.output();
  std::vector<PortableServer::Servant_var<HangingSlave>> slaves;
  std::atomic<std::size_t> asked{0};
  orb_->activate();
  constexpr std::size_t count = 4;  // all in this process, and an ORB makes at most five connections to one
  for (std::size_t i = 0; i < count; ++i) {
    slaves.emplace_back(new HangingSlave);
    slaves.back()->on_asked = [&] {
      if (++asked == count) {
        for (auto& slave : slaves) slave->end();
      }
    };
    RTM::Manager_var reference = slaves.back()->_this();
    ASSERT_EQ(master->add_slave_manager(reference), RTC::RTC_OK);
  }
  RTC::RTCList_var components = master->get_components();
  EXPECT_EQ(asked, count);
  EXPECT_EQ(RTM::ManagerList_var(master->get_slave_managers())->length(), count) << "none was dropped";
}

// Each of them would be waited for two seconds; the end of a process may take 30 s in one of its steps.
TEST_F(Servant, a_master_whose_slaves_hang_ends_as_any_other) {
  const int port = support::free_port();
  support::Process process(at_port(port, {"-d"}));
  RTM::Manager_var master = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(master)) << process.output();
  std::vector<PortableServer::Servant_var<HangingSlave>> slaves;
  orb_->activate();
  for (int i = 0; i < 16; ++i) {
    slaves.emplace_back(new HangingSlave);
    slaves.back()->hangs_at_the_end = true;
    RTM::Manager_var reference = slaves.back()->_this();
    ASSERT_EQ(master->add_slave_manager(reference), RTC::RTC_OK);
  }
  EXPECT_EQ(process.stop(), 0) << process.output();
  for (auto& slave : slaves) slave->end();
}

TEST_F(Servant, managers_are_no_slaves_in_a_circle_and_nothing_else_is_one) {
  std::vector<std::unique_ptr<support::Process>> processes;
  std::vector<RTM::Manager_var> managers;
  for (int i = 0; i < 3; ++i) {
    const int port = support::free_port();
    processes.push_back(
        std::make_unique<support::Process>(at_port(port, {"-o", "corba.update_master_manager.enable:NO", "FailOnRequest"})));
    managers.push_back(manager_at(port));
    ASSERT_FALSE(CORBA::is_nil(managers.back())) << processes.back()->output();
  }
  EXPECT_EQ(managers[0]->add_slave_manager(managers[1]), RTC::RTC_OK);
  EXPECT_EQ(managers[1]->add_slave_manager(managers[2]), RTC::RTC_OK);
  EXPECT_EQ(managers[1]->add_slave_manager(managers[0]), RTC::BAD_PARAMETER);
  EXPECT_EQ(managers[2]->add_slave_manager(managers[0]), RTC::BAD_PARAMETER);
  RTC::RTCList_var components = managers[0]->get_components();
  EXPECT_EQ(components->length(), 3u);
  // A component said to be a manager, and one that has died.
  RTM::Manager_var wrong = RTM::Manager::_unchecked_narrow(components[0]);
  EXPECT_EQ(managers[0]->add_slave_manager(wrong), RTC::BAD_PARAMETER);
  EXPECT_EQ(managers[0]->add_master_manager(wrong), RTC::BAD_PARAMETER);
  processes[2]->signal(SIGKILL);
  processes[2]->wait();
  EXPECT_EQ(managers[0]->add_slave_manager(managers[2]), RTC::BAD_PARAMETER);
}

TEST_F(Servant, a_master_that_a_tool_has_named_stays_when_the_configured_one_is_away) {
  const int port = support::free_port();
  const int other_port = support::free_port();
  support::Process rtcd(slave_of(support::free_port(), port, "lonely", {"-o", "corba.update_master_manager.interval:0.1"}));
  support::Process other_process(at_port(other_port, {}));
  RTM::Manager_var manager = manager_at(port);
  RTM::Manager_var other = manager_at(other_port);
  ASSERT_FALSE(CORBA::is_nil(manager) || CORBA::is_nil(other));
  EXPECT_EQ(manager->add_master_manager(other), RTC::RTC_OK);
  std::this_thread::sleep_for(300ms);  // three looks for the configured one; nothing tells when they are over
  RTM::ManagerList_var list = manager->get_master_managers();
  EXPECT_EQ(list->length(), 1u);
}

TEST_F(Servant, master_and_slave_end_together_without_waiting_for_each_other) {
  for (int i = 0; i < 5; ++i) {
    const int port = support::free_port();
    support::Process master_process(at_port(port, {"-d", "FailOnRequest?instance_name=M"}));
    RTM::Manager_var master = manager_at(port);
    ASSERT_FALSE(CORBA::is_nil(master)) << master_process.output();
    support::Process slave_process(slave_of(port, support::free_port(), "slave", {"FailOnRequest?instance_name=S"}));
    ASSERT_TRUE(eventually([&] { return instance_names(master) == Strings{"M", "S"}; })) << slave_process.output();
    master_process.signal(SIGTERM);
    slave_process.signal(SIGTERM);
    EXPECT_EQ(master_process.wait(), 0) << master_process.output();
    EXPECT_EQ(slave_process.wait(), 0) << slave_process.output();
    EXPECT_TRUE(entries().empty());
  }
}

TEST_F(Servant, tools_may_look_while_components_come_and_go) {
  const int port = support::free_port();
  support::Process rtcd(at_port(port, {"-o", "manager.shutdown_on_nortcs:NO"}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();
  std::atomic<bool> ended = false;
  std::atomic<int> looks = 0;
  std::vector<std::future<void>> tools;
  for (int i = 0; i < 2; ++i) {
    tools.push_back(std::async(std::launch::async, [&] {
      while (!ended) {
        RTC::ComponentProfileList_var profiles = manager->get_component_profiles();
        RTC::RTCList_var components = manager->get_components_by_name("Brief");
        components = manager->get_components();
        ++looks;
      }
    }));
  }
  for (int i = 0; i < 100; ++i) {
    RTC::RTObject_var made = make(manager, "FailOnRequest?instance_name=Brief");
    ASSERT_TRUE(eventually([&] {  // the name is free when the one before has been deleted
      if (CORBA::is_nil(made)) made = make(manager, "FailOnRequest?instance_name=Brief");
      return !CORBA::is_nil(made);
    }));
    EXPECT_EQ(manager->delete_component("Brief"), RTC::RTC_OK);
  }
  ended = true;
  for (auto& tool : tools) EXPECT_NO_THROW(tool.get());
  EXPECT_GT(looks, 0);
  EXPECT_EQ(rtcd.stop(), 0) << rtcd.output();
}

}  // namespace
}  // namespace manager_test
