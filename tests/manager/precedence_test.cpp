// Which of several settings counts: options over rtc.conf, lines over a component's file, instances over types, new spellings over old
// ones; and a log plug-in that rtc.conf names. Real processes.
#include <gtest/gtest.h>
#include <rtm/CORBA_RTCUtil.h>
#include <rtm/NVUtil.h>

#include <fstream>
#include <sstream>

#include "manager/rtcd_fixture.h"

namespace manager_test {
namespace {

class Precedence : public Rtcd {
 protected:
  // Writes a file into this test's folder.
  std::string file(const std::string& name, const std::string& text) const {
    const auto path = (folder_.path() / name).string();
    std::ofstream(path) << text;
    return path;
  }
  // An rtc.conf with what every rtcd here needs.
  std::string config(const std::string& text) const {
    return file("rtc.conf", "corba.nameservers: " + names_.address() + "\nnaming.formats: %n.rtc\nmanager.modules.load_path: " + modules +
                                "\ncorba.update_master_manager.enable: NO\n" + text);
  }
  static std::string setting(RTM::Manager_ptr manager, const char* key) {
    const RTM::NVList_var all = manager->get_configuration();
    return NVUtil::toString(all, key);
  }
  std::string property(const std::string& component_name, const std::string& key) const {
    const coil::Properties all = CORBA_RTCUtil::get_component_profile(component(component_name + ".rtc"));
    return all.getProperty(key);
  }

  support::TemporaryFolder folder_;
};

TEST_F(Precedence, options_win_over_the_file_wherever_they_stand) {
  const int port_of_file = support::free_port();
  const int port = support::free_port();
  const auto path = config(
      "manager.name: filed\nmanager.instance_name: kept\nmanager.is_master: NO\nlogger.log_level: ERROR\n"
      "corba.endpoints: 127.0.0.1:" +
      std::to_string(port_of_file) +
      "\nexec_cxt.periodic.rate: 40\nmanager.components.precreate: FailOnRequest?instance_name=Filed\n"
      "example.FailOnRequest.conf.default.how: throw\nmanager.os.hostname: elsewhere\n");
  support::Process rtcd({program, "-o", "manager.name:given", "-p", std::to_string(port), "-d", "-f", path, "-o",
                         "manager.components.precreate:FailOnRequest?instance_name=Given", "-o", "exec_cxt.periodic.rate:20", "-o",
                         "exec_cxt.periodic.rate:25", "-o", "example.FailOnRequest.conf.default.how:return"});
  const CORBA::Object_var object = orb_->orb()->string_to_object(("corbaloc:iiop:127.0.0.1:" + std::to_string(port) + "/given").c_str());
  ASSERT_TRUE(eventually([&] { return has("Given.rtc"); })) << rtcd.output();
  const RTM::Manager_var manager = RTM::Manager::_narrow(object);
  ASSERT_FALSE(CORBA::is_nil(manager)) << rtcd.output();
  EXPECT_TRUE(manager->is_master());
  EXPECT_EQ(setting(manager, "manager.name"), "given");
  EXPECT_EQ(setting(manager, "manager.instance_name"), "kept") << "what no option names comes from the file";
  EXPECT_EQ(setting(manager, "logger.log_level"), "ERROR");
  EXPECT_NE(setting(manager, "manager.os.hostname"), "elsewhere") << "facts win over the file";
  EXPECT_FALSE(support::is_listening(port_of_file));
  EXPECT_FALSE(has("Filed.rtc"));
  EXPECT_EQ(CORBA_RTCUtil::get_current_rate(component("Given.rtc"), 0), 25) << "of two options the later one";
  EXPECT_EQ(property("Given", "conf.default.how"), "return");
  EXPECT_EQ(rtcd.stop(), 0);

  support::Process silent({program, "-a", "-f", config("manager.corba_servant: YES\n"), "-p", std::to_string(port), "FailOnRequest"});
  ASSERT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); })) << silent.output();
  const CORBA::Object_var none = orb_->orb()->string_to_object(("corbaloc:iiop:127.0.0.1:" + std::to_string(port) + "/manager").c_str());
  EXPECT_THROW(none->_is_a("IDL:RTM/Manager:1.0"), CORBA::Exception) << "-a";
  EXPECT_EQ(silent.stop(), 0);
}

