#include "system/address.h"

#include <gtest/gtest.h>

namespace tools {
namespace {

Address address(const std::string& text, const std::string& working = "") {
  auto parsed = parse_address(text, working);
  EXPECT_TRUE(parsed.ok()) << text;
  return parsed ? *parsed : Address{};
}

TEST(Address, absolute_paths_start_with_the_name_server) {
  const auto a = address("/localhost:2898/a.host_cxt/Laser0.rtc:range");
  EXPECT_TRUE(a.is_absolute);
  EXPECT_EQ(a.segments, (std::vector<std::string>{"localhost:2898", "a.host_cxt", "Laser0.rtc"}));
  EXPECT_EQ(a.port, "range");
  EXPECT_EQ(a.text(), "/localhost:2898/a.host_cxt/Laser0.rtc:range");
}

TEST(Address, a_colon_in_the_only_segment_of_an_absolute_path_belongs_to_the_server) {
  for (const auto text : {"/127.0.0.1:2898", "/127.0.0.1:2898/"}) {
    EXPECT_EQ(address(text).segments, std::vector<std::string>{"127.0.0.1:2898"}) << text;
    EXPECT_EQ(address(text).port, "") << text;
  }
}

TEST(Address, a_server_without_slashes_is_no_component_with_a_port) {
  const auto a = address("127.0.0.1:2898");
  EXPECT_TRUE(a.is_absolute);
  EXPECT_EQ(a.segments, std::vector<std::string>{"127.0.0.1:2898"});
  EXPECT_EQ(address("Laser0.rtc:2898").port, "2898");
  EXPECT_EQ(address("Laser0:12").port, "12");
}

TEST(Address, tails_name_a_component_and_its_port) {
  const auto a = address("Laser0:range");
  EXPECT_FALSE(a.is_absolute);
  EXPECT_EQ(a.segments, std::vector<std::string>{"Laser0"});
  EXPECT_EQ(a.port, "range");
}

TEST(Address, dots_step_from_the_working_path) {
  EXPECT_EQ(address("./A0.rtc", "/localhost/b.host_cxt").segments, (std::vector<std::string>{"localhost", "b.host_cxt", "A0.rtc"}));
  EXPECT_EQ(address("../c.host_cxt/A0.rtc", "/localhost/b.host_cxt").segments,
            (std::vector<std::string>{"localhost", "c.host_cxt", "A0.rtc"}));
  EXPECT_EQ(address("", "/localhost").segments, std::vector<std::string>{"localhost"});
}

TEST(Address, a_name_alone_is_looked_for_everywhere_even_with_a_working_path) {
  EXPECT_FALSE(address("Laser0:range", "/localhost").is_absolute);
}

TEST(Address, missing_parts_are_errors) {
  EXPECT_FALSE(parse_address("Laser0:", "").ok());
  EXPECT_FALSE(parse_address(":range", "").ok());
}

TEST(Address, segments_match_with_and_without_their_kind) {
  EXPECT_TRUE(matches("Laser0", "Laser0", "rtc"));
  EXPECT_TRUE(matches("Laser0.rtc", "Laser0", "rtc"));
  EXPECT_FALSE(matches("Laser0.mgr", "Laser0", "rtc"));
  EXPECT_TRUE(matches("my.robot.host_cxt", "my.robot", "host_cxt"));
  EXPECT_TRUE(matches("my\\.robot.host_cxt", "my.robot", "host_cxt"));
}

TEST(Address, names_are_escaped_and_split_again) {
  EXPECT_EQ(escape_name("a.b/c\\d"), "a\\.b\\/c\\\\d");
  EXPECT_EQ(split_kind("a\\.b.rtc"), (std::pair<std::string, std::string>{"a.b", "rtc"}));
}

}  // namespace
}  // namespace tools
