#include "skeleton.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace editor {
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

}  // namespace
}  // namespace editor
