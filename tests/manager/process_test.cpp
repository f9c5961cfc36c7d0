// rtcd and what tools see of it: real processes, a real naming service, only the loopback interface.
#include <gtest/gtest.h>
#include <rtm/CORBA_RTCUtil.h>
#include <rtm/NVUtil.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "manager/rtcd_fixture.h"

namespace manager_test {
namespace {

using namespace std::chrono_literals;

TEST_F(Rtcd, makes_connects_and_activates_what_its_configuration_names_and_leaves_nothing) {
  support::Process rtcd(command({"-o", "manager.components.precreate:SourceAll, SinkAll?instance_name=Sink", "-o",
                                 "manager.components.preconnect:SourceAll0.long?port=Sink.long&subscription_type=new", "-o",
                                 "manager.components.preactivation:SourceAll0,Sink"}));
  ASSERT_TRUE(rtcd.wait_for_output("long: 3")) << rtcd.output();
  EXPECT_EQ(entries(), (std::set<std::string>{"SourceAll0.rtc", "Sink.rtc", "manager.mgr"}));
  RTC::RTObject_var sink = component("Sink.rtc");
  EXPECT_TRUE(CORBA_RTCUtil::is_in_active(sink));
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names(sink, "long"), coil::vstring{"SourceAll0.long?port=Sink.long&subscription_type=new"});
  const auto properties = CORBA_RTCUtil::get_component_profile(sink);
  EXPECT_EQ(std::as_const(properties)["naming.names"], "Sink.rtc");
  EXPECT_EQ(std::as_const(properties)["manager.instance_name"], "manager");
  EXPECT_EQ(rtcd.stop(), 0);
  EXPECT_TRUE(entries().empty());
}

TEST_F(Rtcd, a_module_brings_serializers_for_the_ports_of_others) {
  const std::vector<std::string> with_wrappers{"-o", "manager.modules.preload:Wrappers.so"};
  auto sinking = with_wrappers;
  sinking.insert(sinking.end(), {"-o", "manager.components.precreate:SinkAll", "-o", "manager.components.preactivation:SinkAll0"});
  support::Process sink(command(sinking));
  ASSERT_TRUE(eventually([&] { return has("SinkAll0.rtc"); })) << sink.output();
  const std::string there = "rtcname://" + names_.address() + "/SinkAll0.";
  auto sourcing = with_wrappers;
  sourcing.insert(sourcing.end(), {"-o", "manager.components.precreate:SourceAll", "-o",
                                   "manager.components.preconnect:SourceAll0.short?port=" + there +
                                       "double&outport.marshaling_type=cdr:RTC/TimedDouble:RTC/TimedShort,"
                                       "SourceAll0.long?port=" +
                                       there +
                                       "long&marshaling_type=packed&packed.offset=5,"
                                       "SourceAll0.float?port=" +
                                       there + "float&marshaling_type=packed",
                                   "-o", "manager.components.preactivation:SourceAll0"});
  support::Process source(command(sourcing));
  EXPECT_TRUE(sink.wait_for_output("double: 3")) << source.output();
  EXPECT_TRUE(sink.wait_for_output("long: 3")) << source.output();
  EXPECT_TRUE(source.wait_for_output("dataport.marshaling_type must be cdr for a IDL:RTC/TimedFloat:1.0, got \"packed\""))
      << source.output();
  RTC::RTObject_var made = component("SourceAll0.rtc");
  const auto marshalings = [&](const char* port) {
    RTC::PortService_var found = CORBA_RTCUtil::get_port_by_name(made, std::string("SourceAll0.") + port);
    RTC::PortProfile_var profile = found->get_port_profile();
    return NVUtil::toString(profile->properties, "dataport.marshaling_types");
  };
  EXPECT_EQ(marshalings("short"), "cdr,cdr:RTC/TimedDouble:RTC/TimedShort");
  EXPECT_EQ(marshalings("long"), "cdr,packed");
  EXPECT_EQ(marshalings("float"), "cdr");
  EXPECT_EQ(source.stop(), 0);
  EXPECT_EQ(sink.stop(), 0);
}

TEST_F(Rtcd, contexts_with_an_author_s_own_loop_run_stop_and_change_their_rate) {
  const auto makes = [](const std::string& type) { return "SourceAll?execution_contexts=" + type + "(own)&ec.own.rate=100"; };
  for (const std::string type : {"MembersLoop", "TimedLoop", "PhasesLoop", "ChronoLoop", "OwnLoopEC", "StepEC", "CycleEC"}) {
    support::Process rtcd(
        command({"-o", "manager.modules.preload:LoopECs.so,CycleEC.so,StepEC.so(" + (type == "OwnLoopEC" ? type : "StepEC") + "Init)", "-o",
                 "manager.components.precreate:" + makes(type) + ",SinkAll", "-o",
                 "manager.components.preconnect:SourceAll0.long?port=SinkAll0.long", "-o",
                 "manager.components.preactivation:SourceAll0,SinkAll0"}));
    // Any sample: StepEC is faster than the sink, whose buffer drops some.
    ASSERT_TRUE(rtcd.wait_for_output("long: ")) << type << rtcd.output();
    const bool says_members = type != "TimedLoop" || rtcd.wait_for_output("member SourceAll0 of 10000 us");
    EXPECT_TRUE(says_members) << rtcd.output();
    RTC::RTObject_var source = component("SourceAll0.rtc");
    RTC::ExecutionContextList_var contexts = source->get_owned_contexts();
    ASSERT_EQ(contexts->length(), 1u) << type;
    RTC::ExecutionContext_ptr context = contexts[0];
    EXPECT_EQ(context->set_rate(500), RTC::RTC_OK) << type;
    EXPECT_EQ(context->get_rate(), 500.0) << type;
    EXPECT_EQ(context->deactivate_component(source), RTC::RTC_OK) << type;
    EXPECT_EQ(context->stop(), RTC::RTC_OK) << type;
    EXPECT_EQ(context->start(), RTC::RTC_OK) << type;
    EXPECT_EQ(context->activate_component(source), RTC::RTC_OK) << type;
    EXPECT_EQ(rtcd.stop(), 0) << type;
  }
}

TEST_F(Rtcd, components_register_again_after_the_naming_service_restarts) {
  support::Process rtcd(command({"FailOnRequest"}));
  ASSERT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); })) << rtcd.output();
  names_.start_again(true);
  EXPECT_TRUE(eventually([&] { return has("FailOnRequest0.rtc") && has("manager.mgr"); })) << rtcd.output();
  names_.kill();
  names_.start_again(false);
  EXPECT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); })) << rtcd.output();
  EXPECT_EQ(rtcd.stop(), 0);
  EXPECT_TRUE(entries().empty());
}

