#include "simulation_device.h"

#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/log.h"
#include "protocol/payloads.h"
#include "simulator.h"

namespace gateway {
namespace {

constexpr std::uint8_t get_pose2d = 1, set_pose2d = 2, get_pose3d = 3, set_pose3d = 4, get_property = 5, set_property_request = 6;
constexpr std::uint8_t pause = 1, reset = 2, save = 3;

shm::Pose pose_of(const shm::Reply& reply) {
  const double* v = reply.values;
  return {v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
}

template <class T>
std::string bytes_of(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

}  // namespace

std::optional<Answer> Simulation::answer(std::uint8_t subtype, const std::string& payload, const Later& later) {
  if (subtype == get_property) return property(payload);
  if (subtype == set_property_request) return set_property(payload, later);
  const auto flat = subtype == get_pose2d || subtype == set_pose2d ? player::decode_named_pose2d(payload) : std::nullopt;
  const auto full = subtype == get_pose3d || subtype == set_pose3d ? player::decode_named_pose3d(payload) : std::nullopt;
  if (!flat && !full) return nack();
  const auto& name = flat ? flat->name : full->name;
  if (name.empty()) return nack();
  switch (subtype) {
    case get_pose2d:
      services_.async_requests.post(shm::GetPoseRequest{name}, [later, name](const base::Result<shm::Reply>& reply) {
        if (!reply) return later(nack());
        const auto pose = to_pose3d(pose_of(*reply));
        later(ack(player::encode(player::NamedPose2d{name, {pose.x, pose.y, pose.yaw}})));
      });
      return std::nullopt;
    case get_pose3d:
      services_.async_requests.post(shm::GetPoseRequest{name}, [later, name](const base::Result<shm::Reply>& reply) {
        if (!reply) return later(nack());
        later(ack(player::encode(player::NamedPose3d{name, to_pose3d(pose_of(*reply)), static_cast<double>(reply->sim_time_ns) / 1e3})));
      });
      return std::nullopt;
    case set_pose2d: {
      const auto& pose = flat->pose;
      if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.a)) return nack();
      return ask(shm::SetPoseRequest{name, shm::planar_pose(pose.x, pose.y, 0, pose.a), true}, later);
    }
    default: {
      const auto& pose = full->pose;
      for (const double value : {pose.x, pose.y, pose.z, pose.roll, pose.pitch, pose.yaw}) {
        if (!std::isfinite(value)) return nack();
      }
      return ask(shm::SetPoseRequest{name, shm::euler_pose(pose.x, pose.y, pose.z, pose.roll, pose.pitch, pose.yaw), false}, later);
    }
  }
}

// Values are raw bytes in the order of this host, as everywhere. The client copies as many bytes as it has asked for.
std::optional<Answer> Simulation::property(const std::string& payload) {
  auto request = player::decode_property(payload);
  if (!request || !iface().read()) return nack();
  const auto& clock = iface().sample<shm::SimulationSample>();
  const bool is_world = request->name == "world";
  std::string value;
  if (is_world && request->property == "sim_time") {
    value = bytes_of(static_cast<double>(clock.stamp.sim_time_ns) / 1e9);
  } else if (is_world && (request->property == "real_time" || request->property == "pause_time")) {
    const auto now = std::chrono::steady_clock::now();
    RealTime& time = services_.real_time;
    time.see(now, clock.paused != 0, age_of(clock.stamp));
    value = bytes_of(request->property == "real_time" ? time.since_start(now) : time.paused(now));
  } else if (is_world && request->property == "state") {
    value = bytes_of(static_cast<std::uint8_t>(clock.paused == 0 ? 1 : 0));
  } else if (request->property == "time") {
    value = bytes_of(static_cast<std::uint64_t>(clock.stamp.sim_time_ns / 1000));
  }
  if (value.empty() || request->value.size() < value.size()) return nack();
  value.resize(request->value.size());
  request->value = std::move(value);
  return ack(player::encode(*request));
}

// Of the world: whether it runs, and how fast.
std::optional<Answer> Simulation::set_property(const std::string& payload, const Later& later) {
  const auto request = player::decode_property(payload);
  if (!request || request->name != "world") return nack();
  if (request->property == "state" && request->value.size() == 1)
    return request->value[0] != 0 ? ask(shm::RunRequest{}, later) : ask(shm::PauseRequest{}, later);
  double factor = 0;
  if (request->property != "real_time_factor" || request->value.size() != sizeof factor) return nack();
  std::memcpy(&factor, request->value.data(), sizeof factor);
  return std::isfinite(factor) && factor >= 0 ? std::optional<Answer>(ask(shm::SetRtfRequest{factor}, later)) : nack();
}

void Simulation::obey(Client&, std::uint8_t subtype, const std::string&) {
  const auto on_reply = [](const base::Result<shm::Reply>&) {};
  if (subtype == save && !std::exchange(has_refused_to_save_, true))
    base::log(
        base::Level::warn, "player-gateway",
        "SAVE of simulation is ignored: a world is written by its author, not by the simulator; rtse record keeps what happens in it");
  if (subtype == reset) services_.async_requests.post(shm::ResetRequest{}, on_reply);
  if (subtype != pause || !iface().read()) return;
  if (iface().sample<shm::SimulationSample>().paused != 0) {
    services_.async_requests.post(shm::RunRequest{}, on_reply);
  } else {
    services_.async_requests.post(shm::PauseRequest{}, on_reply);
  }
}

}  // namespace gateway
