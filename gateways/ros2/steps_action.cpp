#include "steps_action.h"

#include <algorithm>
#include <tuple>

#include "ros/from_iface.h"

namespace ros2 {
namespace {

using ros::CancelGoalResponse;
using ros::GoalStatus;
using ros::SimulationResult;
constexpr std::size_t max_goals = 20;
constexpr std::chrono::milliseconds feedback_period{100};

bool is_over(std::int8_t status) { return status != GoalStatus::executing && status != GoalStatus::canceling; }
auto moment(const ros::Time& time) { return std::tie(time.sec, time.nanosec); }

// Nothing while there is no simulator.
std::optional<shm::SimulationSample> clock_of(const World& world) {
  const auto& source = world.clock();
  if (!source || !source->iface().read()) return std::nullopt;
  return source->iface().sample<shm::SimulationSample>();
}

}  // namespace

std::optional<std::string> problem_of_steps(const World& world, std::uint64_t steps) {
  constexpr std::uint64_t most = 1'000'000'000;
  const auto now = clock_of(world);
  if (!now) return "no simulator runs";
  if (now->paused == 0) return "the simulation runs; pause it first";
  if (steps < 1 || steps > most) return "steps must be from 1 to 1000000000, got " + std::to_string(steps);
  return std::nullopt;
}

StepsAction::StepsAction(Node& node, World& world, AsyncRequests& async_requests, AsyncRequests& steps, const std::string& name)
    : world_(world), async_requests_(async_requests), steps_(steps) {
  const std::string front = name + "/_action/";
  feedback_ = node.advertise<ros::SimulateStepsFeedbackMessage>(front + "feedback");
  status_ = node.advertise<ros::GoalStatusArray>(front + "status", {true, 1});
  node.serve<ros::SimulateStepsSendGoalRequest, ros::SimulateStepsSendGoalResponse>(
      front + "send_goal", [this](const auto& request, const auto& reply) { accept(request, reply); });
  node.serve<ros::CancelGoalRequest, CancelGoalResponse>(front + "cancel_goal",
                                                         [this](const auto& request, const auto& reply) { cancel(request, reply); });
  node.serve<ros::SimulateStepsGetResultRequest, ros::SimulateStepsGetResultResponse>(
      front + "get_result", [this](const auto& request, const auto& reply) {
        Goal* goal = find(request.goal_id);
        if (goal == nullptr) return reply(ros::SimulateStepsGetResultResponse{});
        if (is_over(goal->status)) return reply(ros::SimulateStepsGetResultResponse{goal->status, {goal->result}});
        constexpr std::size_t max_waiting = 100;
        if (goal->waiting.size() < max_waiting) goal->waiting.push_back(reply);
      });
}

StepsAction::Goal* StepsAction::find(const ros::Uuid& id) {
  const auto found = std::ranges::find_if(goals_, [&](const Goal& goal) { return goal.info.goal_id == id; });
  return found == goals_.end() ? nullptr : &*found;
}

StepsAction::Goal* StepsAction::running() {
  const auto found = std::ranges::find_if(goals_, [](const Goal& goal) { return !is_over(goal.status); });
  return found == goals_.end() ? nullptr : &*found;
}

void StepsAction::accept(const ros::SimulateStepsSendGoalRequest& request,
                         const std::function<void(const ros::SimulateStepsSendGoalResponse&)>& reply) {
  const auto now = clock_of(world_);
  const ros::Time stamp = ros::to_time(std::chrono::nanoseconds(now ? now->stamp.sim_time_ns : 0));
  if (find(request.goal_id) != nullptr) return reply({false, stamp});
  const auto problem =
      running() != nullptr ? std::optional<std::string>("another goal is executed") : problem_of_steps(world_, request.goal.steps);
  const auto oldest = std::ranges::find_if(goals_, [](const Goal& goal) { return is_over(goal.status); });
  if (goals_.size() >= max_goals && oldest != goals_.end()) goals_.erase(oldest);
  goals_.push_back({{request.goal_id, stamp}, request.goal.steps, now ? now->steps : 0});
  reply({true, stamp});
  if (problem) return finish(goals_.back(), GoalStatus::aborted, {SimulationResult::failed, *problem});
  tell_status();
  steps_.post(
      shm::StepRequest{.steps = static_cast<std::int64_t>(request.goal.steps)},
      [this, id = request.goal_id](const base::Result<shm::Reply>& done) { end(id, done); }, step_timeout);
}

void StepsAction::cancel(const ros::CancelGoalRequest& request, const std::function<void(const CancelGoalResponse&)>& reply) {
  const auto& [id, stamp] = request.goal_info;
  const bool has_id = id != ros::Uuid{}, has_stamp = stamp.sec != 0 || stamp.nanosec != 0;
  const Goal* named = has_id ? find(id) : nullptr;
  CancelGoalResponse response;
  if (has_id && named == nullptr) response.return_code = CancelGoalResponse::unknown_goal;
  if (named != nullptr && is_over(named->status)) response.return_code = CancelGoalResponse::goal_terminated;
  if (Goal* goal = running()) {
    const bool is_meant = goal == named || (!has_id && !has_stamp) || (has_stamp && moment(goal->info.stamp) <= moment(stamp));
    if (is_meant) {
      goal->status = GoalStatus::canceling;
      response.return_code = CancelGoalResponse::none;
      response.goals_canceling.push_back(goal->info);
    }
  }
  reply(response);
  if (!response.goals_canceling.empty()) tell_status();
}

void StepsAction::end(const ros::Uuid& id, const base::Result<shm::Reply>& reply) {
  Goal* goal = find(id);
  if (goal == nullptr) return;
  const std::uint64_t done = reply ? goal->steps : done_of(*goal);
  tell_feedback(*goal, done);
  if (reply) return finish(*goal, GoalStatus::succeeded, {SimulationResult::ok, ""});
  const std::string made = std::to_string(done) + " of " + std::to_string(goal->steps) + " steps were made";
  if (goal->status == GoalStatus::canceling) return finish(*goal, GoalStatus::canceled, {SimulationResult::failed, "canceled: " + made});
  finish(*goal, GoalStatus::aborted, {SimulationResult::failed, reply.error().message + "; " + made});
}

void StepsAction::finish(Goal& goal, std::int8_t status, ros::SimulationResult result) {
  goal.status = status;
  goal.result = std::move(result);
  tell_status();
  for (const auto& reply : std::exchange(goal.waiting, {})) reply({goal.status, {goal.result}});
}

// A reset may have set the count back.
std::uint64_t StepsAction::done_of(const Goal& goal) const {
  const auto now = clock_of(world_);
  if (!now || now->steps < goal.begin) return 0;
  return std::min(now->steps - goal.begin, goal.steps);
}

void StepsAction::tell_feedback(Goal& goal, std::uint64_t done) {
  if (feedback_ == nullptr || done == goal.told) return;
  goal.told = done;
  publish(*feedback_, ros::SimulateStepsFeedbackMessage{goal.info.goal_id, {done, goal.steps - done}});
}

void StepsAction::tell_status() {
  if (status_ == nullptr) return;
  ros::GoalStatusArray message;
  for (const Goal& goal : goals_) message.status_list.push_back({goal.info, goal.status});
  publish(*status_, message);
}

void StepsAction::update(std::chrono::steady_clock::time_point now) {
  Goal* goal = running();
  if (goal == nullptr) return;
  if (now >= next_feedback_) {
    next_feedback_ = now + feedback_period;
    tell_feedback(*goal, done_of(*goal));
  }
  if (goal->status != GoalStatus::canceling || is_pausing_) return;
  // The steps may not have begun: then it is asked again.
  is_pausing_ = true;
  async_requests_.post(shm::PauseRequest{}, [this](const base::Result<shm::Reply>&) { is_pausing_ = false; });
}

}  // namespace ros2
