#include "run/shm_simulator.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/text.h"
#include "shm/control.h"
#include "shm/lockstep.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

nlohmann::json parsed(const std::string& text) {
  auto json = nlohmann::json::parse(text, nullptr, false);
  return json.is_object() ? json : nlohmann::json::object();
}

// A reply of StepRequest.
std::optional<LostProcess> loss_in(const shm::Reply& reply) {
  if (reply.status != shm::RequestStatus::failed || reply.count <= 0) return std::nullopt;
  LostProcess lost{.pid = static_cast<pid_t>(reply.count), .in_tick = base::split_list(reply.text, '\n'), .time_s = reply.values[0]};
  constexpr double rounding = 1e-6;  // of ticks
  if (reply.values[1] > 0) lost.tick = static_cast<std::int64_t>(std::floor(reply.values[0] / reply.values[1] + rounding)) + 1;
  return lost;
}

class RecordSink final : public shm::PoseLogSink {
 public:
  explicit RecordSink(PoseRecord& record) : record_(record) {}
  void pose(double time, const std::string& model, const shm::Pose& p) override {
    record_.add_pose(model, {time, p.x, p.y, p.z, p.qw, p.qx, p.qy, p.qz});
  }
  void contact(double time, const std::string& model, const std::string& other) override { record_.add_contact({time, model, other}); }
  void still(double time) override { record_.add_still(time); }
  void joint(double time, const std::string& model, const std::string& joint, double position) override {
    record_.add_joint(model + "::" + joint, {time, position});
  }

 private:
  PoseRecord& record_;
};

}  // namespace

std::vector<std::string> late_participants(Simulator& simulator) {
  std::vector<std::string> late;
  for (const auto& one : simulator.participants()) {
    if (one.is_late) late.push_back(one.name);
  }
  return late;
}

std::optional<pid_t> ShmSimulator::process_of(std::uint32_t id) {
  const auto simulation = shm::Iface::open(id, shm::IfaceType::simulation, "world");
  if (!simulation || simulation->status() != shm::Status::live) return std::nullopt;
  return static_cast<pid_t>(simulation->segment().facts().server.pid);
}

Result<void> ShmSimulator::attach(std::uint32_t id, pid_t pid) {
  id_ = std::to_string(id);
  for (auto* one : {&requests_, &steps_}) {
    auto requester = shm::Requester::open(id);
    if (!requester) return requester.error();
    if (static_cast<pid_t>(requester->simulation().segment().facts().server.pid) != pid)
      return Error{"simulator " + id_ + ": is another process"};
    one->emplace(std::move(*requester));
  }
  const auto there = state();
  if (!there) return there.error();
  step_s_ = there->step_s;
  return step_s_ > 0 ? Result<void>() : Error{"simulator " + id_ + ": has no step"};
}

Result<shm::Reply> ShmSimulator::ask(const shm::Request& request, std::chrono::nanoseconds timeout) {
  if (!requests_) return Error{"simulator: has not started"};
  return shm::ask_for(*requests_, request, timeout);
}

Result<SimulatorState> ShmSimulator::state() {
  const auto reply = ask(shm::StatsRequest{}, state_timeout);
  if (!reply) return reply.error();
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(reply->hash));
  const auto& simulation = requests_->simulation();
  return SimulatorState{static_cast<pid_t>(simulation.segment().facts().server.pid),
                        static_cast<double>(simulation.info<shm::SimulationInfo>().step_ns) / 1e9, hash};
}

std::optional<SimulatedMoment> ShmSimulator::now() {
  if (!requests_) return std::nullopt;
  auto& simulation = requests_->simulation();
  if (simulation.status() != shm::Status::live || !simulation.read()) return std::nullopt;
  const auto& sample = simulation.sample<shm::SimulationSample>();
  return SimulatedMoment{static_cast<double>(sample.stamp.sim_time_ns) / 1e9, sample.steps};
}

std::vector<LockstepParticipant> ShmSimulator::participants() {
  std::vector<LockstepParticipant> all;
  const auto records = requests_ ? shm::read_participants(requests_->simulation()) : Error{"simulator: has not started"};
  if (!records) return all;
  for (const auto& one : *records)
    all.push_back({one.name, static_cast<std::int64_t>(one.phase), std::chrono::nanoseconds(one.period_ns), one.is_late});
  return all;
}

Result<std::vector<std::string>> ShmSimulator::models() {
  const auto reply = ask(shm::TreeRequest{});
  if (!reply) return reply.error();
  std::vector<std::string> names;
  for (const auto& model : parsed(reply->text).value("models", nlohmann::json::array())) names.push_back(model.value("name", ""));
  return names;
}

Result<std::vector<ModelParts>> ShmSimulator::parts() {
  const auto reply = ask(shm::TreeRequest{});
  if (!reply) return reply.error();
  std::vector<ModelParts> all;
  for (const auto& model : parsed(reply->text).value("models", nlohmann::json::array())) all.push_back(to_parts(model));
  return all;
}

