#include "run/expectations.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace tools {
namespace {

// Files of one test, gone with it.
class ExpectationsTest : public testing::Test {
 protected:
  std::string file(const std::string& content) {
    const auto path =
        std::filesystem::path(testing::TempDir()) / ("expectations-" + std::to_string(getpid()) + "-" + std::to_string(files_.size()));
    std::ofstream(path) << content;
    files_.push_back(path);
    return path.string();
  }
  // The problem of the only expectation in the file.
  std::string problem(const std::string& yaml) {
    const auto expectations = read_expectations(file(yaml));
    EXPECT_TRUE(expectations.ok()) << expectations.error().message;
    return expectations ? judge(*expectations, seen_).at(0).problem : "unread";
  }
  Verdict verdict(const std::string& yaml) { return judge(read_expectations(file(yaml)).value(), seen_).at(0); }
  std::string refusal(const std::string& yaml) {
    const auto expectations = read_expectations(file(yaml));
    EXPECT_FALSE(expectations.ok()) << yaml;
    return expectations ? "" : expectations.error().message;
  }
  void TearDown() override {
    for (const auto& path : files_) std::filesystem::remove(path);
  }

  Seen seen_ = [] {
    Seen seen;
    seen.record.poses["robot"] = {{0, 0, 0, 0}, {1, 3, 0, 0}, {2, 3, 4, 0}};
    seen.models = {"box", "ground_plane", "robot"};
    seen.record.contacts = {{0.1, "robot", "ground_plane"}, {1.5, "box", "robot"}};
    for (const double number : {-1, 0, 2}) seen.values["A0:out data"].take(number);
    seen.states["A0"] = "Active";
    seen.parts = {{"arm", {"elbow", "waist"}, {{"arm::hand", "arm", {"left", "right", "palm"}}}}, {"robot", {}, {}}};
    seen.record.joints["arm::elbow"] = {{0, 0.5}, {0.1, 1}, {0.2, 1.5}};
    return seen;
  }();

