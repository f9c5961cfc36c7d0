// The connection of a component to one iface: attaches, reads, and attaches again after a restart of the simulator. One thread at a time.
//
// States: detached -> attached -> lost -> attached ... -> detached. What happens is said once per change, never per sample.
#pragma once

#include <shm/client.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace iface {

struct Device {
  int server_id = 0;
  std::string device_id;  // name of the iface, e.g. pioneer2dx::laser
  bool operator==(const Device&) const = default;
};

// One line for the log; is_problem tells a warning from good news.
using Say = std::function<void(bool is_problem, const std::string& line)>;

class IfaceLink {
 public:
  IfaceLink(shm::IfaceType type, Say say);

  // Fails with a line that names what there is instead.
  base::Result<void> attach(const Device& device, bool subscribe);
  void detach();
  const Device& device() const { return device_; }
  // How often it has attached, also by itself to a simulator that came back: what was told to the one before is forgotten.
  std::uint64_t attachments() const { return attachments_; }

  // The iface while it lives; nullptr while it is lost. Looks for it again now and then, in simulated time
  // at every tick.
  shm::Iface* live();
  // Waits up to `limit` for a sample newer than the last one that this returned; nullptr when there is none or the iface is lost. The
  // sample is in the iface then.
  shm::Iface* fresh(std::chrono::nanoseconds limit);
  // The same for cameras: the newest frame, held.
  std::optional<shm::HeldFrame> fresh_frame(std::chrono::nanoseconds limit);

 private:
  using Clock = std::chrono::steady_clock;
  void lose(const std::string& why);
  bool wait_for_newer(shm::Iface& iface, std::chrono::nanoseconds limit);

  shm::IfaceType type_;
  Say say_;
  Device device_;
  std::optional<shm::Iface> iface_;
  bool subscribe_ = false;
  bool lost_ = false;
  std::uint64_t attachments_ = 0;
  std::uint64_t last_ = 0;
  Clock::time_point next_try_{};
};

// How long a sensor's component may wait in onExecute for the next sample: in real time so that a sample is forwarded when it comes and not
// when the context looks, in simulated time not at all.
std::chrono::nanoseconds wait_limit();

}  // namespace iface