Result<shm::Pose> ShmSimulator::pose(const std::string& name) {
  const auto reply = ask(shm::GetPoseRequest{name});
  if (!reply) return reply.error();
  const auto& v = reply->values;
  return shm::Pose{v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
}

Result<std::vector<ModelContact>> ShmSimulator::contacts(const std::string& model) {
  const auto reply = ask(shm::ContactsRequest{model});
  if (!reply) return reply.error();
  std::vector<ModelContact> contacts;
  for (const auto& one : parsed(reply->text).value("contacts", nlohmann::json::array()))
    contacts.push_back({one.value("link", ""), one.value("other", "")});
  return contacts;
}

Result<std::string> ShmSimulator::spawn(const ModelToSpawn& model) {
  if (!requests_) return Error{"simulator: has not started"};
  auto request = shm::spawn_request(model.source, requests_->simulation().segment().is_shared());
  if (!request) return request.error();
  request->name = model.name;
  request->has_pose = !model.pose.empty();
  if (request->has_pose) {
    const auto pose = shm::pose_of(model.pose);
    if (!pose) return pose.error();
    request->pose = *pose;
  }
  const auto reply = ask(*request);
  return reply ? Result<std::string>(reply->message) : reply.error();
}

Result<void> ShmSimulator::remove(const std::string& model) {
  const auto reply = ask(shm::DeleteRequest{model});
  return reply ? Result<void>() : reply.error();
}

Result<void> ShmSimulator::set_pose(const std::string& model, const std::vector<double>& numbers) {
  const auto request = shm::set_pose_request(model, numbers);
  if (!request) return request.error();
  const auto reply = ask(*request);
  return reply ? Result<void>() : reply.error();
}

Result<void> ShmSimulator::push(const std::string& name, const Push& push) {
  const auto& v = push.numbers;
  if (push.is_joint ? v.size() != 1 : v.size() != 3 && v.size() != 6)
    return Error{"push: expected FX FY FZ or FX FY FZ TX TY TZ, of a joint one number, got " + std::to_string(v.size()) + " numbers"};
  shm::WrenchRequest request;
  request.name = name;
  request.is_joint = push.is_joint;
  std::copy_n(v.begin(), push.is_joint ? 1 : 3, request.force);
  if (v.size() == 6) std::copy_n(v.begin() + 3, 3, request.torque);
  request.duration = push.stays ? shm::WrenchRequest::until_the_next : push.duration_s;
  const auto reply = ask(request);
  return reply ? Result<void>() : reply.error();
}

Result<void> ShmSimulator::screenshot(const std::string& file, std::uint32_t pixels) {
  if (!requests_) return Error{"simulator: has not started"};
  shm::ScreenshotRequest view;
  view.width = view.height = pixels;
  view.view = shm::ScreenshotRequest::View::top;
  view.with_scans = true;
  return shm::write_screenshot(*requests_, view, file, picture_timeout);
}

Result<void> ShmSimulator::begin_steps(std::int64_t steps, bool is_paced) {
  if (!steps_) return Error{"simulator: has not started"};
  const auto begun = steps_->begin(shm::StepRequest{.steps = steps, .is_paced = is_paced, .ends_at_death = true});
  loss_.reset();
  are_steps_under_way_ = begun.ok();
  return begun;
}

Result<bool> ShmSimulator::await_steps(std::chrono::milliseconds timeout) {
  if (!steps_) return Error{"simulator: has not started"};
  if (loss_) return loss_error_;
  auto reply = steps_->await(timeout);
  if (!reply) return reply.error();
  if (!*reply) return false;
  are_steps_under_way_ = false;
  const auto loss = loss_in(**reply);
  const auto done = shm::without_refusal(shm::StepRequest{}, std::move(**reply));
  if (done) return true;
  loss_ = loss;
  return loss_error_ = done.error();
}

std::optional<LostProcess> ShmSimulator::await_loss(std::chrono::milliseconds timeout) {
  if (are_steps_under_way_) (void)await_steps(timeout);
  return loss_;
}

Result<void> ShmSimulator::read_events(PoseRecord& record) {
  RecordSink sink(record);
  for (;;) {
    shm::PoseLogRequest request{.from = log_read_};
    if (joints_of_log_ != record.wanted_joints)
      request.joints = base::join({record.wanted_joints.begin(), record.wanted_joints.end()}, "\n");
    const auto reply = ask(request);
    if (!reply) return reply.error();
    joints_of_log_ = record.wanted_joints;
    log_read_ += static_cast<std::int64_t>(reply->text.size());
    if (const auto read = log_.read(reply->text, sink); !read) return read;
    if (log_read_ >= reply->count || reply->text.empty()) return {};
  }
}

}  // namespace tools
