#include "rtse/skeleton/specification.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "rtse/skeleton/idl_operations.h"

namespace tools {
namespace {

NewComponent follower() {
  NewComponent component;
  component.name = "Follower";
  component.in_ports = {{"range", "RTC::RangeData"}};
  component.out_ports = {{"velocity", "RTC::TimedVelocity2D"}};
  component.parameters = {{"gain", "double", "0.5"}};
  return component;
}

TEST(Skeleton, has_ports_parameters_and_the_headers_of_their_types) {
  const auto files = skeleton(follower());
  ASSERT_TRUE(files.ok()) << files.error().message;
  const auto& header = files->at("include/Follower.h");
  EXPECT_NE(header.find("RTC::InPort<RTC::RangeData> m_rangeIn"), std::string::npos);
  EXPECT_NE(header.find("rtm/idl/InterfaceDataTypesSkel.h"), std::string::npos);
  EXPECT_NE(header.find("rtm/idl/ExtendedDataTypesSkel.h"), std::string::npos);
  EXPECT_NE(files->at("src/Follower.cpp").find("bindParameter(\"gain\", m_gain, \"0.5\")"), std::string::npos);
}

TEST(Skeleton, names_that_cannot_be_compiled_are_refused) {
  auto component = follower();
  component.name = "1st robot";
  EXPECT_FALSE(check(component).ok());
  component = follower();
  component.out_ports.push_back({"range", "RTC::TimedLong"});
  const auto twice = check(component);
  ASSERT_FALSE(twice.ok());
  EXPECT_NE(twice.error().message.find("range"), std::string::npos);
  component = follower();
  component.parameters[0].type = "int; system(\"x\")";
  EXPECT_FALSE(check(component).ok());
}

TEST(Skeleton, a_specification_of_rtc_builder_is_read) {
  const auto file = std::filesystem::path(testing::TempDir()) / "skeleton_test_RTC.xml";
  std::ofstream(file) << R"(<?xml version="1.0"?>
<rtc:RtcProfile rtc:version="0.2" xmlns:rtc="http://www.openrtp.org/namespaces/rtc">
  <rtc:BasicInfo rtc:name="Mover" rtc:version="1.2.0" rtc:vendor="V" rtc:category="C" rtc:description="d" rtc:executionRate="20.0"/>
  <rtc:ConfigurationSet><rtc:Configuration rtc:name="speed" rtc:type="double" rtc:defaultValue="0.1"/></rtc:ConfigurationSet>
  <rtc:DataPorts rtc:portType="DataInPort" rtc:name="in" rtc:type="RTC::TimedLong"/>
  <rtc:DataPorts rtc:portType="DataOutPort" rtc:name="out" rtc:type="RTC::TimedVelocity2D"/>
</rtc:RtcProfile>)";
  const auto component = read_specification(file.string());
  std::filesystem::remove(file);
  ASSERT_TRUE(component.ok()) << component.error().message;
  EXPECT_EQ(component->name, "Mover");
  EXPECT_EQ(component->rate, 20);
  EXPECT_EQ(component->in_ports.at(0).type, "RTC::TimedLong");
  EXPECT_EQ(component->out_ports.at(0).name, "out");
  EXPECT_EQ(component->parameters.at(0).default_value, "0.1");
}

// A folder with files for one test.
class Folder {
 public:
  Folder() : path_(std::filesystem::path(testing::TempDir()) / ("skeleton_test_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return (path_ / name).string();
  }

 private:
  std::filesystem::path path_;
};

std::string refusal(const NewComponent& component) {
  const auto checked = check(component);
  return checked ? "" : checked.error().message;
}

TEST(Skeleton, interfaces_are_found_with_their_modules) {
  const auto found = interfaces_in(R"(
#include "module.idl"
// interface Comment {
module A { /* interface Other { }; */
  interface Forward;
  struct Point { long x; };
  interface First { enum Colour { red }; void get(in string text); };
  module B { local interface Second : First { const string name = "interface Text {"; }; };
  valuetype V { };
};
interface Global { };
)");
  EXPECT_EQ(found, (std::vector<std::string>{"A::First", "A::B::Second", "Global"}));
}

TEST(Skeleton, a_specification_of_rtc_builder_may_leave_the_rate_open) {
  const auto file = std::filesystem::path(testing::TempDir()) / "skeleton_test_rate.xml";
  const auto rate = [&](const std::string& attribute) {
    std::ofstream(file)
        << R"(<rtc:RtcProfile rtc:version="0.2" xmlns:rtc="http://www.openrtp.org/namespaces/rtc"><rtc:BasicInfo rtc:name="Open")"
        << attribute << "/></rtc:RtcProfile>";
    const auto component = read_specification(file.string());
    EXPECT_TRUE(component.ok()) << component.error().message;
    return component.ok() ? component->rate : -1;
  };
  for (const char* open : {"", R"( rtc:executionRate="")", R"( rtc:executionRate="0.0")"}) EXPECT_EQ(rate(open), 100) << open;
  EXPECT_EQ(rate(R"( rtc:executionRate="1000.0")"), 1000);
  std::filesystem::remove(file);
}

// As RTCBuilder wrote them on another system: a device template.
TEST(Skeleton, a_template_of_rtc_builder_may_leave_out_modules_and_instances) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "skeleton_test_template";
  std::filesystem::create_directories(folder / "idl");
  const auto file = folder / "RTC.xml";
  std::ofstream(folder / "idl" / "Ranger.idl") << "module Dev { interface Ranger { void start(); }; };\n";
  std::ofstream(folder / "idl" / "Two.idl") << "module A { interface Two { }; };\nmodule B { interface Two { }; };\n";
  const auto specification = [&](const std::string& type, const std::string& idl) {
    std::ofstream(file) << R"(<rtc:RtcProfile rtc:version="0.2" xmlns:rtc="http://www.openrtp.org/namespaces/rtc">
  <rtc:BasicInfo rtc:name="Ranging" rtc:executionRate="1.0"/>
  <rtc:ServicePorts rtc:name="ranger">
    <rtc:ServiceInterface rtc:name="Ranger" rtc:type=")"
                        << type << R"(" rtc:instanceName="" rtc:direction="Provided" rtc:idlFile=")" << idl << R"("/>
    <rtc:ServiceInterface rtc:name="other" rtc:type=")"
                        << type << R"(" rtc:instanceName="" rtc:direction="Required" rtc:idlFile=")" << idl << R"("/>
  </rtc:ServicePorts></rtc:RtcProfile>)";
    const auto component = read_specification(file.string());
    EXPECT_TRUE(component.ok()) << component.error().message;
    return component.ok() ? skeleton(*component) : component.error();
  };
  for (const std::string idl : {"idl\\Ranger.idl", "C:\\work\\device\\Ranger.idl", "idl/Ranger.idl"}) {
    const auto files = specification("Ranger", idl);
    ASSERT_TRUE(files.ok()) << files.error().message;
    EXPECT_NE(files->at("src/Ranging.cpp").find(R"(m_rangerPort.registerProvider("ranger", "Dev::Ranger", m_ranger))"), std::string::npos);
    EXPECT_NE(files->at("src/Ranging.cpp").find(R"(registerConsumer("Ranger", "Dev::Ranger", m_Ranger))"), std::string::npos);
    EXPECT_NE(files->at("include/RangerSVC_impl.h").find("POA_Dev::Ranger"), std::string::npos);
  }
  const auto ambiguous = specification("Two", "idl/Two.idl");
  ASSERT_FALSE(ambiguous.ok());
  EXPECT_NE(ambiguous.error().message.find("A::Two, B::Two"), std::string::npos) << ambiguous.error().message;
  std::filesystem::remove_all(folder);
}