TEST_F(Precedence, the_file_of_an_option_wins_over_that_of_the_environment_and_that_over_the_folder) {
  const auto named = file("named.conf", "manager.name: environment\n");
  const auto given = file("given.conf", "manager.name: option\n");
  file("rtc.conf", "manager.name: folder\n");
  struct Case {
    std::vector<std::string> options;
    std::vector<std::string> environment;
    const char* name;
  };
  for (const auto& [options, environment, name] :
       {Case{{"-f", given}, {"RTC_MANAGER_CONFIG=" + named}, "option"}, Case{{}, {"RTC_MANAGER_CONFIG=" + named}, "environment"},
        Case{{}, {"RTC_MANAGER_CONFIG="}, "folder"}}) {
    const int port = support::free_port();
    std::vector<std::string> words{program, "-p", std::to_string(port), "-o", "naming.enable:NO"};
    words.insert(words.end(), options.begin(), options.end());
    support::Process rtcd(words, environment, folder_.path().string());
    const CORBA::Object_var object =
        orb_->orb()->string_to_object(("corbaloc:iiop:127.0.0.1:" + std::to_string(port) + "/" + name).c_str());
    EXPECT_TRUE(eventually([&] {
      try {
        return static_cast<bool>(object->_is_a("IDL:RTM/Manager:1.0"));
      } catch (const CORBA::Exception&) {
        return false;
      }
    })) << name
        << rtcd.output();
    EXPECT_EQ(rtcd.stop(), 0);
  }
}

TEST_F(Precedence, a_file_of_the_environment_that_is_not_there_is_a_warning) {
  const std::string missing = (folder_.path() / "missing.conf").string();
  const std::vector<std::string> environment = {"RTC_MANAGER_CONFIG=" + missing};
  config("manager.components.precreate: FailOnRequest\n");
  {
    support::Process rtcd({program, "-a"}, environment, folder_.path().string());
    EXPECT_TRUE(rtcd.wait_for_output("RTC_MANAGER_CONFIG: file \"" + missing + "\": does not exist")) << rtcd.output();
    EXPECT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); })) << "the next place counts: " << rtcd.output();
    EXPECT_EQ(rtcd.stop(), 0) << rtcd.output();
  }
  support::Process rtcd({program, "-a", "-f", "rtc.conf"}, environment, folder_.path().string());
  EXPECT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); })) << rtcd.output();
  EXPECT_EQ(rtcd.stop(), 0) << rtcd.output();
  EXPECT_EQ(rtcd.output().find("RTC_MANAGER_CONFIG"), std::string::npos) << "-f comes first: " << rtcd.output();
}

TEST_F(Precedence, lines_win_over_a_component_s_file_and_instances_over_types) {
  const auto of_type = file("type.conf",
                            "conf.default.how: throw\nconf.default.fail_in: onError\nmy.a: type file\nmy.b: type file\n"
                            "my.c: type file\nmy.d: type file\nexec_cxt.periodic.rate: 11\n");
  const auto of_instance = file("instance.conf", "my.c: instance file\nmy.d: instance file\nexec_cxt.periodic.rate: 13\n");
  const auto path = config("example.FailOnRequest.config_file: " + of_type +
                           "\nexample.FailOnRequest.my.b: type line\nexample.FailOnRequest.conf.default.how: return\n"
                           "example.Special.config_file: " +
                           of_instance +
                           "\nexample.Special.my.d: instance line\n"
                           "manager.components.precreate: FailOnRequest?instance_name=Plain, FailOnRequest?instance_name=Special,"
                           "FailOnRequest?instance_name=Asked&my.b=argument&exec_cxt.periodic.rate=17\n");
  support::Process rtcd({program, "-f", path});
  ASSERT_TRUE(eventually([&] { return has("Plain.rtc") && has("Special.rtc") && has("Asked.rtc"); })) << rtcd.output();
  for (const auto& [name, a, b, c, d, rate] : {std::tuple("Plain", "type file", "type line", "type file", "type file", 11),
                                               std::tuple("Special", "type file", "type line", "instance file", "instance line", 13),
                                               std::tuple("Asked", "type file", "argument", "type file", "type file", 17)}) {
    EXPECT_EQ(property(name, "my.a"), a) << name;
    EXPECT_EQ(property(name, "my.b"), b) << name;
    EXPECT_EQ(property(name, "my.c"), c) << name;
    EXPECT_EQ(property(name, "my.d"), d) << name;
    EXPECT_EQ(property(name, "conf.default.how"), "return") << name;
    EXPECT_EQ(property(name, "conf.default.fail_in"), "onError") << name;
    EXPECT_EQ(CORBA_RTCUtil::get_current_rate(component(std::string(name) + ".rtc"), 0), rate) << name;
  }
  EXPECT_EQ(rtcd.stop(), 0);
}

