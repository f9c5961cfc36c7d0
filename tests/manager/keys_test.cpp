// What each key of rtc.conf does, seen from the program and over the wire. Each test has the process for itself in ctest.
#include <gtest/gtest.h>
#include <rtm/CORBA_IORUtil.h>
#include <rtm/CORBA_RTCUtil.h>
#include <rtm/CorbaNaming.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/LocalServiceAdmin.h>
#include <rtm/Manager.h>
#include <rtm/NVUtil.h>
#include <rtm/NamingManager.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <sched.h>

#include <coil/ClockManager.h>

#include <fstream>
#include <future>
#include <sstream>

#include "manager/ported_fixture.h"
#include "manager/rtcd_fixture.h"

namespace manager_test {
namespace {

using namespace std::chrono_literals;

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::string> addresses_of(RTC::Manager* manager, CORBA::Object_ptr object) {
  CORBA::String_var text = manager->getORB()->object_to_string(object);
  IOP::IOR ior;
  CORBA_IORUtil::toIOR(text, ior);
  std::vector<std::string> result;
  for (const auto& address : CORBA_IORUtil::getEndpoints(ior)) {
    result.push_back(std::string(address.host.in()) + ":" + std::to_string(address.port));
  }
  return result;
}

// --- corba

TEST(Keys, corba_endpoints_and_endpoint_are_where_it_listens_and_are_read_back) {
  const auto first = std::to_string(support::free_port());
  Started manager({"corba.endpoints:127.0.0.1:" + first, "corba.endpoint:127.0.0.2:"});
  const auto ipv4 = manager->configValue("corba.endpoints_ipv4");
  EXPECT_TRUE(ipv4.starts_with("127.0.0.1:" + first + ",127.0.0.2:")) << ipv4;
  EXPECT_EQ(manager->configValue("corba.endpoints_ipv6"), "");
  EXPECT_TRUE(support::is_listening(std::stoi(first)));
}

TEST(Keys, corba_args_go_to_the_orb) {
  const auto port = std::to_string(support::free_port());
  Started manager({"corba.args:-ORBendPoint 'giop:tcp:127.0.0.1:" + port + "' -ORBgiopMaxMsgSize 4194304"});
  EXPECT_EQ(manager->configValue("corba.endpoints_ipv4"), "127.0.0.1:" + port);
  EXPECT_EQ(omniORB::giopMaxMsgSize(), 4194304u);
}

TEST(Keys, corba_alternate_iiop_addresses_are_published_too) {
  Started manager({"corba.alternate_iiop_addresses:127.0.0.9:5555"});
  const auto ipv4 = manager->configValue("corba.endpoints_ipv4");
  EXPECT_TRUE(ipv4.ends_with(",127.0.0.9:5555")) << ipv4;
}

TEST(Keys, corba_nameservice_replace_endpoint_binds_the_address_that_the_service_sees) {
  support::NamingService names;
  const auto port = std::to_string(support::free_port());
  for (const auto& [flag, host] : {std::pair("NO", "127.0.0.2"), std::pair("YES", "127.0.0.1")}) {
    Started manager({"naming.enable:YES", "corba.nameservers:" + names.address(), "naming.formats:%n.rtc",
                     "corba.endpoints:127.0.0.2:" + port, std::string("corba.nameservice.replace_endpoint:") + flag});
    ASSERT_EQ(manager.make("Ported"), "Ported0");
    CORBA::Object_var bound = manager->getNaming()->resolve("Ported0.rtc");
    EXPECT_EQ(addresses_of(RTC::Manager::instance_if_any(), bound), std::vector<std::string>{host + (":" + port)});
  }
}

TEST(Keys, corba_master_manager_is_the_port_of_a_master) {
  const auto port = support::free_port();
  Started manager({"manager.is_master:YES", "corba.master_manager:localhost:" + std::to_string(port)});
  EXPECT_TRUE(support::is_listening(port));
}

TEST(Keys, a_manager_without_servant_cannot_be_asked) {
  const auto port = std::to_string(support::free_port());
  Started manager({"manager.corba_servant:NO", "corba.endpoints::" + port});
  CORBA::Object_var object = manager->getORB()->string_to_object(("corbaloc:iiop:127.0.0.1:" + port + "/manager").c_str());
  EXPECT_THROW(object->_is_a("IDL:RTM/Manager:1.0"), CORBA::Exception);
  EXPECT_THROW(manager->getManagerServant(), CORBA::OBJECT_NOT_EXIST);
}

TEST(Keys, manager_name_is_the_object_key) {
  const auto port = std::to_string(support::free_port());
  Started manager({"manager.name:boss", "corba.endpoints::" + port});
  CORBA::Object_var object = manager->getORB()->string_to_object(("corbaloc:iiop:127.0.0.1:" + port + "/boss").c_str());
  RTM::Manager_var narrowed = RTM::Manager::_narrow(object);
  EXPECT_FALSE(CORBA::is_nil(narrowed));
}

// --- naming

TEST(Keys, naming_formats_may_be_several_with_every_escape) {
  support::NamingService names;
  Started manager({"naming.enable:YES", "corba.nameservers:" + names.address(),
                   "naming.formats:%h.host_cxt/%n.rtc,%M.mgr_cxt/%c.cat_cxt/%m.mod_cxt/%n.rtc,%t-%v-%V-%i-%N-%p%%.rtc"});
  ASSERT_EQ(manager.make("Ported"), "Ported0");
  const auto pid = std::to_string(getpid());
  const auto host = manager->configValue("os.hostname");
  for (const auto& name : {host + ".host_cxt/Ported0.rtc", std::string("manager.mgr_cxt/test.cat_cxt/Ported.mod_cxt/Ported0.rtc"),
                           "Ported-1\\.0-rtm-sim-Ported-0-" + pid + "%.rtc"}) {
    CORBA::Object_var bound = manager->getNaming()->resolve(name);
    EXPECT_FALSE(CORBA::is_nil(bound)) << name;
  }
}

TEST(Keys, naming_type_manager_finds_components_at_managers_without_a_naming_service) {
  const auto port = std::to_string(support::free_port());
  support::Process other({program, "-i", "-f", "none.conf", "-p", port, "-d", "-o", "naming.enable:NO", "-o",
                          "manager.modules.load_path:" + modules, "SinkAll?instance_name=Far", "SourceAll?instance_name=FarSource"});
  Started manager({"naming.enable:YES", "naming.type:manager", "corba.master_manager:127.0.0.1:" + port});
  EXPECT_TRUE(eventually([&] { return manager->getNaming()->string_to_component("FarSource").length() == 1; })) << other.output();
  EXPECT_EQ(manager->getNaming()->string_to_component("Nobody").length(), 0u);
  EXPECT_EQ(manager->getNaming()->componentsOfManagers().length(), 2u);
  ASSERT_EQ(manager.make("Ported"), "Ported0");
  manager->connectPorts("Ported0.out?port=Far.long,FarSource.long?port=Ported0.in");
  RTC::RTObject_var mine = manager.reference("Ported0");
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names(mine, "out").size(), 1u);
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names(mine, "in").size(), 1u);
}

