#include "run/run_options.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "base/command.h"
#include "base/command_line.h"

namespace tools {
namespace {

using Json = nlohmann::ordered_json;

RunOptions all_different() {
  RunOptions options;
  options.system = "/s.xml";
  options.world = "/w.sdf";
  options.duration_s = 12.5;
  options.expectations = "/e.yaml";
  options.seed = 123456789012345678;
  options.one_process_each = options.in_real_time = options.twice = options.strict = true;
  options.start = {"./alien --port 5", "two\nlines"};
  options.rolling = "off";
  options.start_folder = "/f";
  options.run_file = "/r.yaml";
  options.lists = {"robot=a,b"};
  options.hosts = 3;
  options.module_paths = {"/m1", "/m2"};
  options.resource_paths = {"/res"};
  options.properties = {"A0:exec_cxt.sim_time.phase=3", "B0:text=a \"quoted\" word"};
  options.hang_timeout_s = 7.25;
  options.start_timeout_s = 90;
  options.junit = "/j.xml";
  options.picture = "/p.png";
  options.record = "/run.mcap";
  options.record_last_s = 5;
  options.page = "/p.html";
  options.page_camera_rate = 2.5;
  options.page_limit_mib = 8;
  options.hash_log = "/h";
  options.hash_period_s = 0.001;
  options.keep = "/k";
  return options;
}

std::string refusal(const Json& json) {
  const auto read = run_options_from(json);
  return read ? "" : read.error().message;
}

TEST(RunOptions, survive_the_way_to_JSON_and_back) {
  for (const auto& options : {RunOptions(), all_different()}) {
    const auto text = to_json(options, RunOptionSet::all).dump();
    const auto read = parse_run_options(text);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_TRUE(*read == options) << text;
  }
}

TEST(RunOptions, every_one_has_a_row_in_the_table) {
  const auto plain = to_json(RunOptions(), RunOptionSet::all), changed = to_json(all_different(), RunOptionSet::all);
  EXPECT_EQ(plain.size(), run_option_rows.size());
  for (const auto& [key, value] : changed.items()) EXPECT_NE(value, plain[key]) << key << ": all_different() leaves it as it is";
}

TEST(RunOptions, those_that_repeat_a_run_are_in_a_recording_and_others_are_not) {
  const auto json = to_json(all_different(), RunOptionSet::repeats_run);
  std::set<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.insert(key);
  EXPECT_EQ(keys, (std::set<std::string>{"duration", "seed", "one_process_each", "rolling", "start", "start_folder", "run_file",
                                         "module_path", "resource_path", "property", "hosts"}));
  const auto read = recorded_run_options({{"options", json.dump()}, {"world_file", "/w.sdf"}});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->start, all_different().start);
  EXPECT_EQ(read->keep, "");
}

TEST(RunOptions, a_recording_from_before_the_rolling_step_is_repeated_without_it) {
  auto json = to_json(RunOptions(), RunOptionSet::repeats_run);
  EXPECT_EQ(recorded_run_options({{"options", json.dump()}})->rolling, "on");
  json.erase("rolling");
  EXPECT_EQ(recorded_run_options({{"options", json.dump()}})->rolling, "off");
}

TEST(RunOptions, relative_paths_are_absolute_for_the_reader) {
  RunOptions options;
  options.module_paths = {"modules"};
  const auto json = to_json(options, RunOptionSet::repeats_run);
  EXPECT_EQ(json["module_path"][0], (std::filesystem::current_path() / "modules").string());
  EXPECT_EQ(json["run_file"], "") << "none stays none";
}

// As `rtse run --record` wrote it before all options were one text.
TEST(RunOptions, the_texts_of_older_recordings_are_read) {
  const auto read = recorded_run_options({{"clock", "simulated"},
                                          {"duration", "12.5"},
                                          {"lockstep", "yes"},
                                          {"module_paths", "/m1\n/m2"},
                                          {"one_process_each", "yes"},
                                          {"others", "Alien0"},
                                          {"properties", "A0:gain=2\nB0:gain=3"},
                                          {"resource_paths", ""},
                                          {"run_file", ""},
                                          {"script", "no"},
                                          {"seed", "18"},
                                          {"simulator", "1.0"},
                                          {"start", "./alien --fast"},
                                          {"start_folder", "/home/u"},
                                          {"step_ns", "1000000"},
                                          {"version", "1.0"},
                                          {"world", "w"},
                                          {"world_file", "/w.sdf"}});
  ASSERT_TRUE(read) << read.error().message;
  RunOptions expected;
  expected.duration_s = 12.5;
  expected.module_paths = {"/m1", "/m2"};
  expected.one_process_each = true;
  expected.properties = {"A0:gain=2", "B0:gain=3"};
  expected.seed = 18;
  expected.start = {"./alien --fast"};
  expected.start_folder = "/home/u";
  expected.rolling = "off";
  EXPECT_TRUE(*read == expected);
  EXPECT_FALSE(recorded_run_options({{"duration", "long"}}));
}

TEST(RunOptions, what_is_unknown_or_beyond_its_limits_is_refused_by_name) {
  EXPECT_EQ(refusal(Json::array()), "options of a run: expected a JSON object, got []");
  EXPECT_EQ(refusal({{"speed", 3}}), "options of a run: unknown option \"speed\"");
  EXPECT_EQ(refusal({{"duration", 1e8}}), "options of a run: duration must be from 0.001 to 1e+07, got 100000000.0");
  EXPECT_EQ(refusal({{"duration", "60"}}), "options of a run: duration must be from 0.001 to 1e+07, got \"60\"");
  EXPECT_EQ(refusal({{"seed", -1}}), "options of a run: seed must be from 0 to 1e+18, got -1");
  EXPECT_EQ(refusal({{"twice", 1}}), "options of a run: twice must be true or false, got 1");
  EXPECT_EQ(refusal({{"rolling", "yes"}}), "options of a run: rolling must be on or off, got \"yes\"");
  EXPECT_EQ(refusal({{"start", "x"}}), "options of a run: start must be a list of texts, got \"x\"");
  EXPECT_EQ(refusal({{"world", nullptr}}), "options of a run: world must be a text, got null");
  EXPECT_EQ(refusal({{"hash_period", 0}, {"last", 0.0}}), "") << "0 is: not given";
  EXPECT_FALSE(parse_run_options("{"));
}

TEST(RunOptions, what_the_user_gives_comes_before_what_was_recorded) {
  base::Command command("a test", "test");
  RunOptions given;
  add_run_options(command, given, {"duration", "seed", "start", "one-process-each"});
  std::vector<std::string> words{"test", "--duration", "2", "--start", "mine"};
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  ASSERT_FALSE(base::parse_command_line(command, "test", static_cast<int>(arguments.size()), arguments.data()));
  RunOptions recorded;
  recorded.seed = 7;
  recorded.duration_s = 30;
  recorded.start = {"theirs"};
  recorded.one_process_each = true;
  const auto both = with_given(recorded, given, command);
  EXPECT_EQ(both.duration_s, 2);
  EXPECT_EQ(both.seed, 7U);
  EXPECT_EQ(both.start, (std::vector<std::string>{"theirs", "mine"}));
  EXPECT_TRUE(both.one_process_each);
}

}  // namespace
}  // namespace tools