TEST(Skeleton, names_that_meet_in_the_code_or_are_taken_are_refused) {
  auto component = follower();
  component.parameters = {{"rangeIn", "int", "0"}};
  EXPECT_NE(refusal(component).find("m_rangeIn"), std::string::npos) << refusal(component);
  for (const char* name : {"static_cast", "test", "std", "co_await", "_x", "a__b"}) {
    component = follower();
    component.name = name;
    EXPECT_NE(refusal(component), "") << name;
  }
  component = follower();
  component.in_ports = {{"long", "RTC::TimedLong"}};  // a member m_long, which is fine
  EXPECT_EQ(refusal(component), "");
}

TEST(Skeleton, a_description_stays_in_its_comment) {
  auto component = follower();
  component.description = "one\ntwo \\";
  const auto files = skeleton(component);
  ASSERT_TRUE(files.ok()) << files.error().message;
  EXPECT_TRUE(files->at("include/Follower.h").starts_with("// one two\n#ifndef")) << files->at("include/Follower.h").substr(0, 40);
}

TEST(Skeleton, a_service_port_has_several_interfaces_and_an_idl_file_several_services) {
  const Folder folder;
  const auto idl = folder.write(
      "Two.idl", "#include \"Base.idl\"\nmodule M { interface A { Base::T get(); }; interface B { void put(in long x); }; };\n");
  folder.write("Base.idl", "module Base { struct T { long a; string b; }; };\n");
  auto component = follower();
  component.services = {{"port", "M::A", idl, true, "a"}, {"port", "M::B", idl, true, "b"}, {"other", "M::B", idl, false, "c"}};
  const auto files = skeleton(component);
  ASSERT_TRUE(files.ok()) << files.error().message;
  EXPECT_TRUE(files->contains("idl/Two.idl") && files->contains("idl/Base.idl"));
  const auto& implementation = files->at("include/TwoSVC_impl.h");
  EXPECT_NE(implementation.find("class ASVC_impl"), std::string::npos) << implementation;
  EXPECT_NE(implementation.find("class BSVC_impl"), std::string::npos) << implementation;
  EXPECT_NE(implementation.find("  Base::T* get() override"), std::string::npos) << implementation;
  const auto& source = files->at("src/Follower.cpp");
  EXPECT_EQ(source.find("addPort(m_portPort)"), source.rfind("addPort(m_portPort)")) << source;
  const auto& cmake = files->at("CMakeLists.txt");
  EXPECT_NE(cmake.find("idl/Base.idl)"), std::string::npos) << cmake;
  EXPECT_EQ(cmake.find(std::filesystem::path(idl).parent_path().string()), std::string::npos) << cmake;
}

