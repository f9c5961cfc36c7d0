// Ifaces that one thread sleeps on, until one of them publishes. One thread at a time; the segments stay mapped as long as they are
// watched.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "shm/segment.h"

namespace gateway {

using SharedSegment = std::shared_ptr<const shm::Segment>;

class WatchedIfaces {
 public:
  // Exactly these from now on. What has been seen of new ones is not known: the next take_news() is true if there are any.
  void replace(const std::vector<SharedSegment>& segments);
  // Whether one has published since the last call.
  bool take_news();
  // Until one has published after take_news(), until `word` is no longer `value`, or for the time. Returns early at times.
  void sleep(const std::uint32_t& word, std::uint32_t value, std::chrono::nanoseconds time) const;

 private:
  struct Watched {
    SharedSegment segment;
    std::uint32_t seen;  // value of the wake word
  };
  std::vector<Watched> watched_;
  bool is_new_ = false;
};

}  // namespace gateway