 private:
  std::vector<std::filesystem::path> files_;
};

TEST_F(ExpectationsTest, paths_are_as_long_as_their_pieces) {
  EXPECT_EQ(problem("- path_length: {model: robot, min: 7, max: 7}"), "");
  EXPECT_EQ(problem("- path_length: {model: robot, max: 6.5}"), "its path was 7 m long, expected at most 6.5");
  EXPECT_NE(problem("- path_length: {model: nobody, min: 1}").find("nobody"), std::string::npos);
}

TEST_F(ExpectationsTest, regions_are_reached_in_time_or_not) {
  EXPECT_EQ(problem("- reach: {model: robot, region: [4, 5, 2, 3]}"), "");
  EXPECT_NE(problem("- reach: {model: robot, region: [2, 3, 4, 5], within: 1.5}"), "");
  EXPECT_EQ(problem("- stay: {model: robot, region: [0, 0, 3, 4]}"), "");
  EXPECT_EQ(problem("- stay: {model: robot, region: [0, 0, 2, 4]}"), "it was at (3, 0) at 1 s");
}

TEST_F(ExpectationsTest, contacts_count_for_both_models_and_the_ground_does_not) {
  EXPECT_EQ(problem("- no_contact: {model: robot}"), "it touched box at 1.5 s");
  EXPECT_EQ(problem("- no_contact: {model: robot, except: [ground_plane, box]}"), "");
  EXPECT_EQ(problem("- no_contact: {model: robot, except: box}"), "it touched ground_plane at 0.1 s");
}

TEST_F(ExpectationsTest, values_states_and_commands_are_judged_by_what_was_seen) {
  EXPECT_EQ(problem("- value: {port: 'A0:out', member: data, min: -1, max: 2}"), "");
  EXPECT_NE(problem("- value: {port: 'A0:out', member: data, min: 0}"), "");
  EXPECT_EQ(problem("- value: {port: 'A0:out', member: other, min: 0}"), "no sample arrived");
  EXPECT_EQ(problem("- state: {component: A0, is: active}"), "");
  EXPECT_EQ(problem("- state: {component: A0, is: Error}"), "it is Active");
  EXPECT_EQ(problem("- command: 'true'"), "it was not run");
  seen_.commands["true"] = {0, "well"};
  EXPECT_EQ(problem("- command: 'true'"), "");
  seen_.commands["true"] = {3, "no such thing"};
  EXPECT_EQ(problem("- command: 'true'"), "it ended with exit code 3: no such thing");
  seen_.commands["true"] = {std::nullopt, "it did not end within 60 s"};
  EXPECT_EQ(problem("- command: 'true'"), "it did not end within 60 s");
}

TEST_F(ExpectationsTest, joints_come_between_their_limits_in_time_or_never_leave_them) {
  EXPECT_EQ(problem("- joint: {model: arm, name: elbow, min: 0.9, max: 1.1, within: 1}"), "");
  EXPECT_EQ(problem("- joint: {model: arm, name: elbow, min: 1.4, within: 0.2}"), "");
  EXPECT_EQ(problem("- joint: {model: arm, name: elbow, min: 1.4, within: 0.15}"),
            "it came no nearer than 1 at 0.1 s, expected at least 1.4 within 0.15 s");
  EXPECT_EQ(problem("- joint: {model: arm, name: elbow, min: 0.5, max: 1.5}"), "");
  EXPECT_EQ(problem("- joint: {model: arm, name: elbow, max: 1.4}"), "it was at 1.5 at 0.2 s, expected at most 1.4");
  EXPECT_EQ(problem("- joint: {model: arm, name: wrist, min: 0}"), "model \"arm\" has no joint \"wrist\"; joints: elbow, waist");
  EXPECT_EQ(problem("- joint: {model: arm, name: waist, min: 0}"), "it has no position: model \"arm\" does not move");
  EXPECT_EQ(problem("- joint: {model: robot, name: elbow, min: 0}"), "model \"robot\" has no joint \"elbow\"; joints: none");
  EXPECT_NE(refusal("- joint: {model: arm, name: elbow}").find("joint needs min or max"), std::string::npos);
  EXPECT_NE(refusal("- joint: {model: arm, min: 1}").find("name"), std::string::npos);
  const auto failed = judge(*read_expectations(file("- joint: {model: arm, name: elbow, max: 1}")), seen_);
  EXPECT_EQ(failure_text(failed.at(0)),
            "joint arm::elbow: it was at 1.5 at 0.2 s, expected at most 1 (joint: {model: arm, name: elbow, max: 1})");
}

TEST_F(ExpectationsTest, a_gripper_holds_what_two_of_its_links_touch) {
  const Gripper hand{"arm::hand", "arm", {"left", "right", "palm"}};
  const ModelContact left{"box::l::c", "arm::left::c"}, right{"arm::right::c", "box::l::c"}, ground{"box::l::c", "ground_plane::l::c"};
  EXPECT_EQ(grip_problem(hand, "box", {left, right}), "");
  EXPECT_EQ(grip_problem(hand, "box", {left, left, ground}), "only left touches box");
  EXPECT_EQ(grip_problem(hand, "box", {ground}), "no link of it touches box; it has left, right, palm");
  EXPECT_EQ(grip_problem({"arm::sucker", "arm", {"left"}}, "box", {left}), "");
  EXPECT_EQ(problem("- holds: {gripper: 'arm::hand', model: box}"), "it was not looked at");
  seen_.grips["arm::hand holds box"] = "only left touches box";
  EXPECT_EQ(problem("- holds: {gripper: 'arm::hand', model: box}"), "only left touches box");
  seen_.grips["arm::hand holds box"] = "";
  EXPECT_EQ(problem("- holds: {gripper: 'arm::hand', model: box}"), "");
  EXPECT_NE(refusal("- holds: {gripper: 'arm::hand'}").find("model"), std::string::npos);
}

TEST_F(ExpectationsTest, a_gripper_is_named_with_its_model_or_without_where_there_is_one) {
  const std::vector<ModelParts> parts = {{"a", {}, {{"a::hand", "a"}}}, {"b", {}, {{"b::hand", "b"}, {"b::foot", "b"}}}, {"c", {}, {}}};
  for (const auto& [name, found] : std::map<std::string, std::string>{{"a::hand", "a::hand"}, {"a", "a::hand"}, {"foot", "b::foot"}}) {
    const auto gripper = find_gripper(parts, name);
    ASSERT_TRUE(gripper) << gripper.error().message;
    EXPECT_EQ(gripper->name, found);
  }
  EXPECT_EQ(find_gripper(parts, "hand").error().message, "gripper \"hand\" may be a::hand or b::hand");
  EXPECT_EQ(find_gripper(parts, "c").error().message, "the world has no gripper \"c\"; grippers: a::hand, b::hand, b::foot");
}

TEST_F(ExpectationsTest, what_is_no_number_is_within_no_bounds) {
  seen_.values["A0:out data"].take(NAN);
  EXPECT_EQ(problem("- value: {port: 'A0:out', member: data, min: -1, max: 2}"), "it was not a number (NaN) in 1 of 4 samples");
  SeenValue first_is_nan;
  for (const double number : {std::nan(""), 5.0, 6.0}) first_is_nan.take(number);
  EXPECT_EQ(first_is_nan.lowest, 5);
  EXPECT_EQ(first_is_nan.highest, 6);
  seen_.values["A0:out data.x"].problem = "the samples have no number data.x; they have data";
  EXPECT_EQ(problem("- value: {port: 'A0:out', member: data.x, min: 0}"), "the samples have no number data.x; they have data");
}

TEST_F(ExpectationsTest, a_failure_has_its_time_and_its_object) {
  EXPECT_EQ(verdict("- path_length: {model: robot, max: 6.5}").time, 2);
  EXPECT_EQ(verdict("- stay: {model: robot, region: [-1, -1, 1, 1]}").time, 1);
  EXPECT_EQ(verdict("- reach: {model: robot, region: [8, 8, 9, 9], within: 1.5}").time, 1.5);
  EXPECT_EQ(verdict("- no_contact: {model: robot}").time, 1.5);
  EXPECT_EQ(verdict("- no_contact: {model: robot}").subject, "robot");
  const std::string value = "value: {port: 'A0:out', member: data, max: 1}";
  EXPECT_EQ(verdict("- " + value).time, std::nullopt) << "the sample has no stamp";
  const auto text = read_expectations(file("- " + value)).value().at(0).text;
  seen_.values["A0:out data"].violated_at[text] = 1.25;
  EXPECT_EQ(verdict("- " + value).time, 1.25);
  EXPECT_EQ(verdict("- " + value).subject, "A0");
}

TEST_F(ExpectationsTest, a_failure_at_the_end_and_a_fulfilled_expectation_have_no_time) {
  EXPECT_EQ(verdict("- path_length: {model: robot, min: 9}").time, std::nullopt);
  EXPECT_EQ(verdict("- reach: {model: robot, region: [8, 8, 9, 9]}").time, std::nullopt);
  EXPECT_EQ(verdict("- no_contact: {model: robot, except: [ground_plane, box]}").time, std::nullopt);
}

TEST_F(ExpectationsTest, members_are_paths) {
  EXPECT_EQ(member_path("data.vx").value(), (std::vector<std::string>{"data", "vx"}));
  EXPECT_EQ(member_path("ranges[12]").value(), (std::vector<std::string>{"ranges", "12"}));
  EXPECT_EQ(member_path("a[0][1].b").value(), (std::vector<std::string>{"a", "0", "1", "b"}));
  for (const char* wrong : {"", ".", "a.", ".a", "a..b", "a[", "a[x]", "a[-1]", "a[0]b", "a/~7x", "[", "a b"})
    EXPECT_FALSE(member_path(wrong).ok()) << wrong;
}

TEST_F(ExpectationsTest, what_is_not_there_is_told_with_what_is) {
  EXPECT_EQ(problem("- path_length: {model: nobody, min: 1}"), "the world has no moving model \"nobody\"; moving models: robot");
  EXPECT_EQ(problem("- state: {component: B0, is: Active}"), "there is no such component; components: A0");
  EXPECT_EQ(problem("- state: {component: A0.rtc, is: Active}"), "");
}

TEST_F(ExpectationsTest, what_would_be_ignored_is_refused) {
  EXPECT_NE(refusal("- path_length: {model: robot, minimum: 5, max: 10}").find("no key \"minimum\"; it has model, min, max"),
            std::string::npos);
  EXPECT_NE(refusal("- path_length: {model: robot, min: 5, min: 6}").find("twice"), std::string::npos);
  EXPECT_NE(refusal("- path_length: {model: robot, min: 5, max: 4}").find("max must not be less than min"), std::string::npos);
  EXPECT_NE(refusal("- path_length: {model: robot, min: .nan}").find("finite"), std::string::npos);
  EXPECT_NE(refusal("- reach: {model: robot, region: [0, 0, 1, 1], within: -5}").find("within"), std::string::npos);
  EXPECT_NE(refusal("- state: {component: A0, is: Activ}").find("Activ"), std::string::npos);
  EXPECT_NE(refusal("- value: {port: 'A0:out', member: 'data/~7x', min: 0}").find("data.vx"), std::string::npos);
  EXPECT_NE(refusal("- no_contact: {model: robot, except: {a: b}}").find("except"), std::string::npos);
}

TEST_F(ExpectationsTest, what_cannot_be_judged_is_refused_with_its_line) {
  EXPECT_NE(refusal("- state: {component: A0, is: Active}\n- fly: {}").find(":2:3: unknown expectation \"fly\""), std::string::npos);
  EXPECT_NE(refusal("- path_length: {model: robot}").find("min or max"), std::string::npos);
  EXPECT_NE(refusal("- path_length: {model: robot, min: far}").find("far"), std::string::npos);
  EXPECT_NE(refusal("- reach: {model: robot, region: [1, 2]}").find("region"), std::string::npos);
  EXPECT_NE(refusal("just text").find("list"), std::string::npos);
  EXPECT_FALSE(read_expectations("/proc/nowhere.yaml").ok());
}

TEST_F(ExpectationsTest, what_may_be_touched_must_be_there) {
  EXPECT_EQ(problem("- no_contact: {model: robot, except: [ground_plane, bxo]}"),
            "the world has no model \"bxo\" that may be touched; models: box, ground_plane, robot");
}

}  // namespace
}  // namespace tools