TEST_F(Rtcd, a_naming_service_that_hangs_delays_nothing_for_long) {
  names_.process().signal(SIGSTOP);
  const int port = support::free_port();
  support::Process rtcd(command({"-p", std::to_string(port), "-o", "naming.update.timeout:0.2", "FailOnRequest"}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();
  EXPECT_TRUE(eventually([&] {
    RTC::RTCList_var list = manager->get_components();
    return list->length() == 1;
  }));
  names_.process().signal(SIGCONT);
  EXPECT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); }));
  names_.process().signal(SIGSTOP);
  EXPECT_EQ(rtcd.stop(), 0);
  names_.process().signal(SIGCONT);
}

// Start and stop of a process with ten connected components: 200 times with RTMSIM_START_STOP=200.
TEST_F(Rtcd, starts_and_stops_with_ten_connected_components_many_times) {
  const char* given = std::getenv("RTMSIM_START_STOP");
  const int times = given != nullptr ? std::atoi(given) : 100;
  std::string precreate;
  std::string preconnect;
  std::string preactivation;
  for (int i = 0; i < 5; ++i) {
    const auto n = std::to_string(i);
    const std::string comma = i > 0 ? "," : "";
    precreate += comma + "SourceAll,SinkAll";
    preconnect += comma + "SourceAll" + n + ".long?port=SinkAll" + n + ".long";
    preactivation += comma + "SourceAll" + n + ",SinkAll" + n;
  }
  for (int i = 0; i < times; ++i) {
    support::Process rtcd(command({"-o", "manager.components.precreate:" + precreate, "-o", "manager.components.preconnect:" + preconnect,
                                   "-o", "manager.components.preactivation:" + preactivation}));
    ASSERT_TRUE(rtcd.wait_for_output("long: 1")) << i << rtcd.output();
    ASSERT_EQ(rtcd.stop(), 0) << i << rtcd.output();
    ASSERT_TRUE(entries().empty()) << i;
  }
}

