// The simulator of a run, over shared memory. One thread at a time. Before attach(), and after it has failed, every request is an Error.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "run/simulator.h"
#include "shm/pose_log.h"
#include "shm/request_board.h"

namespace tools {

class ShmSimulator final : public Simulator {
 public:
  // The process of the simulator with this server ID, whoever started it; nothing when there is none.
  static std::optional<pid_t> process_of(std::uint32_t id);

  // To the simulator with this server ID that is the process `pid`. An Error: it is not there (yet), or does not answer (yet).
  base::Result<void> attach(std::uint32_t id, pid_t pid);

  const std::string& id() const override { return id_; }
  double step() const override { return step_s_; }
  base::Result<SimulatorState> state() override;
  std::optional<SimulatedMoment> now() override;
  std::vector<LockstepParticipant> participants() override;
  base::Result<std::vector<std::string>> models() override;
  base::Result<std::vector<ModelParts>> parts() override;
  base::Result<shm::Pose> pose(const std::string& name) override;
  base::Result<std::vector<ModelContact>> contacts(const std::string& model) override;
  base::Result<std::string> spawn(const ModelToSpawn& model) override;
  base::Result<void> remove(const std::string& model) override;
  base::Result<void> set_pose(const std::string& model, const std::vector<double>& numbers) override;
  base::Result<void> push(const std::string& name, const Push& push) override;
  base::Result<void> screenshot(const std::string& file, std::uint32_t pixels) override;
  base::Result<void> begin_steps(std::int64_t steps, bool is_paced) override;
  base::Result<bool> await_steps(std::chrono::milliseconds timeout) override;
  std::optional<LostProcess> await_loss(std::chrono::milliseconds timeout) override;
  base::Result<void> read_events(PoseRecord& record) override;

 private:
  base::Result<shm::Reply> ask(const shm::Request& request, std::chrono::nanoseconds timeout = request_timeout);

  std::string id_;
  double step_s_ = 0;
  std::optional<shm::Requester> requests_, steps_;  // two: others are answered while steps are made
  bool are_steps_under_way_ = false;
  std::optional<LostProcess> loss_;  // why the last steps ended
  base::Error loss_error_;           // what await_steps() returns then
  shm::PoseLogReader log_;
  std::int64_t log_read_ = 0;            // [bytes]
  std::set<std::string> joints_of_log_;  // that the simulator has been asked for
};

}  // namespace tools
