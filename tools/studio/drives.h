// Robots and joints that viewers move by hand. A drive stops and joints brake if their viewer does not renew the command, or disconnects.
// The loop's thread only.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"
#include "shm/client.h"

namespace studio {

// What one joint of an iface is to do.
struct JointCommand {
  std::string joint;
  std::string mode;  // one of joint_modes()
  double value = 0;  // [rad or m; rad/s or m/s; N m or N]; not of free and brake
};
// position, velocity, effort, free, brake.
std::span<const std::string_view> joint_modes();

class Drives {
 public:
  explicit Drives(std::uint32_t server_id) : server_id_(server_id) {}

  // Three numbers for a position2d [m/s, m/s, rad/s], six for a position3d.
  base::Result<void> drive(std::uint64_t viewer, const std::string& iface, const std::vector<double>& velocity);
  // Joints that are not named keep what this viewer commanded last.
  base::Result<void> move_joints(std::uint64_t viewer, const std::string& iface, std::span<const JointCommand> commands);
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
