// Encodes new camera frames as JPEG once, for all viewers that subscribed. It has a thread of its own. A camera works while it has a
// viewer. Any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "base/guarded.h"
#include "studio/signals.h"

namespace studio {

struct PictureOrder {
  std::string iface;
  double hz = 10;  // maximum rate [Hz of wall-clock time]
};

class Pictures {
 public:
  // Both on the thread of the pictures.
  struct Tellers {
    std::function<void(WatchKey, std::string)> picture;  // the frame 0x83
    std::function<void(WatchKey, std::string)> problem;  // an event "values" with an error
  };

  Pictures(std::uint32_t server_id, Tellers tell);
  ~Pictures();
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;

  void watch(const WatchKey& key, PictureOrder order);
  void unwatch(const WatchKey& key);
  void unwatch_all(std::uint64_t viewer);

 private:
  class Camera;
  using Clock = std::chrono::steady_clock;
  struct Data {
    std::map<WatchKey, PictureOrder> orders;
    bool is_ending = false;
  };
  struct Shown {
    Clock::time_point next{};
    std::uint64_t sequence = 0;
    std::string problem;
  };
  void run();
  void show(const std::map<WatchKey, PictureOrder>& orders);

  const std::uint32_t server_id_;
  const Tellers tell_;
  // The thread's:
  std::map<std::string, std::unique_ptr<Camera>> cameras_;  // by iface
  std::map<WatchKey, Shown> shown_;
  base::Guarded<Data, base::Rank::manager> data_;
  std::condition_variable changed_;
  std::thread thread_;  // last: it uses all of these
};

}  // namespace studio
