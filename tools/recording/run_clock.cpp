#include "recording/run_clock.h"

#include <cstdlib>
#include <optional>

#include "base/guarded.h"
#include "base/text.h"
#include "shm/client.h"

namespace recorder {

struct RunClock::State {
  struct Data {
    std::optional<shm::Iface> simulation;
    std::chrono::nanoseconds last{0};
  };
  base::Guarded<Data, base::Rank::noted> data;
};

RunClock::RunClock(std::uint32_t server_id) : state_(std::make_unique<State>()) {
  auto simulation = shm::Iface::open(server_id, shm::IfaceType::simulation, "world");
  if (simulation) state_->data.lock()->simulation.emplace(std::move(*simulation));
}

RunClock::~RunClock() = default;

std::chrono::nanoseconds RunClock::now() const {
  auto data = state_->data.lock();
  if (!data->simulation) return base::SystemClock().now();
  if (data->simulation->read()) {
    data->last = std::chrono::nanoseconds(data->simulation->sample<shm::SimulationSample>().stamp.sim_time_ns);
  }
  return data->last;
}

bool RunClock::is_simulated() const { return state_->data.lock()->simulation.has_value(); }

bool RunClock::is_lockstep() const {
  auto data = state_->data.lock();
  return data->simulation && data->simulation->info<shm::SimulationInfo>().lockstep != 0;
}

std::uint32_t default_server_id() {
  const char* text = std::getenv("RTMSIM_SERVER_ID");
  return static_cast<std::uint32_t>(base::parse_integer(text ? text : "0").value_or(0));
}

}  // namespace recorder
