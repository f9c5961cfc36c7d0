// Messages that all actions of ROS 2 share (action_msgs), and those of the action SimulateSteps. Values.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ros/messages.h"
#include "ros/simulation_services.h"

namespace ros {

struct Uuid {
  static constexpr std::string_view name = "unique_identifier_msgs/msg/UUID";
  std::array<std::uint8_t, 16> uuid{};
  bool operator==(const Uuid&) const = default;
  static void fields(auto& m, auto& visit) { visit("uuid", m.uuid); }
};
struct GoalInfo {
  static constexpr std::string_view name = "action_msgs/msg/GoalInfo";
  Uuid goal_id{};
  Time stamp{};
  static void fields(auto& m, auto& visit) {
    visit("goal_id", m.goal_id);
    visit("stamp", m.stamp);
  }
};
struct GoalStatus {
  static constexpr std::string_view name = "action_msgs/msg/GoalStatus";
  static constexpr std::int8_t unknown = 0, executing = 2, canceling = 3, succeeded = 4, canceled = 5, aborted = 6;
  GoalInfo goal_info{};
  std::int8_t status = unknown;
  static void fields(auto& m, auto& visit) {
    visit("goal_info", m.goal_info);
    visit("status", m.status);
  }
};
struct GoalStatusArray {
  static constexpr std::string_view name = "action_msgs/msg/GoalStatusArray";
  std::vector<GoalStatus> status_list{};
  static void fields(auto& m, auto& visit) { visit("status_list", m.status_list); }
};
struct CancelGoalRequest {
  static constexpr std::string_view name = "action_msgs/srv/CancelGoal_Request";
  GoalInfo goal_info{};
  static void fields(auto& m, auto& visit) { visit("goal_info", m.goal_info); }
};
struct CancelGoalResponse {
  static constexpr std::string_view name = "action_msgs/srv/CancelGoal_Response";
  static constexpr std::int8_t none = 0, rejected = 1, unknown_goal = 2, goal_terminated = 3;
  std::int8_t return_code = none;
  std::vector<GoalInfo> goals_canceling{};
  static void fields(auto& m, auto& visit) {
    visit("return_code", m.return_code);
    visit("goals_canceling", m.goals_canceling);
  }
};

struct SimulateStepsGoal {
  static constexpr std::string_view name = "simulation_interfaces/action/SimulateSteps_Goal";
  std::uint64_t steps = 0;
  static void fields(auto& m, auto& visit) { visit("steps", m.steps); }
};
struct SimulateStepsResult {
  static constexpr std::string_view name = "simulation_interfaces/action/SimulateSteps_Result";
  SimulationResult result{};
  static void fields(auto& m, auto& visit) { visit("result", m.result); }
};
struct SimulateStepsFeedback {
  static constexpr std::string_view name = "simulation_interfaces/action/SimulateSteps_Feedback";
  std::uint64_t completed_steps = 0, remaining_steps = 0;
  static void fields(auto& m, auto& visit) {
    visit("completed_steps", m.completed_steps);
    visit("remaining_steps", m.remaining_steps);
  }
};
struct SimulateStepsSendGoalRequest {
  static constexpr std::string_view name = "simulation_interfaces/action/SimulateSteps_SendGoal_Request";
  Uuid goal_id{};
  SimulateStepsGoal goal{};
  static void fields(auto& m, auto& visit) {
    visit("goal_id", m.goal_id);
    visit("goal", m.goal);
  }
};
struct SimulateStepsSendGoalResponse {
  static constexpr std::string_view name = "simulation_interfaces/action/SimulateSteps_SendGoal_Response";
  bool accepted = false;
  Time stamp{};
  static void fields(auto& m, auto& visit) {
    visit("accepted", m.accepted);
    visit("stamp", m.stamp);
  }
};
struct SimulateStepsGetResultRequest {
  static constexpr std::string_view name = "simulation_interfaces/action/SimulateSteps_GetResult_Request";
  Uuid goal_id{};
  static void fields(auto& m, auto& visit) { visit("goal_id", m.goal_id); }
};
struct SimulateStepsGetResultResponse {
  static constexpr std::string_view name = "simulation_interfaces/action/SimulateSteps_GetResult_Response";
  std::int8_t status = GoalStatus::unknown;
  SimulateStepsResult result{};
  static void fields(auto& m, auto& visit) {
    visit("status", m.status);
    visit("result", m.result);
  }
};
struct SimulateStepsFeedbackMessage {
  static constexpr std::string_view name = "simulation_interfaces/action/SimulateSteps_FeedbackMessage";
  Uuid goal_id{};
  SimulateStepsFeedback feedback{};
  static void fields(auto& m, auto& visit) {
    visit("goal_id", m.goal_id);
    visit("feedback", m.feedback);
  }
};

}  // namespace ros
