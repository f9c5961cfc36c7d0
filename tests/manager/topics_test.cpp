// Ports that meet at a topic: of one process, of several, and of service ports. Each test has the process for itself in ctest.
#include <gtest/gtest.h>
#include <rtm/CORBA_RTCUtil.h>
#include <rtm/CorbaNaming.h>
#include <rtm/CorbaPort.h>
#include <rtm/Manager.h>
#include <rtm/NamingManager.h>

#include "manager/ported_fixture.h"
#include "manager/rtcd_fixture.h"

namespace manager_test {
namespace {

using namespace std::chrono_literals;

TEST(Topics, ports_of_one_process_are_connected) {
  Started manager({});
  ASSERT_EQ(manager.make("Ported?instance_name=A&port.outport.out.publish_topic=chatter"), "A");
  ASSERT_EQ(manager.make("Ported?instance_name=B&port.inport.in.subscribe_topic=chatter"), "B");
  ASSERT_EQ(manager.make("Ported?instance_name=C&port.inport.in.subscribe_topic=other,chatter"), "C");
  ASSERT_EQ(manager.make("Ported?instance_name=D&port.inport.in.subscribe_topic=other"), "D");
  const auto count = [&](const char* name, const char* port) {
    return CORBA_RTCUtil::get_connector_names(manager.reference(name), port).size();
  };
  EXPECT_EQ(count("A", "out"), 2u);
  EXPECT_EQ(count("B", "in"), 1u);
  EXPECT_EQ(count("C", "in"), 1u);
  EXPECT_EQ(count("D", "in"), 0u);
  EXPECT_EQ(count("B", "out"), 0u);
}

std::string numbered(const std::string& text, int count) {
  std::string list = text + "0";
  for (int i = 1; i < count; ++i) list += "," + text + std::to_string(i);
  return list;
}

TEST(Topics, a_port_has_at_most_64) {
  Started manager({});
  ASSERT_EQ(manager.make("Ported?instance_name=A&port.outport.out.publish_topic=" + numbered("t", 100)), "A");
  ASSERT_EQ(manager.make("Ported?instance_name=B&port.inport.in.subscribe_topic=t63"), "B");
  ASSERT_EQ(manager.make("Ported?instance_name=C&port.inport.in.subscribe_topic=t64"), "C");
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names(manager.reference("B"), "in").size(), 1u);
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names(manager.reference("C"), "in").size(), 0u);
}

TEST(Keys, naming_formats_gives_a_component_at_most_16_names) {
  Started manager({});
  ASSERT_EQ(manager.make("Ported?naming.enable=YES&naming.formats=" + numbered("n", 100)), "Ported0");
  EXPECT_EQ(manager->getComponent("Ported0")->getNamingNames().size(), 16u);
}

TEST(Topics, rtc_conf_names_topics_for_types_and_instances) {
  Started manager({"test.Ported.port.outport.out.publish_topic:chatter", "test.B.port.inport.in.subscribe_topic:chatter"});
  ASSERT_EQ(manager.make("Ported?instance_name=A"), "A");
  ASSERT_EQ(manager.make("Ported?instance_name=B"), "B");
  const auto names = CORBA_RTCUtil::get_connector_names(manager.reference("B"), "in");
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()), (std::set<std::string>{"A.out:B.in", "B.in:B.out"}));
}