TEST_F(Rtcd, the_manager_answers_every_operation) {
  const int port = support::free_port();
  support::Process rtcd(command({"-d", "-p", std::to_string(port)}));
  RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();
  EXPECT_TRUE(manager->is_master());

  RTM::ManagerProfile_var profile = manager->get_profile();
  for (const auto* key :
       {"name", "instance_name", "pid", "naming_formats", "refstring_path", "components.precreate", "modules.load_path",
        "modules.abs_path_allowed", "modules.config_path", "modules.preload", "modules.init_func_prefix", "modules.init_func_suffix",
        "modules.download_allowed", "os.name", "os.release", "os.version", "os.arch", "os.hostname"}) {
    EXPECT_GE(NVUtil::find_index(profile->properties, key), 0) << key;
  }
  EXPECT_EQ(NVUtil::toString(profile->properties, "pid"), std::to_string(rtcd.pid()));

  EXPECT_EQ(manager->load_module("NoSuchModule", ""), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->load_module("FailOnRequest.so", "NoSuchInit"), RTC::RTC_ERROR);
  EXPECT_EQ(manager->load_module("FailOnRequest.so", "FailOnRequestInit"), RTC::RTC_OK);
  EXPECT_EQ(manager->load_module("FailOnRequest", ""), RTC::RTC_OK);
  RTM::ModuleProfileList_var list = manager->get_loaded_modules();
  EXPECT_EQ(list->length(), 1u);
  list = manager->get_factory_profiles();
  EXPECT_EQ(list->length(), 2u);  // and the composite
  list = manager->get_loadable_modules();
  bool is_listed = false;
  for (CORBA::ULong i = 0; i < list->length(); ++i) {
    is_listed = is_listed || NVUtil::toString(list[i].properties, "implementation_id") == "SinkAll";
  }
  EXPECT_TRUE(is_listed);

  RTC::RTObject_var made =
      manager->create_component("RTC:rtm-sim:example:FailOnRequest:C++:1.0.0?instance_name=Fail&conf.default.how=throw");
  ASSERT_FALSE(CORBA::is_nil(made));
  EXPECT_EQ(CORBA_RTCUtil::get_parameter_by_key(made, "default", "how"), "throw");
  RTC::RTObject_var by_number = manager->create_component("FailOnRequest");
  EXPECT_TRUE(has("FailOnRequest1.rtc"));  // Fail was number 0
  RTC::RTCList_var components = manager->get_components();
  EXPECT_EQ(components->length(), 2u);
  RTC::ComponentProfileList_var profiles = manager->get_component_profiles();
  EXPECT_EQ(profiles->length(), 2u);
  for (const auto* name : {"Fail", "example/Fail", "*/Fail"}) {
    components = manager->get_components_by_name(name);
    EXPECT_EQ(components->length(), 1u) << name;
  }
  components = manager->get_components_by_name("other/Fail");
  EXPECT_EQ(components->length(), 0u);
  CORBA::Object_var by_key = orb_->orb()->string_to_object(("corbaloc:iiop:127.0.0.1:" + std::to_string(port) + "/example.Fail").c_str());
  RTC::RTObject_var narrowed = RTC::RTObject::_narrow(by_key);
  ASSERT_FALSE(CORBA::is_nil(narrowed));
  CORBA::String_var id = narrowed->get_sdo_id();
  EXPECT_STREQ(id, "Fail");

  EXPECT_EQ(manager->unload_module("FailOnRequest"), RTC::PRECONDITION_NOT_MET);
  EXPECT_EQ(manager->delete_component("nobody"), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->delete_component("Fail"), RTC::RTC_OK);
  EXPECT_EQ(manager->delete_component("FailOnRequest1"), RTC::RTC_OK);
  EXPECT_TRUE(eventually([&] { return manager->unload_module("FailOnRequest") == RTC::RTC_OK; }));
  EXPECT_EQ(manager->unload_module("FailOnRequest"), RTC::BAD_PARAMETER);
  EXPECT_EQ(entries(), std::set<std::string>{"manager.mgr"});

  EXPECT_EQ(manager->set_configuration("manager.components.precreate", "X"), RTC::RTC_OK);
  EXPECT_EQ(manager->set_configuration("naming.update.interval", "often"), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->set_configuration("", "1"), RTC::BAD_PARAMETER);
  RTM::NVList_var configuration = manager->get_configuration();
  EXPECT_EQ(NVUtil::toString(configuration, "manager.components.precreate"), "X");

  EXPECT_EQ(manager->add_slave_manager(RTM::Manager::_nil()), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->remove_master_manager(manager), RTC::BAD_PARAMETER);
  RTM::ManagerList_var managers = manager->get_slave_managers();
  EXPECT_EQ(managers->length(), 0u);
  CORBA::Object_var service = manager->get_service("none");
  EXPECT_TRUE(CORBA::is_nil(service));
  EXPECT_EQ(manager->fork(), RTC::RTC_OK);
  EXPECT_EQ(manager->shutdown(), RTC::RTC_OK);
  EXPECT_EQ(rtcd.wait(), 0);
  EXPECT_TRUE(entries().empty());
}