TEST(Keys, manager_nameservers_are_further_managers_to_ask) {
  const auto port = std::to_string(support::free_port());
  support::Process other({program, "-i", "-f", "none.conf", "-p", port, "-o", "naming.enable:NO", "-o",
                          "manager.modules.load_path:" + modules, "SinkAll?instance_name=Far"});
  Started manager({"naming.enable:YES", "naming.type:manager", "manager.nameservers:127.0.0.1:" + port,
                   "corba.master_manager:127.0.0.1:" + std::to_string(support::free_port())});
  EXPECT_TRUE(eventually([&] { return manager->getNaming()->string_to_component("Far").length() == 1; })) << other.output();
}

// --- logger

TEST(Keys, logger_settings_shape_every_line) {
  support::TemporaryFolder folder;
  const auto pattern = (folder.path() / "log-%M-%p.txt").string();
  {
    Started manager({"logger.file_name:" + pattern, "logger.log_level:DEBUG", "logger.date_format:<%Y>", "manager.name:me"});
    RTC::Logger rtclog("speaker");
    RTC_DEBUG(("hello"));
    RTC_TRACE(("unheard"));
  }
  const auto text = content_of(folder.path() / ("log-me-" + std::to_string(getpid()) + ".txt"));
  EXPECT_NE(text.find("> DEBUG: speaker: hello\n"), std::string::npos) << text;
  EXPECT_TRUE(text.starts_with("<2"));
  EXPECT_EQ(text.find("unheard"), std::string::npos);
  RTC::setLogSettings({});
}

