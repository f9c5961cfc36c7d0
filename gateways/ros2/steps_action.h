// The action SimulateSteps of simulation_interfaces: a paused simulation makes a number of steps, with feedback, and can be ended by a
// cancel. One goal at a time; a goal that cannot be executed is accepted and aborted, so that its result says why. One thread at a time.
//
//   executing ──(all steps made)──> succeeded      ──(paused, reset, rejected)──> aborted
//   executing ──(cancel)──> canceling ──(the steps have ended)──> canceled, or succeeded when they were all made
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "node.h"
#include "ros/action_messages.h"
#include "world.h"

namespace ros2 {

inline constexpr std::chrono::minutes step_timeout{10};
// Why these steps cannot be made now; nothing when they can.
std::optional<std::string> problem_of_steps(const World& world, std::uint64_t steps);

class StepsAction {
 public:
  // `name`: "/simulate_steps". `steps`: where steps wait. All must outlive this object.
  StepsAction(Node& node, World& world, AsyncRequests& async_requests, AsyncRequests& steps, const std::string& name);

  // Sends feedback, and ends the steps of goals that are canceled; to be called some times a second.
  void update(std::chrono::steady_clock::time_point now);

 private:
  using ReplyResult = std::function<void(const ros::SimulateStepsGetResultResponse&)>;
  struct Goal {
    ros::GoalInfo info;
    std::uint64_t steps = 0, begin = 0, told = 0;  // told: in the last feedback
    std::int8_t status = ros::GoalStatus::executing;
    ros::SimulationResult result{};
    std::vector<ReplyResult> waiting{};
  };

  void accept(const ros::SimulateStepsSendGoalRequest& request,
              const std::function<void(const ros::SimulateStepsSendGoalResponse&)>& reply);
  void cancel(const ros::CancelGoalRequest& request, const std::function<void(const ros::CancelGoalResponse&)>& reply);
  void end(const ros::Uuid& id, const base::Result<shm::Reply>& reply);
  void finish(Goal& goal, std::int8_t status, ros::SimulationResult result);
  void tell_feedback(Goal& goal, std::uint64_t done);
  void tell_status();
  Goal* find(const ros::Uuid& id);
  Goal* running();
  std::uint64_t done_of(const Goal& goal) const;

  World& world_;
  AsyncRequests& async_requests_;
  AsyncRequests& steps_;
  Writer* feedback_ = nullptr;
  Writer* status_ = nullptr;
  std::deque<Goal> goals_;  // the oldest first; the last ones that have ended are kept
  bool is_pausing_ = false;
  std::chrono::steady_clock::time_point next_feedback_{};
};

}  // namespace ros2
