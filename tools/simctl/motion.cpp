// Requests about how things move: velocity and wrench of models, odometry and motors of robots, the speed of time.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "simctl/simctl.h"

namespace simctl {

using Json = nlohmann::ordered_json;

namespace {

void show_velocity(Control& control, const std::string& name) {
  const auto reply = control.ask(shm::GetVelocityRequest{name});
  if (!reply) return;
  const auto& v = reply->values;
  if (control.json()) return control.print({{"model", name}, {"linear", {v[0], v[1], v[2]}}, {"angular", {v[3], v[4], v[5]}}});
  std::printf("%.6f %.6f %.6f m/s  %.6f %.6f %.6f rad/s\n", v[0], v[1], v[2], v[3], v[4], v[5]);
}

// Returns at that simulated time, and at once where time stands still, since only others can make it go on.
void await_time(Control& control, std::int64_t end_ns) {
  auto simulation = control.open(shm::IfaceType::simulation, "world");
  if (!simulation) return;
  catch_interrupts();
  std::optional<std::uint32_t> resets;
  while (!is_interrupted() && simulation->read()) {
    const auto& now = simulation->sample<shm::SimulationSample>();
    if (!resets) resets = now.stamp.resets;
    if (now.stamp.sim_time_ns >= end_ns || now.stamp.resets != *resets || now.paused != 0 || now.waiting_for != 0) return;
    if (simulation->wait(now.stamp.sequence, std::chrono::milliseconds(100)) == shm::Wait::closed)
      return control.fail("the simulator has exited");
  }
}

}  // namespace

bool is_position_iface(std::uint32_t server_id, const std::string& name) {
  for (const auto& found : shm::find_segments(server_id)) {
    const std::string type(shm::to_text(found.name.type));
    const bool is_position = shm::row_of(found.name.type).command_values > 0;
    if (is_position && (found.name.iface == name || type + ":" + found.name.iface == name)) return true;
  }
  return false;
}

void model_velocity(Control& control, const std::string& model, const std::vector<double>& v) {
  if (v.empty()) return show_velocity(control, model);
  shm::SetVelocityRequest request;
  request.model = model;
  if (v.size() == 3) {
    request.linear[0] = v[0], request.linear[1] = v[1], request.angular[2] = v[2];
  } else if (v.size() == 6) {
    std::copy(v.begin(), v.begin() + 3, request.linear);
    std::copy(v.begin() + 3, v.end(), request.angular);
  } else {
    return control.reject("velocity of a model: expected VX VY VA or VX VY VZ WX WY WZ, got " + std::to_string(v.size()) + " numbers");
  }
  control.ask(request);
}

void wrench(Control& control, const Pushed& what, const std::vector<double>& v, double seconds) {
  shm::WrenchRequest request;
  request.is_joint = !what.joint.empty();
  request.name = request.is_joint ? what.name + "::" + what.joint : what.name;
  std::copy(v.begin(), v.begin() + (request.is_joint ? 1 : 3), request.force);
  if (v.size() == 6) std::copy(v.begin() + 3, v.end(), request.torque);
  request.duration = seconds;
  const auto reply = control.ask(request);
  if (reply && seconds > 0) await_time(control, reply->sim_time_ns + std::llround(seconds * 1e9));
}

void reset_odometry(Control& control, const std::string& iface, const std::vector<double>& v) {
  shm::ResetOdometryRequest request;
  request.iface = iface;
  if (v.size() == 3) request.x = v[0], request.y = v[1], request.a = v[2];
  control.ask(request);
}

}  // namespace simctl
