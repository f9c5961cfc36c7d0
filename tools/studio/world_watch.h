// Reads a simulator through its shared memory on a thread of its own: poses, clock, models. It reconnects after a restart. It does not
// participate in the lock step, and no process waits for it. Any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/guarded.h"
#include "shm/request_board.h"
#include "studio/client_message.h"

namespace studio {

struct Poses {
  std::uint32_t version = 0;  // of the scene
  std::chrono::nanoseconds time{0};
  std::vector<float> numbers;  // seven for each link, see PoseBoard
};

// All are called on the thread of the watch.
struct WorldCallbacks {
  std::function<void(std::string)> world;  // the event "world"
  std::function<void(std::string)> time;   // the event "time"
  std::function<void(std::chrono::nanoseconds)> clock;
  std::function<void(std::shared_ptr<const Poses>)> poses;  // empty: there is no world
};

class WorldWatch {
 public:
  WorldWatch(std::uint32_t server_id, WorldCallbacks tell);
  ~WorldWatch();
  WorldWatch(const WorldWatch&) = delete;
  WorldWatch& operator=(const WorldWatch&) = delete;

  // Nobody sees it: the simulator is left alone.
  void set_watched(bool is_watched);
  // Something was done to the world: look at once.
  void look_now();

 private:
  using Clock = std::chrono::steady_clock;
  struct Data {
    bool is_watched = false, is_hurried = false, is_ending = false;
  };
  void run();
  bool sleep();  // false: the end
  void attach();
  void detach(const std::string& problem);
  std::string exit_text() const;
  void look();
  void look_at_poses(bool is_hurried);
  void look_at_world();
  void tell_time();

  const std::uint32_t server_id_;
  const WorldCallbacks tell_;
  // The thread's:
  std::optional<shm::Requester> simulator_;
  std::string told_world_, told_time_;
  std::uint64_t seen_sample_ = 0;  // of the clock
  std::uint32_t version_ = 0;
  bool has_poses_ = true;  // the simulator knows the request
  bool was_hurried_ = false;
  Clock::time_point poses_at_{}, world_at_{}, time_at_{}, next_{};
  base::Guarded<Data, base::Rank::manager> data_;
  std::condition_variable changed_;
  std::thread thread_;  // last: it uses all of these
};

}  // namespace studio
