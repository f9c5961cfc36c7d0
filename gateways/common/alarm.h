// Tells an event loop that ifaces have published: a thread sleeps on their futexes and makes a file descriptor readable. The public
// functions belong to one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "base/guarded.h"
#include "shm/segment.h"

namespace gateway {

using SharedSegment = std::shared_ptr<const shm::Segment>;

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
  struct Watched {
    SharedSegment segment;
    std::uint32_t seen;  // value of the wake word that the loop has been told of
  };
  void run();
  void sleep(const std::vector<Watched>& watched, std::uint32_t control) const;

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
