// A queue of samples from the threads of DDS to the event loop, with an eventfd or a callback that signals that it is not empty. It is
// limited in number and size; samples beyond the limit are counted. put() belongs to any thread, the rest to one at a time.
#pragma once

#include <errno.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>
#include <functional>
#include <utility>
#include <variant>
#include <vector>

#include "base/guarded.h"
#include "dds/participant.h"

namespace ros2 {

struct Matched {
  std::uint64_t endpoint;
  Guid peer;
  bool is_matched;
};
struct Sampled {
  std::uint64_t endpoint;
  Received sample;
};

class Inbox {
 public:
  static constexpr std::size_t max_waiting_bytes = std::size_t{64} << 20, max_waiting = 20000;

  Inbox() : descriptor_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}
  ~Inbox() { ::close(descriptor_); }
  Inbox(const Inbox&) = delete;
  Inbox& operator=(const Inbox&) = delete;

  // Before the first event.
  void call(std::function<void()> on_news) { on_news_ = std::move(on_news); }

  using Event = std::variant<Matched, Sampled, Peer>;
  struct Content {
    std::vector<Event> events;
    std::size_t bytes = 0;
    std::uint64_t refused = 0;
  };

  void put(Event event) {
    {
      auto content = content_.lock();
      if (const auto* sampled = std::get_if<Sampled>(&event)) {
        const std::size_t size = sampled->sample.bytes.size();
        if (content->events.size() >= max_waiting || content->bytes + size > max_waiting_bytes) {
          ++content->refused;
          return;
        }
        content->bytes += size;
      }
      content->events.push_back(std::move(event));
    }
    if (on_news_) return on_news_();
    const std::uint64_t one = 1;
    while (::write(descriptor_, &one, sizeof one) < 0 && errno == EINTR) {
    }
  }
  std::vector<Event> take() {
    std::uint64_t count = 0;
    while (!on_news_ && ::read(descriptor_, &count, sizeof count) < 0 && errno == EINTR) {
    }
    std::vector<Event> events;
    auto content = content_.lock();
    content->bytes = 0;
    content->events.swap(events);
    return events;
  }
  int descriptor() const { return descriptor_; }
  std::uint64_t refused() const { return content_.lock()->refused; }

 private:
  int descriptor_;
  std::function<void()> on_news_;
  base::Guarded<Content, base::Rank::queue> content_;
};

}  // namespace ros2