TEST_F(Rtcd, a_slave_shows_its_components_at_the_master) {
  const int port = support::free_port();
  support::Process master(command({"-d", "-p", std::to_string(port)}));
  RTM::Manager_var manager = manager_at(port);
  support::Process slave(
      command({"-o", "corba.master_manager:127.0.0.1:" + std::to_string(port), "-o", "corba.update_master_manager.enable:YES", "-o",
               "corba.update_master_manager.interval:0.1", "-o", "manager.instance_name:slave", "FailOnRequest"}));
  const auto has_components = [&](CORBA::ULong count) {
    RTC::RTCList_var list = manager->get_components();
    return list->length() == count;
  };
  EXPECT_TRUE(eventually([&] { return has_components(1); })) << slave.output();
  EXPECT_EQ(slave.stop(), 0);
  EXPECT_TRUE(eventually([&] { return has_components(0); }));
  EXPECT_EQ(master.stop(), 0);
}

TEST_F(Rtcd, hostile_arguments_and_bytes_leave_it_as_it_was) {
  const int port = support::free_port();
  support::Process rtcd(command({"-d", "-p", std::to_string(port)}));
  RTM::Manager_var manager = manager_at(port);
  const std::string huge(std::size_t{1} << 19, 'x');  // two of them are within corba.max_request_size
  for (const auto& argument : {std::string(), std::string("?"), std::string("RTC:::::"), huge, "FailOnRequest?instance_name=" + huge,
                               std::string("FailOnRequest?instance_name="), std::string("FailOnRequest?=1"),
                               std::string("../../etc/passwd"), std::string("FailOnRequest?conf.default.fail_in=onInitialize")}) {
    RTC::RTObject_var made = manager->create_component(argument.c_str());
    EXPECT_TRUE(CORBA::is_nil(made)) << argument.substr(0, 60);
  }
  EXPECT_EQ(manager->delete_component(huge.c_str()), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->load_module(huge.c_str(), huge.c_str()), RTC::BAD_PARAMETER);
  EXPECT_EQ(manager->set_configuration(huge.c_str(), ""), RTC::BAD_PARAMETER);
  RTC::RTCList_var list = manager->get_components_by_name(huge.c_str());
  EXPECT_EQ(list->length(), 0u);

  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  ASSERT_EQ(connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const std::string garbage(std::size_t{1} << 16, '\xa5');
  EXPECT_GT(send(socket, garbage.data(), garbage.size(), MSG_NOSIGNAL), 0);
  close(socket);

  // The name of the one that failed is free; who asks for one that is there gets it.
  RTC::RTObject_var first = manager->create_component("FailOnRequest?instance_name=a.b/c");
  EXPECT_FALSE(CORBA::is_nil(first));
  RTC::RTObject_var second = manager->create_component("FailOnRequest?instance_name=a.b/c");
  ASSERT_FALSE(CORBA::is_nil(second));
  EXPECT_TRUE(first->_is_equivalent(second));
  EXPECT_EQ(entries(), (std::set<std::string>{"manager.mgr", "a\\.b\\/c.rtc"}));
  EXPECT_EQ(rtcd.stop(), 0) << rtcd.output();
}

TEST_F(Rtcd, ends_when_its_last_component_has_gone) {
  support::Process rtcd(command({"FailOnRequest"}));
  ASSERT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); })) << rtcd.output();
  RTC::RTObject_var only = component("FailOnRequest0.rtc");
  EXPECT_EQ(only->exit(), RTC::RTC_OK);
  EXPECT_EQ(rtcd.wait(), 0);
  EXPECT_TRUE(entries().empty());
}

TEST_F(Rtcd, without_components_ends_after_a_while_unless_it_is_a_master) {
  support::Process rtcd(command({"-o", "manager.auto_shutdown_duration:0.5"}));
  EXPECT_EQ(rtcd.wait(), 0);
}