TEST(Topics, ports_of_other_processes_are_found_on_the_naming_service_whoever_comes_first) {
  support::NamingService names;
  const auto command = [&](const std::string& component) {
    return std::vector<std::string>{program,  "-i",
                                    "-f",     "none.conf",
                                    "-o",     "corba.nameservers:" + names.address(),
                                    "-o",     "naming.formats:%n.rtc",
                                    "-o",     "manager.modules.load_path:" + modules,
                                    "-o",     "manager.naming_formats:%p.mgr",
                                    component};
  };
  support::Process first(command("SourceAll?instance_name=First&port.outport.long.publish_topic=numbers"));
  Started manager({"naming.enable:YES", "corba.nameservers:" + names.address(), "naming.formats:%n.rtc"});
  const auto is_bound = [&](const std::string& name) {
    CORBA::Object_var object = manager->getNaming()->resolve(name);
    return !CORBA::is_nil(object);
  };
  ASSERT_TRUE(eventually([&] { return is_bound("dataports.port_cxt/numbers.topic_cxt/First.long.outport"); })) << first.output();
  ASSERT_EQ(manager.make("Ported?port.inport.in.subscribe_topic=numbers&port.inport.in.connection_limit=9"), "Ported0");
  RTC::RTObject_var mine = manager.reference("Ported0");
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names(mine, "in"), coil::vstring{"First.long:Ported0.in"});
  EXPECT_TRUE(is_bound("dataports.port_cxt/numbers.topic_cxt/Ported0.in.inport"));
  support::Process later(command("SourceAll?instance_name=Later&port.outport.long.publish_topic=numbers"));
  EXPECT_TRUE(eventually([&] { return CORBA_RTCUtil::get_connector_names(mine, "in").size() == 2; })) << later.output();
  EXPECT_EQ(first.stop(), 0);
  EXPECT_FALSE(is_bound("dataports.port_cxt/numbers.topic_cxt/First.long.outport"));
  EXPECT_EQ(later.stop(), 0);
}

TEST(Topics, processes_that_start_together_make_one_connection) {
  support::NamingService names;
  for (int i = 0; i < 5; ++i) {
    std::vector<std::unique_ptr<support::Process>> processes;
    const auto start = [&](const std::string& component) {
      processes.push_back(std::make_unique<support::Process>(std::vector<std::string>{
          program, "-i", "-f", "none.conf", "-o", "corba.nameservers:" + names.address(), "-o", "naming.formats:%n.rtc", "-o",
          "manager.modules.load_path:" + modules, "-o", "manager.naming_formats:%p.mgr", component}));
    };
    start("SourceAll?instance_name=Source&port.outport.long.publish_topic=numbers");
    start("SinkAll?instance_name=Sink&port.inport.long.subscribe_topic=numbers");
    auto orb = corba::Orb::start({}).value();
    const auto connections = [&]() -> std::size_t {
      auto root = corba::root_context(orb->orb(), names.address(), 5s);
      try {
        CORBA::Object_var object = (*root)->resolve(*corba::parse_name("Sink.rtc"));
        RTC::RTObject_var sink = RTC::RTObject::_narrow(object);
        return CORBA_RTCUtil::get_connector_names(sink, "long").size();
      } catch (const CORBA::Exception&) {
        return 0;
      }
    };
    ASSERT_TRUE(eventually([&] { return connections() > 0; }));
    EXPECT_TRUE(eventually([&] { return connections() == 1; })) << processes[0]->output() << processes[1]->output();
    for (auto& process : processes) EXPECT_EQ(process->stop(), 0);
  }
}

TEST(Topics, managers_are_asked_when_they_do_the_naming) {
  const auto port = std::to_string(support::free_port());
  support::Process other({program, "-i", "-f", "none.conf", "-p", port, "-d", "-o", "naming.enable:NO", "-o",
                          "manager.modules.load_path:" + modules, "SourceAll?instance_name=Far&port.outport.long.publish_topic=numbers"});
  Started manager({"naming.enable:YES", "naming.type:manager", "corba.master_manager:127.0.0.1:" + port});
  ASSERT_TRUE(eventually([&] { return manager->getNaming()->string_to_component("Far").length() == 1; })) << other.output();
  ASSERT_EQ(manager.make("Ported?port.inport.in.subscribe_topic=numbers"), "Ported0");
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names(manager.reference("Ported0"), "in"), coil::vstring{"Far.long:Ported0.in"});
}

TEST(Topics, service_ports_meet_at_their_rendezvous_point) {
  Started manager({"manager.modules.load_path:" + modules});
  ASSERT_EQ(manager.make("EchoProvider?port.corbaport.Echo.rendezvous_point=here"), "EchoProvider0");
  ASSERT_EQ(manager.make("EchoConsumer?port.corbaport.Echo.rendezvous_point=here"), "EchoConsumer0");
  ASSERT_EQ(manager.make("EchoConsumer?port.corbaport.Echo.rendezvous_point=elsewhere"), "EchoConsumer1");
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names(manager.reference("EchoConsumer0"), "Echo").size(), 1u);
  EXPECT_EQ(CORBA_RTCUtil::get_connector_names(manager.reference("EchoConsumer1"), "Echo").size(), 0u);
}

}  // namespace
}  // namespace manager_test
