#include "campaign/plan/plan.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "campaign/plan/grammar.h"
#include "campaign/run/measures.h"
#include "support/paths.h"

namespace campaign {
namespace {

namespace fs = std::filesystem;

class Plans : public testing::Test {
 protected:
  Plans() : folder_(fs::path(testing::TempDir()) / ("plans_" + std::to_string(getpid()))) { fs::create_directories(folder_); }
  ~Plans() override { fs::remove_all(folder_); }

  Result<Plan> read(const std::string& text) {
    std::ofstream(folder_ / "p.yaml") << text;
    return read_plan((folder_ / "p.yaml").string());
  }
  // The message without the file's name.
  std::string error(const std::string& text) {
    const auto plan = read(text);
    if (plan) return "none";
    const auto& message = plan.error().message;
    return message.substr(message.find("p.yaml\"") + 7);
  }
  const std::string start_ = "system: s.xml\nworld: w.sdf\nduration: 5\n";
  fs::path folder_;
};

TEST_F(Plans, hold_what_is_written_in_them) {
  const auto plan = read(start_ +
                         "expect: e.yaml\nrepeat: 3\nvary:\n  component/A0/gain: [1, 2.5]\n  model/robot/pose/yaw: {uniform: [0, 1]}\n"
                         "  light/sun/intensity: {from: 0.5, to: 1, steps: 3}\nsampling: sobol\nsamples: 4\n"
                         "measure:\n  - value: {port: 'A0:out', member: data, take: mean, as: m}\n"
                         "faults:\n  - {at: 2, for: 1, sensor: robot::laser, is: bias, amount: 0.25}\n"
                         "events:\n  - {at: 1, push: {model: robot, force: [1, 0, 0], for: 0.5}}\n"
                         "  - {at: 2, wrench: {model: 'robot::arm', torque: [0, 0, 2], persistent: true}}\n"
                         "  - {at: 3, wrench: {model: 'robot::arm', clear: true}}\n"
                         "  - {at: 4, joint_force: {model: robot, joint: elbow, force: -3, for: 0.2}}\n");
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(plan->run.system, (folder_ / "s.xml").string());
  EXPECT_EQ(plan->repeat, 3U);
  ASSERT_EQ(plan->axes.size(), 3U);
  EXPECT_EQ(plan->axes[0].values, (std::vector<std::string>{"1", "2.5"}));
  EXPECT_TRUE(plan->axes[1].range);
  EXPECT_EQ(plan->axes[2].values, (std::vector<std::string>{"0.5", "0.75", "1"}));
  ASSERT_EQ(plan->measures.size(), 1U);
  EXPECT_EQ(plan->measures[0].name, "m");
  ASSERT_EQ(plan->faults.size(), 1U);
  EXPECT_EQ(plan->faults[0].text(), "{at: 2, for: 1, sensor: \"robot::laser\", is: bias, amount: 0.25}");
  ASSERT_EQ(plan->events.size(), 4U);
  EXPECT_EQ(plan->events[0].numbers, (std::vector<std::string>{"1", "0", "0"}));
  EXPECT_EQ(plan->events[1].numbers, (std::vector<std::string>{"0", "0", "0", "0", "0", "2"}));
  EXPECT_TRUE(plan->events[1].stays && plan->events[2].stays && !plan->events[3].stays);
  EXPECT_EQ(plan->events[2].numbers, std::vector<std::string>(6, "0"));
  EXPECT_EQ(plan->events[3].target, "robot::elbow");
  EXPECT_EQ(plan->events[3].numbers, std::vector<std::string>{"-3"});
  EXPECT_EQ(plan->events[3].duration_s, 0.2);
}

TEST_F(Plans, measure_joints_and_grips) {
  const auto plan =
      read(start_ +
           "measure:\n  - joint: {model: arm, name: elbow, take: max}\n  - joint: {model: arm, name: waist, take: last, as: end}\n"
           "  - holds: {gripper: 'arm::hand', model: box}\n  - holds: {gripper: 'arm::hand', model: can}\n");
  ASSERT_TRUE(plan) << plan.error().message;
  const auto watched = watched_values(plan->measures);
  ASSERT_EQ(watched.size(), 4U);
  EXPECT_EQ(watched[0].joint_name(), "arm::elbow");
  tools::Seen seen;
  seen.record.joints["arm::elbow"] = {{0, 0.5}, {0.1, 2}, {0.2, 1}};
  seen.grips = {{"arm::hand holds box", ""}, {"arm::hand holds can", "only left touches can"}};
  const auto numbers = take_measures(plan->measures, seen, {}, 0);
  EXPECT_EQ(numbers, (std::map<std::string, double>{{"arm::elbow max", 2}, {"arm::hand holds box", 1}, {"arm::hand holds can", 0}}))
      << "a joint without a record has no number";
  EXPECT_NE(error(start_ + "measure: [{joint: {model: arm, name: elbow, take: count}}]").find("count"), std::string::npos);
  EXPECT_NE(error(start_ + "measure: [{holds: {gripper: hand}}]").find("model"), std::string::npos);
}

// As a hunt writes them into another plan.
TEST_F(Plans, tell_deeds_in_one_line_however_they_are_written) {
  const auto plan = read(start_ +
                         "events:\n  - at: 1\n    command: |\n      one\n      two\n"
                         "never:\n  - model: robot\n    region:\n      - 0\n      - 0\n      - 1\n      - 1\n");
  ASSERT_TRUE(plan) << plan.error().message;
  ASSERT_EQ(plan->events.size(), 1U);
  EXPECT_EQ(plan->events[0].text, R"({at: 1, command: "one\ntwo\n"})");
  ASSERT_EQ(plan->never.size(), 1U);
  EXPECT_EQ(plan->never[0].text, "{model: robot, region: [0, 0, 1, 1]}");
}

TEST_F(Plans, say_line_and_column_of_what_is_wrong) {
  EXPECT_EQ(error(start_ + "repaet: 3\n").substr(0, 45), ":4:1: plan has no key \"repaet\"; it has system");
  EXPECT_EQ(error(start_ + "repeat: many\n"), ":4:9: repeat must be a whole number, 0 or more, got \"many\"");
  EXPECT_EQ(error("system: s.xml\nworld: w.sdf\n"), ":1:1: plan needs duration");
  EXPECT_EQ(error(start_ + "vary:\n  seed: {uniform: [3, 1]}\n"), ":5:19: uniform: the first must not be more than the second");
  EXPECT_EQ(error(start_ + "faults:\n  - {at: 1, sensor: x, is: weak}\n"),
            ":5:28: a fault of a sensor must be off, stuck, bias, noise, missing, latency, dropout");
  EXPECT_EQ(error(start_ + "faults:\n  - {at: 1, connector: x, is: drop, amount: 2}\n"),
            ":5:45: amount of drop must be from 0 to 1, got 2");
  EXPECT_EQ(error(start_ + "faults:\n  - {at: 1, connector: x, is: delay, amount: 1.5}\n"),
            ":5:46: amount of delay must be a whole number of samples, got 1.5");
  EXPECT_EQ(error(start_ + "vary:\n  seed: [1]\nrepeat: 2\n"), ":5:3: seed varies already by repeat; expected one of the two");
  EXPECT_EQ(error(start_ + "events:\n  - {at: 1, pose: {model: robot, to: [1, 2]}}\n"),
            ":5:38: to must be x y yaw, x y z yaw or x y z roll pitch yaw, got 2 numbers");
  EXPECT_EQ(error(start_ + "events:\n  - {at: 1, push: {model: robot, force: [1]}}\n"),
            ":5:41: force must be 3 numbers of a force or 6 of a force and a torque, got 1 number");
  for (const auto& [wrong, expected] : {
           std::pair{"wrench: {model: robot}", ":5:21: wrench needs force, torque or clear"},
           std::pair{"wrench: {model: robot, force: [1, 2]}", ":5:43: force must be 3 numbers, got 2 numbers"},
           std::pair{"wrench: {model: robot, torque: [1, 2, .nan]}", ":5:51: torque must hold finite numbers, got \".nan\""},
           std::pair{"wrench: {model: robot, force: [1, 0, 0], for: 1, persistent: true}", ":5:59: for does not go with persistent"},
           std::pair{"wrench: {model: robot, clear: true, for: 1}", ":5:54: for does not go with clear"},
           std::pair{"wrench: {model: robot, clear: true, force: [1, 0, 0]}", ":5:56: force does not go with clear"},
           std::pair{"wrench: {force: [1, 0, 0]}", ":5:21: wrench needs model"},
           std::pair{"joint_force: {model: robot, force: 1}", ":5:26: joint_force needs joint"},
           std::pair{"joint_force: {model: robot, joint: elbow}", ":5:26: joint_force needs force or clear"},
           std::pair{"joint_force: {model: robot, joint: elbow, force: much}", ":5:62: force must be a finite number, got \"much\""},
       })
    EXPECT_EQ(error(start_ + "events:\n  - {at: 1, " + wrong + "}\n"), expected) << wrong;
  EXPECT_EQ(error(start_ + "never:\n  - {port: 'A0:out', member: data, min: 2, max: 1}\n"), ":5:49: max must not be less than min");
  EXPECT_EQ(error("{"), ":1:1: is no YAML: end of map flow not found");
  EXPECT_EQ(error(start_ + "duration: 6\n"), ":4:1: plan has duration twice");
}

// What comes after the end, or is not looked at before it, would be silent.
TEST_F(Plans, refuse_what_happens_in_no_run) {
  EXPECT_EQ(error(start_ + "events:\n  - {at: 5.1, delete: robot}\n"), ":5:10: at must not be more than the duration of 5 s, got 5.1");
  EXPECT_EQ(error(start_ + "events:\n  - {at: 5, delete: robot}\n"), "none");
  EXPECT_EQ(error(start_ + "faults:\n  - {at: 5, naming: gone}\n"), ":5:10: at must be less than the duration of 5 s, got 5");
  EXPECT_EQ(error(start_ + "eventually:\n  - {component: A0, is: Error, within: 6}\n"),
            ":5:40: within must not be more than the duration of 5 s, got 6");
  EXPECT_EQ(error(start_ + "never:\n  - {component: A0, is: Error, after: 6}\n"),
            ":5:39: after must not be more than the duration of 5 s, got 6");
  EXPECT_EQ(error(start_ + "events:\n  - {when: {component: A0, is: Error, after: 6}, delete: robot}\n"),
            ":5:46: after must not be more than the duration of 5 s, got 6");
  EXPECT_EQ(error(start_ + "eventually:\n  - {component: A0, is: Error, after: 2, within: 1}\n"),
            ":5:50: within must not be less than after");
  EXPECT_EQ(error(start_ + "hunt:\n  events: [{at: 6, delete: robot}]\n"), ":5:17: at must not be more than the duration of 5 s, got 6");
}

TEST(PlanSchema, is_the_one_that_is_published) {
  std::ifstream in(std::string(paths::source_dir) + "/tools/campaign/campaign-plan.schema.json");
  EXPECT_EQ(nlohmann::ordered_json::parse(in, nullptr, false), plan_schema())
      << "rtse sweep --schema > tools/campaign/campaign-plan.schema.json";
}

}  // namespace
}  // namespace campaign
