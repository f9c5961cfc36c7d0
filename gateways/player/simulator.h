// The simulator that the gateway shows, with its real time. One thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/async_requests.h"
#include "common/simulator_link.h"
#include "mapping.h"
#include "real_time.h"

namespace gateway {

// Since it was published.
std::chrono::nanoseconds age_of(const shm::Stamp& stamp);

class Simulator final : public SimulatorLink {
 public:
  // `on_list` is called with what there is each time that is known anew, `on_loss` when the simulator has ended.
  Simulator(std::uint32_t server_id, AsyncRequests& async_requests, RealTime& real_time,
            std::function<void(const std::vector<ListedIface>&)> on_list, std::function<void()> on_loss);

 private:
  void on_met() override;
  void on_sample() override;
  void list() override;

  AsyncRequests& async_requests_;
  RealTime& real_time_;
  const std::function<void(const std::vector<ListedIface>&)> on_list_;
};

}  // namespace gateway
