// A simulation in this process with ifaces of its own server id, stepped by hand.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include "server/simulation.h"
#include "shm/client.h"
#include "shm/server.h"
#include "support/worlds.h"

namespace sim::test {

inline std::uint32_t own_server_id() { return 1000 + static_cast<std::uint32_t>(getpid()) % 8000; }

struct SimulationFixture {
  explicit SimulationFixture(WorldDef def, std::uint64_t seed = 1, int threads = 1) {
    auto started = shm::Server::start({.server_id = own_server_id(), .access = {}});
    if (!started) throw std::runtime_error(started.error().message);
    server = std::move(*started);
    auto made =
        Simulation::create(std::make_shared<const WorldDef>(std::move(def)), *server, {.seed = seed, .threads = threads}, notes, dropped);
    if (!made) throw std::runtime_error(made.error().message);
    simulation = std::move(*made);
  }
  void run(double seconds) {
    const auto end = simulation->time() + std::chrono::nanoseconds(std::llround(seconds * 1e9));
    if (simulation->steps() == 0) simulation->sense(times);
    while (simulation->time() < end) {
      simulation->step(times);
      simulation->sense(times);
    }
  }
  shm::Iface open(shm::IfaceType type, const std::string& name) {
    auto iface = shm::Iface::open(own_server_id(), type, name);
    if (!iface) throw std::runtime_error(iface.error().message);
    if (auto subscribed = iface->subscribe(); !subscribed) throw std::runtime_error(subscribed.error().message);
    return std::move(*iface);
  }

  std::vector<std::string> notes, dropped;
  std::unique_ptr<shm::Server> server;
  std::unique_ptr<Simulation> simulation;
  PartTimes times;
};

}  // namespace sim::test