TEST_F(Rtcd, says_what_is_wrong_in_a_file_with_its_line) {
  support::TemporaryFolder folder;
  const auto file = folder.path() / "my.conf";
  std::ofstream(file) << "# mine\nnaming.enable: NO\ncorba.nameserver: x\nnonsense\nexec_cxt.periodic.rate: fast\n"
                         "example.FailOnRequest.conf.default.how: throw\nexample.Special.config_file: special.conf\n";
  std::ofstream(folder.path() / "special.conf") << "conf.default.how: throw_number\nconf.default.fail_in: onInitialize\n";
  support::Process rtcd(
      {program, "-f", file, "-o", "manager.modules.load_path:" + modules, "FailOnRequest", "FailOnRequest?instance_name=Special"}, {},
      folder.path());
  EXPECT_EQ(rtcd.wait(), 1);  // Special fails, as its file wants
  const auto output = rtcd.output();
  EXPECT_NE(output.find("my.conf:3: unknown key \"corba.nameserver\", did you mean corba.nameservers?"), std::string::npos) << output;
  EXPECT_NE(output.find("my.conf:4: expected `key: value`"), std::string::npos) << output;
  EXPECT_NE(output.find("my.conf:5: exec_cxt.periodic.rate must be a number"), std::string::npos) << output;
  EXPECT_NE(output.find("component \"FailOnRequest?instance_name=Special\": its initialisation failed"), std::string::npos) << output;
}

TEST_F(Rtcd, wrong_command_lines_are_one_line_and_exit_code_2) {
  support::TemporaryFolder folder;
  for (const auto& bad : std::vector<std::vector<std::string>>{
           {"-p", "x"}, {"-f", (folder.path() / "missing").string()}, {"--bad"}, {"-o", "x"}, {"-o", "manager.is_master:perhaps"}}) {
    std::vector<std::string> words{program};
    words.insert(words.end(), bad.begin(), bad.end());
    support::Process rtcd(words);
    EXPECT_EQ(rtcd.wait(), 2) << bad.back();
    const auto output = rtcd.output();
    EXPECT_EQ(std::count(output.begin(), output.end(), '\n'), 1) << output;
  }
  support::Process busy(command({"-o", "corba.endpoints:" + names_.address()}));
  EXPECT_EQ(busy.wait(), 1);
}

TEST_F(Rtcd, brings_a_naming_service_along_and_takes_it_away_again) {
  for (const int ending : {SIGTERM, SIGKILL}) {
    const int port = support::free_port();
    support::Process rtcd({program, "-i", "-f", "none.conf", "--with-naming", "-o", "corba.nameservers:127.0.0.1:" + std::to_string(port),
                           "-o", "naming.formats:%n.rtc", "-o", "manager.modules.load_path:" + modules, "FailOnRequest"});
    const auto is_bound = [&] {
      auto root = corba::root_context(orb_->orb(), "127.0.0.1:" + std::to_string(port), 5s);
      if (!root) return false;
      try {
        CORBA::Object_var object = (*root)->resolve(*corba::parse_name("FailOnRequest0.rtc"));
        return true;
      } catch (const CORBA::Exception&) {
        return false;
      }
    };
    ASSERT_TRUE(eventually(is_bound)) << rtcd.output();
    rtcd.signal(ending);
    EXPECT_EQ(rtcd.wait(), ending == SIGTERM ? 0 : 128 + SIGKILL);
    EXPECT_TRUE(eventually([&] { return !support::is_listening(port); }));
  }
}

// It was started for others to create components in. A host without --with-naming, started later, ends.
TEST_F(Rtcd, a_naming_service_without_components_stays_until_it_is_told_to_end) {
  const int port = support::free_port();
  const auto words = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {program, "-i", "-f", "none.conf", "-o", "corba.nameservers:127.0.0.1:" + std::to_string(port), "-o",
                               "manager.auto_shutdown_duration:0.2"});
    return more;
  };
  support::Process rtcd(words({"--with-naming"}));
  ASSERT_TRUE(rtcd.wait_for_output("waiting for others to create them")) << rtcd.output();
  ASSERT_TRUE(eventually([&] { return support::is_listening(port); })) << rtcd.output();
  support::Process other(words({}));
  EXPECT_EQ(other.wait(), 0) << other.output();
  EXPECT_TRUE(support::is_listening(port));
  rtcd.signal(SIGTERM);
  EXPECT_EQ(rtcd.wait(), 0) << rtcd.output();
}

