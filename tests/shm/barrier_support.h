// A barrier with its server, and participants in threads of their own.
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "shm/lockstep.h"
#include "shm/shm_support.h"

namespace shm::test {

using State = Participant::State;

struct BarrierFixture : Fixture {
  std::unique_ptr<IfaceWriter> simulation;
  std::vector<BarrierEvent> events;
  std::unique_ptr<Barrier> barrier;
  std::uint64_t steps = 0;

  explicit BarrierFixture(BarrierOptions options = {}, std::uint32_t places = 16)
      : simulation(make(simulation_spec(simulation_info(), 4, places))) {
    options.on_event = [this](const BarrierEvent& event) { events.push_back(event); };
    barrier = std::make_unique<Barrier>(*simulation, *server, std::move(options));
  }
  Participant join(const std::string& name, std::uint32_t phase = 1, std::chrono::nanoseconds period = 10ms) {
    auto participant = Participant::join(id, {name, phase, period});
    if (!participant) throw std::runtime_error(participant.error().message);
    return std::move(*participant);
  }
  int count(BarrierEvent::Kind kind) const {
    return static_cast<int>(std::count_if(events.begin(), events.end(), [kind](const auto& e) { return e.kind == kind; }));
  }
};

// A participant in a thread of its own that does `work` in each tick until the simulation closes.
template <class Work>
std::thread run(Participant participant, Work work) {
  return std::thread([participant = std::move(participant), work]() mutable {
    Tick tick;
    while (participant.wait(tick, 60s) == State::tick) work(tick);
  });
}

}  // namespace shm::test