TEST(Skeleton, data_types_of_the_users_own_come_with_an_idl_file) {
  auto component = follower();
  component.in_ports = {{"blob", "My::Blob"}};
  EXPECT_NE(refusal(component).find("--idl"), std::string::npos) << refusal(component);
  const Folder folder;
  component.idl_files = {folder.write("Mine.idl", "#include \"BasicDataType.idl\"\nmodule My { struct Blob { RTC::Time tm; }; };\n")};
  const auto files = skeleton(component);
  ASSERT_TRUE(files.ok()) << files.error().message;
  EXPECT_NE(files->at("include/Follower.h").find("#include \"MineSkel.h\""), std::string::npos);
  component.in_ports = {{"blob", "My::Bulb"}};
  EXPECT_NE(refusal(component), "");
}

TEST(Skeleton, actions_and_widgets_of_rtc_builder_are_kept) {
  const Folder folder;
  const auto file = folder.write("RTC.xml", R"(<rtc:RtcProfile xmlns:rtc="r" xmlns:rtcExt="e">
  <rtc:BasicInfo rtc:name="Mover" rtc:executionRate="20.0"/>
  <rtc:Actions><rtc:OnReset rtc:implemented="true"/><rtc:OnError rtc:implemented="false"/><rtc:OnExecute rtc:implemented="true"/></rtc:Actions>
  <rtc:ConfigurationSet><rtc:Configuration rtc:name="k" rtc:type="string" rtc:defaultValue="a">
    <rtcExt:Properties rtcExt:value="slider" rtcExt:name="__widget__"/></rtc:Configuration></rtc:ConfigurationSet>
</rtc:RtcProfile>)");
  const auto component = read_specification(file);
  ASSERT_TRUE(component.ok()) << component.error().message;
  EXPECT_EQ(component->actions, std::vector<std::string>{"onReset"});
  const auto files = skeleton(*component);
  ASSERT_TRUE(files.ok()) << files.error().message;
  EXPECT_NE(files->at("src/Mover.cpp").find("Mover::onReset(RTC::UniqueId"), std::string::npos);
  EXPECT_NE(files->at("src/Mover.cpp").find("\"conf.__widget__.k\", \"slider\""), std::string::npos);
  EXPECT_NE(files->at("include/Mover.h").find("std::string m_k;"), std::string::npos);
}

TEST(Skeleton, a_specification_in_yaml_says_where_it_is_not_understood) {
  const Folder folder;
  const auto problem = [&](const std::string& text) {
    const auto read = read_specification(folder.write("spec.yaml", text));
    return read ? std::string() : read.error().message;
  };
  EXPECT_NE(problem("name: X\nin_ports: 5\n").find("spec.yaml\":2: in_ports must be a list"), std::string::npos);
  EXPECT_NE(problem("name: X\nin_ports:\n  - {name: a, typ: TimedLong}\n").find("3: unknown key \"typ\""), std::string::npos);
  EXPECT_NE(problem("name: X\nrate: fast\n").find("2: rate must be a number"), std::string::npos);
  EXPECT_NE(problem("name: X\nservices: [{port: s, direction: both}]\n").find("provided or required"), std::string::npos);
}

}  // namespace
}  // namespace tools