TEST(Keys, logger_colours_clock_and_silence) {
  support::TemporaryFolder folder;
  const auto file = (folder.path() / "log").string();
  coil::ClockManager::instance().getClock("logical").settime(coil::TimeValue(1000, 0));
  {
    Started manager(
        {"logger.file_name:" + file, "logger.clock_type:logical", "logger.date_format:%s", "logger.escape_sequence_enable:YES"});
    RTC::Logger rtclog("speaker");
    RTC_ERROR(("red"));
  }
  EXPECT_NE(content_of(file).find("\x1b[31m1000 ERROR: speaker: red\x1b[0m\n"), std::string::npos) << content_of(file);
  {
    Started manager({"logger.file_name:" + file + "2", "logger.enable:NO"});
    RTC::Logger rtclog("speaker");
    RTC_ERROR(("unheard"));
  }
  EXPECT_EQ(content_of(file + "2"), "");
  RTC::setLogSettings({});
}

// --- manager

TEST(Keys, manager_cpu_affinity_binds_every_thread) {
  cpu_set_t before;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  int last = 0;
  for (int i = 0; i < CPU_SETSIZE; ++i) {
    if (CPU_ISSET(static_cast<std::size_t>(i), &before)) last = i;
  }
  {
    Started manager({"manager.cpu_affinity:" + std::to_string(last)});
    std::promise<int> count;
    const auto task = manager->addTask(
        [&, told = false]() mutable {
          cpu_set_t set;
          sched_getaffinity(0, sizeof set, &set);
          if (!std::exchange(told, true)) count.set_value(CPU_ISSET(static_cast<std::size_t>(last), &set) ? CPU_COUNT(&set) : -1);
        },
        1s);
    EXPECT_EQ(count.get_future().get(), 1);
    manager->removeTask(task);
  }
  sched_setaffinity(0, sizeof before, &before);
}

TEST(Keys, module_paths_suffixes_and_functions) {
  support::TemporaryFolder folder;
  std::filesystem::copy_file(modules + "/FailOnRequest.so", folder.path() / "Renamed.module");
  Started manager({"manager.modules.load_path:" + (folder.path() / "missing").string(),
                   "manager.modules.C++.load_paths:" + folder.path().string(), "manager.modules.C++.suffixes:module,so",
                   "manager.modules.init_func_prefix:FailOn", "manager.modules.init_func_suffix:Init"});
  EXPECT_EQ(manager->load("Renamed"), RTC::RTC_ERROR);  // it has no FailOnRenamedInit
  EXPECT_EQ(manager->load("Renamed(FailOnRequestInit)"), RTC::RTC_OK);
  const auto loadable = manager->getLoadableModules();
  EXPECT_EQ(loadable.size(), 0u);  // rtcprof does not know the function
  EXPECT_EQ(manager.make("FailOnRequest"), "FailOnRequest0");
}