TEST_F(Precedence, the_manager_s_spelling_of_update_master_manager_wins_over_the_orb_s) {
  const int port = support::free_port();
  const auto slave = [&](const std::string& name, const std::vector<std::string>& settings) {
    std::vector<std::string> words{"-o", "corba.master_manager:127.0.0.1:" + std::to_string(port), "-o", "manager.instance_name:" + name,
                                   "FailOnRequest?instance_name=" + name};
    for (const auto& setting : settings) words.insert(words.end(), {"-o", setting});
    return std::make_unique<support::Process>(command(words));
  };
  const auto mute = slave("Mute", {"corba.update_master_manager.enable:YES", "corba.update_master_manager.interval:0.1",
                                   "manager.update_master_manager.enable:NO", "manager.update_master_manager.interval:0.1"});
  const auto keen = slave("Keen", {"corba.update_master_manager.enable:NO", "corba.update_master_manager.interval:1000",
                                   "manager.update_master_manager.enable:YES", "manager.update_master_manager.interval:0.1"});
  ASSERT_TRUE(eventually([&] { return has("Mute.rtc") && has("Keen.rtc"); })) << mute->output() << keen->output();
  // The master comes when they have tried already.
  support::Process master(command({"-d", "-p", std::to_string(port)}));
  const RTM::Manager_var manager = manager_at(port);
  ASSERT_FALSE(CORBA::is_nil(manager)) << master.output();
  const auto slaves = [&] {
    std::set<std::string> found;
    RTM::ManagerList_var list = manager->get_slave_managers();
    for (CORBA::ULong i = 0; i < list->length(); ++i) {
      const RTM::ManagerProfile_var profile = list[i]->get_profile();
      found.insert(NVUtil::toString(profile->properties, "instance_name"));
    }
    return found;
  };
  EXPECT_TRUE(eventually([&] { return slaves().contains("Keen"); })) << keen->output();
  EXPECT_EQ(slaves(), std::set<std::string>{"Keen"});
  EXPECT_EQ(keen->stop(), 0);
  EXPECT_EQ(mute->stop(), 0);
  EXPECT_EQ(master.stop(), 0);
}

TEST_F(Precedence, a_log_plugin_that_rtc_conf_names_gets_the_lines) {
  const auto lines = (folder_.path() / "lines").string();
  const auto log_of = [&](const std::string& settings) {
    support::Process rtcd({program, "-f",
                           config("logger.file_name: none\nlogger.log_level: INFO\nlogger.plugins: Postbox.so\n" + settings +
                                  "manager.components.precreate: FailOnRequest, NoSuchType\n")});
    EXPECT_TRUE(eventually([&] { return has("FailOnRequest0.rtc"); })) << rtcd.output();
    EXPECT_EQ(rtcd.stop(), 0) << rtcd.output();
    std::ostringstream text;
    text << std::ifstream(lines).rdbuf();
    std::filesystem::remove(lines);
    return text.str();
  };
  const auto text = log_of("logger.logstream.postbox.file: " + lines + "\n");
  EXPECT_NE(text.find("ERROR|manager|"), std::string::npos) << text;
  EXPECT_NE(text.find("NoSuchType"), std::string::npos) << text;
  EXPECT_EQ(log_of(""), "") << "a plug-in without settings is not used";
}

}  // namespace
}  // namespace manager_test
