// Notifies an event loop when ifaces have published: a thread sleeps on their futexes and makes a file descriptor readable. The public
// functions belong to one thread at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include "base/guarded.h"
#include "common/watched_ifaces.h"

namespace gateway {

class Alarm {
 public:
  Alarm();
  ~Alarm();
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  // Exactly these from now on; the segments stay mapped as long as they are watched.
  void watch(std::vector<SharedSegment> segments);
  // Readable after news; an eventfd.
  int descriptor() const { return descriptor_; }
  // Makes it unreadable; look at the ifaces afterwards.
  void clear();

 private:
  void run();

  int descriptor_ = -1;
  std::uint32_t control_ = 0;  // [atomic] futex of this process: changes when `next_` does
  struct Wish {
    std::optional<std::vector<SharedSegment>> segments;
    bool is_over = false;
  };
  base::Guarded<Wish, base::Rank::worker> next_;
  std::thread thread_;
};

}  // namespace gateway
