// Robots that viewers drive by hand. A drive stops if its viewer does not renew the command, or disconnects. The loop's thread only.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "shm/client.h"

namespace studio {

class Drives {
 public:
  explicit Drives(std::uint32_t server_id) : server_id_(server_id) {}

  // Three numbers for a position2d [m/s, m/s, rad/s], six for a position3d.
  base::Result<void> drive(std::uint64_t viewer, const std::string& iface, const std::vector<double>& velocity);
  void release(std::uint64_t viewer, const std::string& iface);
  void release_all(std::uint64_t viewer);
  // Stops what nobody has renewed for half a second.
  void tend();
  bool is_empty() const { return handles_.empty(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Handle {
    shm::Iface iface;
    Clock::time_point renewed;
  };
  base::Result<Handle*> handle_of(std::uint64_t viewer, const std::string& iface, shm::IfaceType type);

  const std::uint32_t server_id_;
  std::map<std::pair<std::uint64_t, std::string>, Handle> handles_;
};

}  // namespace studio
