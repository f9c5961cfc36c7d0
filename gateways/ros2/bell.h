// Wakes the event loop, which sleeps on a futex together with the ifaces that it shows, so that a step of the simulator wakes one thread
// instead of two. A thread of its own waits for file descriptors by edge-triggered epoll, and rings for them. ring() belongs to any thread,
// the rest to one at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

#include "common/watched_ifaces.h"

namespace ros2 {

class Bell {
 public:
  // `on_ring` is called at each ring, by the thread that rings.
  explicit Bell(std::function<void()> on_ring = {});
  ~Bell();
  Bell(const Bell&) = delete;
  Bell& operator=(const Bell&) = delete;

  // False when there are no file descriptors left.
  bool ring_for(int descriptor);
  void ring();
  // To be read before looking for what it may have rung for.
  std::uint32_t rings() const;
  // Until it rings again after `seen`, until an iface publishes, or for the time.
  void sleep(const gateway::WatchedIfaces& ifaces, std::uint32_t seen, std::chrono::nanoseconds time) const;

 private:
  void run();

  const std::function<void()> on_ring_;
  int epoll_ = -1, over_ = -1;
  std::uint32_t rings_ = 0;  // [atomic] futex of this process
  std::thread thread_;
};

}  // namespace ros2
