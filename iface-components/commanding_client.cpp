#include "commanding_client.h"

#include <base/text.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace iface {
namespace {

constexpr double fastest = 1e6;  // [m/s], [rad/s]: beyond it is a fault, whatever the robot

std::string text_of(std::span<const double> values) {
  std::vector<std::string> words;
  for (const double value : values) words.push_back(std::isfinite(value) ? base::format_number(value) : std::isnan(value) ? "nan" : "inf");
  return base::join(words, ", ");
}

}  // namespace

// The component's other handle of the same iface says when it is lost and found.
CommandingClient::CommandingClient(shm::IfaceType type, Say say)
    : link_(type, [](bool, const std::string&) {}),
      world_(shm::IfaceType::simulation, [](bool, const std::string&) {}),
      say_(std::move(say)),
      values_(type == shm::IfaceType::position3d ? 6 : 3) {}

base::Result<void> CommandingClient::attach(const Device& device) {
  const auto mine = turn_.take();
  static_cast<void>(world_.attach({device.server_id, "world"}, false));  // without it no run is told from another
  return link_.attach(device, false);
}

void CommandingClient::detach() {
  const auto mine = turn_.take();
  link_.detach();
  world_.detach();
  is_driving_ = false;
}

void CommandingClient::received(std::span<const double> velocity, shm::CommandKind kind) {
  {
    const auto mine = turn_.take();
    run_of_newest_ = run();
  }
  arrivals_.fetch_add(1, std::memory_order_acq_rel);
  if (!in_simulated_time_.load(std::memory_order_acquire)) drive(velocity, kind);  // pairs with set_simulated_time
}

CommandingClient::Run CommandingClient::run() {
  auto* world = world_.live();
  if (!world || !world->read()) return {world_.attachments(), 0};
  return {world_.attachments(), world->sample<shm::SimulationSample>().stamp.resets};
}

bool CommandingClient::is_newest_of_this_run() {
  const auto mine = turn_.take();
  return run_of_newest_ == run();
}

void CommandingClient::drive(std::span<const double> velocity, shm::CommandKind kind) {
  std::string problem;
  {
    const auto mine = turn_.take();
    auto* robot = link_.live();
    if (!robot) return;
    const bool is_plausible = std::ranges::all_of(velocity, [](double v) { return std::abs(v) <= fastest; });
    const auto done =
        is_plausible
            ? robot->command(kind, velocity)
            : base::Error{"velocity (" + text_of(velocity) + "): each must be a number of at most 1e6 m/s or rad/s; it is ignored"};
    is_driving_ = is_driving_ || done.ok();
    if (!done && !refused_) problem = done.error().message;
    refused_ = !done;
  }
  if (!problem.empty()) say_(true, problem);
}

bool CommandingClient::stop() {
  const auto mine = turn_.take();
  if (!is_driving_) return false;
  is_driving_ = false;
  static constexpr std::array<double, 6> standing{};
  if (auto* robot = link_.live())
    static_cast<void>(robot->command(shm::CommandKind::velocity, std::span(standing).first(values_)));  // a dead one stands already
  return true;
}

bool CommandWatch::expired(CommandingClient& commanding_client, std::int64_t now_ns, double timeout_s) {
  const auto arrivals = commanding_client.arrivals();
  // Time that runs backwards is a reset of the world.
  if (arrivals != seen_arrivals_ || now_ns < seen_ns_) {
    seen_arrivals_ = arrivals;
    seen_ns_ = now_ns;
    return false;
  }
  if (timeout_s <= 0 || static_cast<double>(now_ns - seen_ns_) < timeout_s * 1e9) return false;
  return commanding_client.stop();
}

}  // namespace iface
