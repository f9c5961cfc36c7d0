// Conditions and events of a plan on a simulator without a process.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <string>
#include <vector>

#include "campaign/run/action_runner.h"
#include "run/fake_simulator.h"

namespace campaign {
namespace {

using tools::test::FakeSimulator;

struct Scene {
  FakeSimulator simulator;
  tools::Workplace place{""};
  std::string naming = "127.0.0.1:1";
  tools::SavedSystem system;
  tools::PortValues values;
  tools::RunScene scene{simulator,
                        place,
                        naming,
                        system,
                        values,
                        [](const std::string&) { return Result<void>(); },
                        [](const std::string&) { return Result<void>(); },
                        [](const std::string&) { return false; },
                        [](bool) {},
                        [](const std::string& instance, tools::Detail) {
                          return Result<tools::ComponentView>(Error{"component " + instance + ": is not there"});
                        }};

  // After ten steps, so at the first look.
  Result<void> look(ActionRunner& runner, double time_s) { return runner.act(scene, std::llround(time_s / simulator.step())); }
};

Condition condition(const std::string& yaml) { return to_condition(YAML::Load(yaml)); }
Condition region(const std::string& model) { return condition("{model: " + model + ", region: [1, -1, 2, 1]}"); }
Condition contact(const std::string& model, const std::string& touched) {
  return condition("{model: " + model + ", touches: " + touched + "}");
}

std::string problem(ActionRunner& runner) { return runner.verdicts().at(0).problem; }

TEST(Conditions, a_model_in_a_region_is_seen_at_the_next_look) {
  Scene s;
  s.simulator.poses["robot"] = {0, 0, 0, 1, 0, 0, 0};
  ActionRunner runner({.never = {region("robot")}}, 1, 10);
  ASSERT_TRUE(runner.begin(s.scene));
  ASSERT_TRUE(s.look(runner, 0.1));
  EXPECT_EQ(problem(runner), "");
  s.simulator.poses["robot"].x = 1.5;
  ASSERT_TRUE(s.look(runner, 0.2));
  EXPECT_EQ(problem(runner), "it was so at 0.2 s");
}

TEST(Conditions, nothing_is_true_of_a_model_that_does_not_exist_yet) {
  Scene s;
  s.simulator.poses["ground_plane"] = shm::identity_pose;
  ActionRunner runner({.eventually = {region("box")}}, 1, 10);
  ASSERT_TRUE(runner.begin(s.scene));
  ASSERT_TRUE(s.look(runner, 0.1));
  EXPECT_EQ(problem(runner), "never became true");
  s.simulator.poses["box"] = {1.5, 0, 0, 1, 0, 0, 0};
  ASSERT_TRUE(s.look(runner, 0.2));
  EXPECT_EQ(problem(runner), "");
}

TEST(Conditions, a_simulator_that_does_not_answer_ends_the_run) {
  Scene s;
  ActionRunner runner({.never = {region("robot")}}, 1, 10);
  ASSERT_TRUE(runner.begin(s.scene));
  s.simulator.broken = Error{"server 42 did not answer in time"};
  const auto looked = s.look(runner, 0.1);
  ASSERT_FALSE(looked);
  EXPECT_EQ(looked.error().message, "server 42 did not answer in time");
}

TEST(Conditions, any_contact_leaves_out_the_ground) {
  Scene s;
  s.simulator.poses["robot"] = shm::identity_pose;
  s.simulator.touching["robot"] = {{"robot::base::hull", "ground_plane::link::plane"}};
  ActionRunner any({.never = {contact("robot", "any")}}, 1, 10), wall({.never = {contact("robot", "wall")}}, 1, 10);
  ASSERT_TRUE(any.begin(s.scene));
  ASSERT_TRUE(wall.begin(s.scene));
  ASSERT_TRUE(s.look(any, 0.1));
  EXPECT_EQ(problem(any), "");
  s.simulator.touching["robot"].push_back({"robot::base::hull", "box::link::hull"});
  ASSERT_TRUE(s.look(any, 0.2));
  ASSERT_TRUE(s.look(wall, 0.2));
  EXPECT_EQ(problem(any), "it was so at 0.2 s");
  EXPECT_EQ(problem(wall), "");
}

TEST(Conditions, a_state_or_a_port_without_a_value_is_false_and_not_an_error) {
  Scene s;
  ActionRunner runner({.never = {condition("{component: A0, is: Error}"), condition("{port: 'A0:out', member: data, max: 1}")}}, 1, 10);
  ASSERT_TRUE(runner.begin(s.scene));
  ASSERT_TRUE(s.look(runner, 0.1));
  for (const auto& verdict : runner.verdicts()) EXPECT_EQ(verdict.problem, "") << verdict.expectation;
}

TEST(Events, change_models_and_leave_those_that_do_not_exist) {
  Scene s;
  s.simulator.poses["robot"] = shm::identity_pose;
  Event push;
  push.kind = Event::Kind::push;
  push.target = "robot";
  push.numbers = {"1", "0", "0"};
  auto wrench = push;
  wrench.kind = Event::Kind::wrench;
  wrench.numbers.resize(6, "2");
  wrench.stays = true;
  auto joint = push;
  joint.kind = Event::Kind::joint_force;
  joint.target = "robot::elbow";
  joint.numbers = {"1"};
  auto pose = push;
  pose.kind = Event::Kind::pose;
  auto missing = push;
  missing.target = "nobody";
  for (const auto& event : {push, wrench, joint, pose, missing}) {
    const auto done = carry_out_event(s.scene, event);
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_EQ(*done, "");
  }
  EXPECT_EQ(s.simulator.asked, (std::vector<std::string>{"push robot 3", "push robot 6 stays", "push robot::elbow 1", "pose robot 3"}));
}

TEST(Events, a_model_whose_name_is_taken_is_not_spawned_and_the_reason_is_told) {
  Scene s;
  Event spawn;
  spawn.kind = Event::Kind::spawn;
  spawn.target = "model://box";
  spawn.name = "box";
  EXPECT_EQ(*carry_out_event(s.scene, spawn), "");
  EXPECT_EQ(*carry_out_event(s.scene, spawn), "there is a model \"box\" already");
}

}  // namespace
}  // namespace campaign
