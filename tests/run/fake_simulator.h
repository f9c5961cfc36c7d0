// A simulator without a process: tests say what is in its world, and read what was asked of it. One thread.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "run/simulator.h"

namespace tools::test {

class FakeSimulator final : public Simulator {
 public:
  std::map<std::string, shm::Pose> poses;  // of all models
  std::map<std::string, std::vector<ModelContact>> touching;
  std::vector<LockstepParticipant> there;
  std::vector<std::string> asked;     // requests that change something
  std::optional<base::Error> broken;  // what every request returns
  PoseRecord events;                  // that read_events() adds, once
  std::int64_t steps_done = 0;
  int looks_until_done = 0;         // of await_steps()
  std::optional<LostProcess> lost;  // what await_loss() returns
  bool is_stuck = false;            // steps never end, and time stands still

  const std::string& id() const override { return id_; }
  double step() const override { return 0.001; }
  base::Result<SimulatorState> state() override {
    if (broken) return *broken;
    return SimulatorState{1, step(), "0123456789abcdef"};
  }
  std::optional<SimulatedMoment> now() override {
    if (broken) return std::nullopt;
    return SimulatedMoment{static_cast<double>(steps_done) * step(), static_cast<std::uint64_t>(steps_done)};
  }
  std::vector<LockstepParticipant> participants() override { return there; }
  base::Result<std::vector<std::string>> models() override {
    if (broken) return *broken;
    std::vector<std::string> names;
    for (const auto& [name, pose] : poses) names.push_back(name);
    return names;
  }
  base::Result<std::vector<ModelParts>> parts() override {
    if (broken) return *broken;
    std::vector<ModelParts> all;
    for (const auto& [name, pose] : poses) all.push_back({name, {}, {}});
    return all;
  }
  base::Result<shm::Pose> pose(const std::string& name) override {
    if (broken) return *broken;
    const auto found = poses.find(name);
    return found == poses.end() ? base::Result<shm::Pose>(base::Error{"get-pose: no model or link " + name}) : found->second;
  }
  base::Result<std::vector<ModelContact>> contacts(const std::string& model) override {
    if (broken) return *broken;
    if (!poses.contains(model)) return base::Error{"contacts: no model or link " + model};
    return touching[model];
  }
  base::Result<std::string> spawn(const ModelToSpawn& model) override {
    if (poses.contains(model.name)) return base::Error{"spawn: the name is taken"};
    poses[model.name] = shm::identity_pose;
    return note("spawn " + model.source) ? base::Result<std::string>(model.name) : *broken;
  }
  base::Result<void> remove(const std::string& model) override {
    if (poses.erase(model) == 0) return base::Error{"delete: no model or link " + model};
    return note("remove " + model);
  }
  base::Result<void> set_pose(const std::string& model, const std::vector<double>& numbers) override {
    if (!poses.contains(model)) return base::Error{"set-pose: no model or link " + model};
    return note("pose " + model + " " + std::to_string(numbers.size()));
  }
  base::Result<void> push(const std::string& name, const Push& push) override {
    if (!poses.contains(name.substr(0, name.find("::")))) return base::Error{"wrench: no model or link " + name};
    return note("push " + name + " " + std::to_string(push.numbers.size()) + (push.stays ? " stays" : ""));
  }
  base::Result<void> screenshot(const std::string& file, std::uint32_t) override { return note("screenshot " + file); }
  base::Result<void> begin_steps(std::int64_t steps, bool) override {
    wanted_ = steps;
    return broken ? base::Result<void>(*broken) : base::Result<void>();
  }
  base::Result<bool> await_steps(std::chrono::milliseconds) override {
    if (broken) return *broken;
    if (is_stuck) return false;
    if (looks_until_done-- > 0) {
      ++steps_done;
      return false;
    }
    steps_done += wanted_;
    return true;
  }
  std::optional<LostProcess> await_loss(std::chrono::milliseconds) override { return lost; }
  base::Result<void> read_events(PoseRecord& record) override {
    if (broken) return *broken;
    for (const auto& [model, list] : events.poses) {
      for (const auto& pose : list) record.add_pose(model, pose);
    }
    for (const auto& [joint, list] : events.joints) {
      for (const auto& one : list) record.add_joint(joint, one);
    }
    for (const auto& contact : events.contacts) record.add_contact(contact);
    events = {};
    return {};
  }

 private:
  base::Result<void> note(const std::string& what) {
    if (broken) return *broken;
    asked.push_back(what);
    return {};
  }
  const std::string id_ = "42";
  std::int64_t wanted_ = 0;
};

}  // namespace tools::test
