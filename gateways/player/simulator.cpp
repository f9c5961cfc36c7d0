#include "simulator.h"

#include <time.h>
#include <unistd.h>

#include <chrono>
#include <utility>

#include "shm/process.h"

namespace gateway {
namespace {

// Of the process that serves it.
std::chrono::nanoseconds age_of(const shm::Iface& iface) {
  const std::uint64_t ticks = iface.segment().header().server.start_time;
  timespec now{};
  if (ticks == 0 || ::clock_gettime(CLOCK_BOOTTIME, &now) != 0) return {};
  const double age = static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) -
                     static_cast<double>(ticks) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(age));
}

}  // namespace

std::chrono::nanoseconds age_of(const shm::Stamp& stamp) { return std::chrono::nanoseconds(shm::wall_ns() - stamp.wall_time_ns); }

Simulator::Simulator(std::uint32_t server_id, AsyncRequests& async_requests, RealTime& real_time,
                     std::function<void(const std::vector<ListedIface>&)> on_list, std::function<void()> on_loss)
    : SimulatorLink(server_id, "player-gateway", std::move(on_loss)),
      async_requests_(async_requests),
      real_time_(real_time),
      on_list_(std::move(on_list)) {}

void Simulator::on_met() {
  auto& iface = clock()->iface();
  if (!iface.read()) return;
  const auto& sample = iface.sample<shm::SimulationSample>();
  real_time_.begin(std::chrono::steady_clock::now(), age_of(iface), sample.paused != 0, sample.steps > 0);
}

void Simulator::on_sample() {
  const auto& sample = clock()->iface().sample<shm::SimulationSample>();
  real_time_.see(std::chrono::steady_clock::now(), sample.paused != 0, age_of(sample.stamp));
}

void Simulator::list() {
  async_requests_.post(shm::ListRequest{}, [this, met = met()](const base::Result<shm::Reply>& reply) {
    auto ifaces = reply ? parse_list(reply->text) : base::Result<std::vector<ListedIface>>(reply.error());
    const bool is_known = ifaces && met == this->met() && is_there();
    listed(is_known);
    if (is_known) on_list_(*ifaces);
  });
}

}  // namespace gateway
