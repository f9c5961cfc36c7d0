#include <gtest/gtest.h>

#include "corba/orb/naming.h"
#include "core/component_argument.h"
#include "core/name_format.h"
#include "core/preconnect.h"

namespace rt {
namespace {

std::optional<std::string> sample(char c) {
  if (c == 'n') return "ConsoleIn0";
  if (c == 'h') return escape_name("my.host");
  return std::nullopt;
}

TEST(NameFormat, escapes_are_replaced_and_unknown_ones_stay) {
  EXPECT_EQ(expand_format("%h.host_cxt/%n.rtc", sample), "my\\.host.host_cxt/ConsoleIn0.rtc");
  EXPECT_EQ(expand_format("100%%%n %x %", sample), "100%ConsoleIn0 %x %");
}

TEST(NameFormat, environment_variables_are_replaced) {
  setenv("RTMSIM_TEST_NAME", "robot", 1);
  EXPECT_EQ(expand_format("${RTMSIM_TEST_NAME}/$(RTMSIM_TEST_NAME)$x${", sample), "robot/robot$x${");
}

TEST(NameFormat, the_number_of_an_instance_is_its_last_digits) {
  EXPECT_EQ(number_suffix("ConsoleIn12"), "12");
  EXPECT_EQ(number_suffix("A1B"), "");
  EXPECT_EQ(number_suffix("7"), "7");
}

TEST(ComponentArgument, forms_of_creation_are_understood) {
  EXPECT_EQ(parse_component_argument("ConsoleIn")->id, (ComponentId{"", "", "ConsoleIn", "", ""}));
  const auto full = parse_component_argument("RTC:AIST:example:ConsoleIn:C++:2.0?instance_name=a&conf.default.p=1=2");
  ASSERT_TRUE(full.ok());
  EXPECT_EQ(full->id, (ComponentId{"AIST", "example", "ConsoleIn", "C++", "2.0"}));
  EXPECT_EQ(full->properties, (std::vector<std::pair<std::string, std::string>>{{"instance_name", "a"}, {"conf.default.p", "1=2"}}));
  EXPECT_EQ(parse_component_argument("X?&instance_name=b")->properties.size(), 1u);
}

TEST(ComponentArgument, hostile_arguments_are_refused) {
  EXPECT_FALSE(parse_component_argument("").ok());
  EXPECT_FALSE(parse_component_argument("?a=b").ok());
  EXPECT_FALSE(parse_component_argument("RTC:a:b").ok());
  EXPECT_FALSE(parse_component_argument("RTC:::::").ok());
  EXPECT_FALSE(parse_component_argument("X?=1").ok());
  EXPECT_FALSE(parse_component_argument("X\n").ok() && parse_component_argument("X\x01Y").ok());
  EXPECT_FALSE(parse_component_argument(std::string(1 << 20, 'x')).ok());
  EXPECT_FALSE(parse_component_argument(std::string(2000, 'x')).ok());
  EXPECT_FALSE(check_instance_name("").ok());
  EXPECT_FALSE(check_instance_name(std::string(1 << 20, 'x')).ok());
}

TEST(ComponentArgument, empty_parts_match_anything) {
  const ComponentId offered{"AIST", "example", "X", "C++", "1.0"};
  EXPECT_TRUE(is_match({"", "", "X", "", ""}, offered));
  EXPECT_TRUE(is_match({"AIST", "", "X", "C++", ""}, offered));
  EXPECT_FALSE(is_match({"Other", "", "X", "", ""}, offered));
  EXPECT_FALSE(is_match({"", "", "Y", "", ""}, offered));
}

TEST(Preconnect, a_connection_has_ports_and_settings) {
  const auto request = parse_connection("A0.out?port=B0.in&port1=C0.in&dataflow_type=push&dataport.buffer.length=4");
  ASSERT_TRUE(request.ok());
  EXPECT_EQ(request->port, (PortAddress{"A0", "out"}));
  EXPECT_EQ(request->others, (std::vector<PortAddress>{{"B0", "in"}, {"C0", "in"}}));
  EXPECT_EQ(request->properties, (std::vector<std::pair<std::string, std::string>>{{"dataflow_type", "push"}, {"buffer.length", "4"}}));
  EXPECT_EQ(request->name, "A0.out?port=B0.in&port1=C0.in&dataflow_type=push&dataport.buffer.length=4");
}

TEST(Preconnect, addresses_of_other_processes_are_split_behind_the_last_slash) {
  EXPECT_EQ(*parse_port_address("rtcname://localhost:2809/my.host_cxt/A0.out"),
            (PortAddress{"rtcname://localhost:2809/my.host_cxt/A0", "out"}));
  EXPECT_EQ(*parse_port_address("Composite0.SeqIn0.Long"), (PortAddress{"Composite0", "SeqIn0.Long"}));
}

TEST(Preconnect, what_makes_no_connection_is_refused) {
  for (const auto* bad : {"", "A0", "A0.", ".out", "A0.out", "A0.out?x=1", "A0.out?port=B0", "A0.out?port"})
    EXPECT_FALSE(parse_connection(bad).ok()) << bad;
}

}  // namespace
}  // namespace rt

namespace corba {
namespace {

TEST(NamingName, the_text_form_survives_a_round_trip) {
  for (const auto* text : {"a", "a.b", "my\\.host.host_cxt/X0.rtc", "a\\/b.c\\\\d", "a/b/c.d", ".kind"}) {
    const auto name = parse_name(text);
    ASSERT_TRUE(name.ok()) << text;
    EXPECT_EQ(to_text(*name), text);
  }
}

TEST(NamingName, the_last_dot_separates_the_kind) {
  const auto name = parse_name("a.b.c");
  EXPECT_STREQ((*name)[0].id, "a.b");
  EXPECT_STREQ((*name)[0].kind, "c");
}

TEST(NamingName, empty_components_are_refused) {
  for (const auto* bad : {"", "/", "a//b", "/a", "a/"}) EXPECT_FALSE(parse_name(bad).ok()) << bad;
}

// By its name ::1 would be asked first, where another account can listen.
TEST(NamingUrl, localhost_is_where_servers_of_the_own_account_listen) {
  EXPECT_EQ(naming_url("localhost"), "corbaloc::127.0.0.1/NameService");
  EXPECT_EQ(naming_url(""), "corbaloc::127.0.0.1/NameService");
  EXPECT_EQ(naming_url("iiop:LocalHost:2898"), "corbaloc:iiop:127.0.0.1:2898/NameService");
  EXPECT_EQ(naming_url("ssliop:localhost:1"), "corbaloc:ssliop:127.0.0.1:1/NameService");
  EXPECT_EQ(naming_url("localhost.example"), "corbaloc::localhost.example/NameService");
  EXPECT_EQ(naming_url("[::1]:2809"), "corbaloc::[::1]:2809/NameService");
}

TEST(NamingUrl, addresses_become_corbaloc_urls) {
  EXPECT_EQ(naming_url(" host:2898 "), "corbaloc::host:2898/NameService");
  EXPECT_EQ(naming_url("corbaloc:iiop:h:1/X"), "corbaloc:iiop:h:1/X");
}

}  // namespace
}  // namespace corba