TEST(Keys, modules_that_cannot_be_looked_into_cost_only_their_own_profiles) {
  support::TemporaryFolder folder;
  std::filesystem::copy_file(modules + "/damaged/EndsOnLoad.so", folder.path() / "EndsOnLoad.so");
  for (const auto* name : {"EchoConsumer.so", "EchoProvider.so", "FailOnRequest.so"})
    std::filesystem::copy_file(modules + "/" + name, folder.path() / name);
  std::ofstream(folder.path() / "Text.so") << "no library";
  Started manager({"manager.modules.load_path:" + folder.path().string()});
  for (int again = 0; again < 2; ++again) {
    std::set<std::string> found;
    for (const auto& profile : manager->getLoadableModules())
      found.insert(profile.getProperty("implementation_id") + " in " + profile.getProperty("module_file_name") + " of " +
                   std::filesystem::path(profile.getProperty("module_file_path")).parent_path().filename().string());
    const auto in = " of " + folder.path().filename().string();
    EXPECT_EQ(found, (std::set<std::string>{"EchoConsumer in EchoConsumer.so" + in, "EchoProvider in EchoProvider.so" + in,
                                            "FailOnRequest in FailOnRequest.so" + in}));
  }
  // One that is there later, or another one in its place, is seen.
  std::filesystem::remove(folder.path() / "Text.so");
  std::filesystem::copy_file(modules + "/SinkAll.so", folder.path() / "SinkAll.so");
  EXPECT_EQ(manager->getLoadableModules().size(), 4u);
}

TEST(Keys, module_profile_command_is_asked_for_profiles) {
  support::TemporaryFolder folder;
  const auto script = (folder.path() / "profiles").string();
  std::ofstream(script) << "#!/bin/sh\necho implementation_id: FromScript\necho file: $1\necho ---\n";
  std::filesystem::permissions(script, std::filesystem::perms::owner_all);
  std::ofstream(folder.path() / "Any.so") << "no library";
  Started manager({"manager.modules.load_path:" + folder.path().string(), "manager.modules.C++.profile_cmd:" + script});
  const auto loadable = manager->getLoadableModules();
  ASSERT_EQ(loadable.size(), 1u);
  EXPECT_EQ(loadable[0].getProperty("implementation_id"), "FromScript");
  EXPECT_EQ(loadable[0].getProperty("file"), (folder.path() / "Any.so").string());
}

TEST(Keys, a_module_profile_command_that_does_not_end_is_ended) {
  support::TemporaryFolder folder;
  const auto script = (folder.path() / "profiles").string();
  std::ofstream(script) << "#!/bin/sh\necho implementation_id: FromScript\nexec >&-\nexec sleep 1000\n";
  std::filesystem::permissions(script, std::filesystem::perms::owner_all);
  std::ofstream(folder.path() / "Any.so") << "no library";
  Started manager({"manager.modules.load_path:" + folder.path().string(), "manager.modules.C++.profile_cmd:" + script});
  EXPECT_EQ(manager->getLoadableModules().size(), 0u);
}