// Everything that it has made: omniNames, sockets, folders.
TEST_F(Rtcd, leaves_nothing_behind_whatever_ends_it) {
  struct Case {
    int signal;
    const char* component;
    int exit_code;
  };
  for (const auto& [signal, component, exit_code] :
       {Case{SIGTERM, "FailOnRequest", 0}, Case{SIGINT, "FailOnRequest", 0}, Case{SIGHUP, "FailOnRequest", 0}, Case{SIGTERM, "Hangs", 1}}) {
    support::TemporaryFolder folder;
    const int port = support::free_port();
    support::Process rtcd(
        {program, "-i", "-f", "none.conf", "--with-naming", "-o", "corba.nameservers:127.0.0.1:" + std::to_string(port), "-o",
         "manager.modules.load_path:" + modules, "-o", "manager.components.preactivation:" + std::string(component) + "0", component},
        {"TMPDIR=" + folder.path().string(), "XDG_RUNTIME_DIR=" + folder.path().string()});
    const auto files = [&] { return std::distance(std::filesystem::directory_iterator(folder.path()), {}); };
    if (std::string_view(component) == "Hangs") {
      ASSERT_TRUE(rtcd.wait_for_output("hanging")) << rtcd.output();
    } else {
      ASSERT_TRUE(eventually([&] { return support::is_listening(port) && files() == 2; })) << rtcd.output();
    }
    for (int i = 0; i < 2; ++i) rtcd.signal(signal);  // as `timeout` sends it
    EXPECT_EQ(rtcd.wait(), exit_code) << rtcd.output();
    EXPECT_TRUE(eventually([&] { return !support::is_listening(port) && files() == 0; })) << component << ' ' << signal;
  }
}

// As SIGTERM does: its terminal has been closed.
TEST_F(Rtcd, takes_its_names_back_when_its_terminal_goes_unless_started_by_nohup) {
  support::Process rtcd(command({"FailOnRequest"}));
  ASSERT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); })) << rtcd.output();
  rtcd.signal(SIGHUP);
  EXPECT_EQ(rtcd.wait(), 0) << rtcd.output();
  EXPECT_FALSE(has("FailOnRequest0.rtc"));

  auto words = command({"-p", std::to_string(support::free_port()), "FailOnRequest?instance_name=Kept"});
  words.insert(words.begin(), "nohup");
  support::Process kept(words);
  ASSERT_TRUE(eventually([&] { return has("Kept.rtc"); })) << kept.output();
  kept.signal(SIGHUP);
  RTC::RTObject_var still = component("Kept.rtc");
  EXPECT_EQ(CORBA_RTCUtil::activate(still), RTC::RTC_OK);
  EXPECT_EQ(CORBA_RTCUtil::deactivate(still), RTC::RTC_OK);
  EXPECT_TRUE(has("Kept.rtc")) << kept.output();
  EXPECT_EQ(kept.stop(), 0) << kept.output();
}

TEST_F(Rtcd, a_name_of_another_living_process_is_taken_with_a_warning_and_given_back_by_nobody_else) {
  support::Process first(command({"FailOnRequest"}));
  ASSERT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); }));
  support::Process second(command({"-o", "manager.instance_name:second", "FailOnRequest"}));
  EXPECT_TRUE(second.wait_for_output("belongs to another living object")) << second.output();
  EXPECT_TRUE(first.wait_for_output("it is left alone")) << first.output();
  EXPECT_EQ(first.stop(), 0);
  EXPECT_TRUE(has("FailOnRequest0.rtc"));
  EXPECT_EQ(second.stop(), 0);
  EXPECT_TRUE(entries().empty());
}

TEST_F(Rtcd, ns_unique_numbers_go_on_behind_those_of_other_processes) {
  support::Process first(command({"FailOnRequest"}));
  ASSERT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); }));
  support::Process second(
      command({"-o", "manager.instance_name:second", "-o", "manager.components.naming_policy:ns_unique", "FailOnRequest"}));
  EXPECT_TRUE(eventually([&] { return has("FailOnRequest1.rtc"); })) << second.output();
  EXPECT_EQ(second.stop(), 0);
  EXPECT_EQ(first.stop(), 0);
}

}  // namespace
}  // namespace manager_test
