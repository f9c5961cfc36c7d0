#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include <filesystem>
#include <fstream>

#include "core/config_file.h"
#include "core/config_keys.h"
#include "core/manager_arguments.h"
#include "support/naming_service.h"

namespace rt {
namespace {

std::vector<ConfigEntry> entries_of(std::string_view text) { return parse_config(text).entries; }

// Empty if nothing is wrong.
std::string complaint_about(std::string_view key, std::string_view value) {
  const auto complaint = complain_about(key, value);
  return complaint ? complaint->text : std::string();
}

TEST(ConfigFile, keys_and_values_are_separated_by_colon_or_equals_sign) {
  EXPECT_EQ(entries_of("a.b: 1\nc = two words \n"), (std::vector<ConfigEntry>{{"a.b", "1", 1}, {"c", "two words", 2}}));
}

TEST(ConfigFile, later_separators_belong_to_the_value) {
  EXPECT_EQ(entries_of("x: a:1=2"), (std::vector<ConfigEntry>{{"x", "a:1=2", 1}}));
  EXPECT_EQ(entries_of("manager.components.preconnect: A0.out?port=B0.in&subscription_type=flush").front().value,
            "A0.out?port=B0.in&subscription_type=flush");
}

TEST(ConfigFile, comments_and_blank_lines_are_skipped) { EXPECT_TRUE(parse_config("# a: 1\n  ! b: 2\n\n \t\n").entries.empty()); }

TEST(ConfigFile, a_backslash_continues_the_line_and_findings_count_its_first) {
  EXPECT_EQ(entries_of("a: 1, \\\n   2, \\\n   3\nb: 4"), (std::vector<ConfigEntry>{{"a", "1, 2, 3", 1}, {"b", "4", 4}}));
  EXPECT_EQ(entries_of("a: c\\\\\nb: 2"), (std::vector<ConfigEntry>{{"a", "c\\", 1}, {"b", "2", 2}}));
}

TEST(ConfigFile, escapes_become_their_characters) { EXPECT_EQ(entries_of("a\\:b: x\\ty\\=z").front(), (ConfigEntry{"a:b", "x\ty=z", 1})); }

TEST(ConfigFile, what_is_no_setting_is_found_with_its_line) {
  const auto parsed = parse_config("good: 1\nnonsense\n: 3\na..b: 4\n");
  EXPECT_EQ(parsed.entries.size(), 1u);
  ASSERT_EQ(parsed.findings.size(), 3u);
  EXPECT_EQ(parsed.findings[0].line, 2);
  EXPECT_EQ(parsed.findings[1].line, 3);
  EXPECT_EQ(parsed.findings[2].line, 4);
}

TEST(ConfigFile, windows_line_ends_and_byte_order_marks_do_no_harm) {
  EXPECT_EQ(entries_of("\xef\xbb\xbf"
                       "a: 1\r\nb: 2\r\n"),
            (std::vector<ConfigEntry>{{"a", "1", 1}, {"b", "2", 2}}));
}

TEST(ConfigFile, a_missing_file_and_a_folder_are_named) {
  EXPECT_NE(read_text_file("/no/such/file").error().message.find("/no/such/file"), std::string::npos);
  EXPECT_NE(read_text_file("/tmp").error().message.find("folder"), std::string::npos);
}

TEST(ConfigFile, a_device_without_end_and_a_pipe_without_writer_hold_nobody_up) {
  EXPECT_NE(read_text_file("/dev/zero").error().message.find("larger than 16 MiB"), std::string::npos);
  EXPECT_EQ(read_text_file("/dev/null").value(), "");
  const auto pipe = std::filesystem::temp_directory_path() / ("config_test." + std::to_string(getpid()));
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(read_text_file(pipe.string()).value(), "");
  std::filesystem::remove(pipe);
}

TEST(ConfigKeys, known_keys_and_component_keys_draw_no_complaint) {
  for (const auto* key : {"corba.nameservers", "manager.modules.load_path", "port.inport.dataport.push_policy",
                          "example.ConsoleIn0.conf.default.x", "sdo.service.provider.enabled_services", "exec_cxt.periodic.rate"}) {
    EXPECT_EQ(complaint_about(key, ""), "");
  }
}

TEST(ConfigKeys, an_unknown_key_gets_a_suggestion) {
  EXPECT_EQ(complaint_about("corba.nameserver", "x"), "unknown key \"corba.nameserver\", did you mean corba.nameservers?");
  EXPECT_TRUE(complain_about("speed", "1").has_value());
}

TEST(ConfigKeys, a_malformed_value_is_named_with_what_is_used_instead) {
  EXPECT_EQ(complaint_about("naming.update.interval", "soon"),
            "naming.update.interval must be a number that is not negative, got \"soon\"; 10.0 is used");
  EXPECT_TRUE(complain_about("manager.is_master", "perhaps").has_value());
  EXPECT_TRUE(complain_about("logger.log_level", "LOUD").has_value());
  EXPECT_TRUE(complain_about("exec_cxt.periodic.rate", "nan").has_value());
}

TEST(ConfigKeys, every_kind_of_value_is_checked) {
  struct Case {
    const char* key;
    const char* good;
    const char* bad;
    const char* text;  // in the complaint
    bool takes_value;
  };
  for (const auto& [key, good, bad, text, takes_value] : std::initializer_list<Case>{
           {"naming.type", "corba, manager", "corba,dns", "must be of corba, manager, got \"corba,dns\"; corba is used", false},
           {"corba.endpoint_property", "ipv4,ipv6", "ipx", "must be of ipv4, ipv6", false},
           {"logger.clock_type", "logical", "sundial", "must be of system, logical, adjusted", false},
           {"corba.nameservers", "localhost,[::1]:2809,corbaloc::a:1/NameService", "a:2809,b:x", "must be host or host:port, got \"b:x\"",
            true},
           {"corba.master_manager", "localhost:2810", "a b", "must be host or host:port", true},
           {"manager.nameservers", "localhost:2810", "a:70000", "must be host or host:port", true},
           {"corba.alternate_iiop_addresses", "10.0.0.1:5555", "x:0", "must be host or host:port", true},
           {"manager.cpu_affinity", "0,1", "first", "must be numbers of processors", true},
           {"exec_cxt.cpu_affinity", "0", "-1", "must be numbers of processors", true},
           {"manager.components.precreate", "A, B?instance_name=x", "A,B?=1", "expected key=value", true},
           {"manager.components.preconnect", "A.x?port=B.y", "A.x?port=B.y,A.z", "expected port=", true},
           {"logger.log_level", "paranoid", "LOUD", "must be one of SILENT", false},
           {"manager.is_master", "on", "perhaps", "must be YES or NO", false},
           {"timer.tick", "0.01", "-1", "must be a number", false},
       }) {
    EXPECT_EQ(complaint_about(key, good), "");
    const auto complaint = complain_about(key, bad);
    ASSERT_TRUE(complaint.has_value()) << key;
    EXPECT_NE(complaint->text.find(text), std::string::npos) << complaint->text;
    EXPECT_TRUE(complaint->text.starts_with(key)) << complaint->text;
    EXPECT_EQ(complaint->takes_value, takes_value) << key;
  }
}

TEST(ConfigKeys, every_default_fits_its_kind) {
  for (const auto& key : config_keys()) {
    if (key.name.ends_with('*')) continue;
    EXPECT_EQ(complaint_about(key.name, key.default_value), "");
  }
}

TEST(ManagerArguments, options_may_be_joined_and_repeated) {
  const auto parsed = parse_manager_arguments({"-ad", "-f", "x.conf", "-oa.b:1", "-o", "c: d:e", "-p2810", "Module.so"});
  ASSERT_TRUE(parsed.ok());
  EXPECT_TRUE(parsed->without_servant);
  EXPECT_TRUE(parsed->is_master);
  EXPECT_EQ(parsed->config_file, "x.conf");
  EXPECT_EQ(parsed->port, 2810);
  EXPECT_EQ(parsed->overrides, (std::vector<std::pair<std::string, std::string>>{{"a.b", "1"}, {"c", "d:e"}}));
  EXPECT_EQ(parsed->rest, std::vector<std::string>{"Module.so"});
}

TEST(ManagerArguments, missing_and_wrong_values_are_errors) {
  for (const auto& bad :
       std::vector<std::vector<std::string>>{{"-f"}, {"-p", "x"}, {"-p", "70000"}, {"-p", "-1"}, {"-o", "novalue"}, {"-o"}, {"-o", ":x"}}) {
    EXPECT_FALSE(parse_manager_arguments(bad).ok()) << bad.front();
  }
}

TEST(ManagerArguments, strangers_are_kept_apart) {
  const auto parsed = parse_manager_arguments({"--verbose", "-x", "-ORBtraceLevel", "5", "--", "-a"});
  ASSERT_TRUE(parsed.ok());
  EXPECT_EQ(parsed->unknown, (std::vector<std::string>{"--verbose", "-x"}));
  EXPECT_EQ(parsed->orb_arguments, (std::vector<std::string>{"-ORBtraceLevel", "5"}));
  EXPECT_EQ(parsed->rest, std::vector<std::string>{"-a"});
}

}  // namespace
}  // namespace rt