TEST(Keys, modules_are_preloaded_or_searched_or_neither) {
  {
    Started manager({"manager.modules.load_path:" + modules, "manager.modules.preload:FailOnRequest.so", "manager.modules.search_auto:NO"});
    EXPECT_EQ(manager.make("FailOnRequest"), "FailOnRequest0");
    EXPECT_EQ(manager.make("SinkAll"), "");
  }
  Started manager({"manager.modules.load_path:" + modules, "manager.modules.abs_path_allowed:NO"});
  EXPECT_EQ(manager->load(modules + "/FailOnRequest.so"), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(manager.make("SinkAll"), "SinkAll0");
}

TEST(Keys, without_absolute_paths_no_way_leads_out_of_the_load_path) {
  support::TemporaryFolder folder;
  const auto load = folder.path() / "load";
  const auto outside = folder.path() / "outside";
  std::filesystem::create_directories(load / "inner");
  std::filesystem::create_directories(outside);
  const std::string file = "FailOnRequest.so";
  std::filesystem::copy_file(modules + "/" + file, outside / file);
  std::filesystem::copy_file(modules + "/" + file, load / "inner" / file);
  std::filesystem::create_symlink(outside / file, load / "Link.so");
  std::filesystem::create_directory_symlink("../outside", load / "away");
  std::filesystem::create_directory_symlink("load", folder.path() / "path");  // the load path itself may be one
  const std::string from_here = std::filesystem::relative(outside / file).string();
  {
    Started manager({"manager.modules.load_path:" + (folder.path() / "path").string(), "manager.modules.abs_path_allowed:NO"});
    const auto load_module = [&](const std::string& name) { return manager->load(name, "FailOnRequestInit"); };
    for (const std::string& name :
         {"../outside/" + file, std::string("Link.so"), std::string("Link"), "away/" + file, "inner/../../outside/" + file, from_here}) {
      EXPECT_EQ(load_module(name), RTC::PRECONDITION_NOT_MET) << name;
    }
    EXPECT_EQ(manager.make("FailOnRequest"), "");
    EXPECT_EQ(load_module("inner/../inner/" + file), RTC::RTC_OK);
    EXPECT_EQ(manager.make("FailOnRequest"), "FailOnRequest0");
  }
  Started manager({"manager.modules.load_path:" + load.string()});
  EXPECT_EQ(manager->load("../outside/" + file), RTC::RTC_OK) << "allowed unless it is forbidden";
}

class Local final : public RTM::LocalServiceBase {
 public:
  bool init(const coil::Properties& properties) override {
    profile_.name = "local";
    profile_.service = this;
    profile_.properties = properties;
    return true;
  }
  bool reinit(const coil::Properties&) override { return true; }
  const RTM::LocalServiceProfile& getProfile() const override { return profile_; }
  void finalize() override {}

 private:
  RTM::LocalServiceProfile profile_;
};

TEST(Keys, local_services_are_made_when_they_are_enabled) {
  RTM::LocalServiceFactory::instance().addFactory("local", coil::Creator<RTM::LocalServiceBase, Local>,
                                                  coil::Destructor<RTM::LocalServiceBase, Local>);
  RTM::LocalServiceProfile profile;
  {
    Started manager({"manager.local_service.local.x:1"});
    ASSERT_TRUE(RTM::LocalServiceAdmin::instance().getServiceProfile("local", profile));
    EXPECT_EQ(profile.properties.getProperty("x"), "1");
  }
  Started manager({"manager.local_service.enabled_services:other"});
  EXPECT_FALSE(RTM::LocalServiceAdmin::instance().getServiceProfile("local", profile));
}

// --- components

TEST(Keys, contexts_and_ports_start_from_the_manager_s_settings) {
  Started manager({"exec_cxt.periodic.rate:40", "exec_cxt.sync_transition:NO", "exec_cxt.transition_timeout:3", "exec_cxt.cpu_affinity:0",
                   "port.inport.dataport.buffer.length:7", "port.inport.in.mine:1", "port.outport.dataport.push_policy:all"});
  ASSERT_EQ(manager.make("Ported"), "Ported0");
  RTC::RTObject_var component = manager.reference("Ported0");
  EXPECT_EQ(CORBA_RTCUtil::get_current_rate(component, 0), 40);
  RTC::ExecutionContext_var context = component->get_context(0);
  RTC::ExecutionContextService_var service = RTC::ExecutionContextService::_narrow(context);
  RTC::ExecutionContextProfile_var profile = service->get_profile();
  EXPECT_EQ(NVUtil::toString(profile->properties, "sync_transition"), "NO");
  EXPECT_EQ(NVUtil::toString(profile->properties, "transition_timeout"), "3");
  EXPECT_EQ(NVUtil::toString(profile->properties, "cpu_affinity"), "0");
  RTC::PortService_var in = CORBA_RTCUtil::get_port_by_name(component, "in");
  RTC::PortProfile_var port = in->get_port_profile();
  EXPECT_EQ(NVUtil::toString(port->properties, "buffer.length"), "7");
  EXPECT_EQ(NVUtil::toString(port->properties, "mine"), "1");
  RTC::PortService_var out = CORBA_RTCUtil::get_port_by_name(component, "out");
  port = out->get_port_profile();
  EXPECT_EQ(NVUtil::toString(port->properties, "push_policy"), "all");
}

TEST(Keys, exec_cxt_periodic_type_chooses_the_context) {
  Started manager({"exec_cxt.periodic.type:ExtTrigExecutionContext"});
  ASSERT_EQ(manager.make("Ported"), "Ported0");
  RTC::ExecutionContext_var context = manager.reference("Ported0")->get_context(0);
  EXPECT_TRUE(context->_is_a("IDL:openrtm.aist.go.jp/OpenRTM/ExtTrigExecutionContextService:1.0"));
}

TEST(Keys, sdo_services_are_those_that_are_enabled) {
  const auto answer = [](const Started& manager) {
    EXPECT_EQ(manager.make("Ported"), "Ported0");
    SDOPackage::Configuration_var configuration = manager.reference("Ported0")->get_configuration();
    SDOPackage::ServiceProfile profile;
    profile.id = "watch";
    profile.interface_type = "IDL:OpenRTM/ComponentObserver:1.0";
    profile.service = SDOPackage::SDOService::_nil();
    try {
      return configuration->add_service_profile(profile);
    } catch (const SDOPackage::InvalidParameter&) {
      return false;
    }
  };
  {
    Started manager({"sdo.service.consumer.enabled_services:IDL:OpenRTM/Logger:1.0"});
    EXPECT_FALSE(answer(manager));
  }
  Started manager({"sdo.service.provider.enabled_services:none"});
  ASSERT_EQ(manager.make("Ported"), "Ported0");
  SDOPackage::ServiceProfileList_var profiles = manager.reference("Ported0")->get_service_profiles();
  EXPECT_EQ(profiles->length(), 0u);
}

// --- what is wrong

TEST(Keys, everything_wrong_in_a_file_is_said_with_its_line) {
  support::TemporaryFolder folder;
  const auto file = (folder.path() / "rtc.conf").string();
  std::ofstream(file) << "naming.enable: NO\n"                       // 1
                         "naming.type: dns\n"                        // 2
                         "manager.topic.chatter: x\n"                // 3
                         "manager.cpu_affinity: 1000000\n"           // 4
                         "manager.components.naming_policy: mine\n"  // 5
                         "manager.modules.load_path: "
                      << modules
                      << "\n"                                                                    // 6
                         "manager.components.precreate: SinkAll, \\\n  ?x=1\n"                   // 7, 8
                         "manager.components.preconnect: A.x, SinkAll0.long?port=Nobody.long\n"  // 9
                         "manager.components.preactivation: Nobody\n"                            // 10
                         "example.SinkAll.config_file: nowhere.conf\n"                           // 11
                         "corba.nameservers: a:b\n"                                              // 12
                         "manager.shutdown_on_nortcs: maybe\n"                                   // 13
                         "corba.update_master_manager.interval: -3\n";                           // 14
  support::Process rtcd({program, "-f", file});
  ASSERT_TRUE(rtcd.wait_for_output("rtc.conf:10:"));
  EXPECT_EQ(rtcd.stop(), 0);
  const auto output = rtcd.output();
  for (const auto& text : {
           ":2: naming.type must be of corba, manager, got \"dns\"; corba is used",
           ":3: unknown key \"manager.topic.chatter\"",
           ":4: manager.cpu_affinity names no processor of this machine",
           ":5: manager.components.naming_policy: unknown policy \"mine\"; process_unique is used",
           ":7: manager.components.precreate: component \"\": no type given",
           ":9: manager.components.preconnect: connection \"A.x\": expected port=component.port",
           ":9: connection \"SinkAll0.long?port=Nobody.long\": component \"Nobody\": not found",
           ":10: activation: component \"Nobody\": not found",
           ":11: example.SinkAll.config_file: file \"nowhere.conf\": does not exist",
           ":12: corba.nameservers must be host or host:port, got \"a:b\"",
           ":13: manager.shutdown_on_nortcs must be YES or NO, got \"maybe\"; YES is used",
           ":14: corba.update_master_manager.interval must be a number that is not negative",
       }) {
    EXPECT_NE(output.find(file + text), std::string::npos) << text << "\n--- in\n" << output;
  }
}

}  // namespace
}  // namespace manager_test
