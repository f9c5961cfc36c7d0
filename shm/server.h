// The simulator side of shared memory: creates ifaces, writes the heartbeat, releases the leases of exited clients. Any thread.
//
//   auto server = shm::Server::start({.server_id = 0});
//   auto laser = (*server)->create(shm::iface_spec(shm::IfaceType::laser, "pioneer2dx::laser", info));
//   each tick:  if ((*laser)->is_subscribed()) { fill (*laser)->sample<LaserSample>() and ranges(); (*laser)->publish(sim_time); }
//   often:      (*server)->tend();
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "shm/process_watch.h"
#include "shm/segment.h"
#include "shm/specs.h"
#include "shm/writer.h"

namespace shm {

struct ServerOptions {
  std::uint32_t server_id = 0;
  Access access;
  std::uint64_t max_bytes = usual_most_bytes;  // of all ifaces together

  static constexpr std::uint64_t usual_most_bytes = std::uint64_t{1536} << 20U;
};

class Server {
 public:
  // Removes what a dead server of this id left behind. Fails when a living one has it.
  static base::Result<std::unique_ptr<Server>> start(const ServerOptions& options);
  ~Server();  // writers must be gone by then

  // The name must be free among this server's ifaces of that type. Make the simulation iface first: of several servers that start at the
  // same time with the same id, the one that gets it is the server.
  base::Result<std::unique_ptr<IfaceWriter>> create(const IfaceSpec& spec);

  // Renews heartbeats and takes leases of dead clients back. Cheap when called often: does its work at most ten times a second, or at once
  // after a death.
  void tend();
  // Names of the segments that another process has cut short since the last call (base/cut_guard.h): nobody can use them until the server
  // starts anew. One load when there are none.
  std::vector<std::string> take_cuts();
  ProcessWatch& watch();
  std::uint32_t id() const;

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace shm
