#include "common/alarm.h"

#include <errno.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <climits>
#include <utility>

#include "shm/futex.h"
#include "shm/words.h"

namespace gateway {
namespace {

constexpr std::chrono::hours long_time{1};  // a change wakes it

}  // namespace

Alarm::Alarm() : descriptor_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)), thread_([this] { run(); }) {}

Alarm::~Alarm() {
  next_.lock()->is_over = true;
  shm::word(control_).fetch_add(1, std::memory_order_seq_cst);  // pairs with the load in run
  shm::futex_wake(control_, INT_MAX);
  thread_.join();
  ::close(descriptor_);
}

void Alarm::watch(std::vector<SharedSegment> segments) {
  {
    auto next = next_.lock();
    if (next->segments) {
      next->segments->swap(segments);  // the ones before are unmapped without the lock
    } else {
      next->segments.emplace(std::move(segments));
    }
  }
  shm::word(control_).fetch_add(1, std::memory_order_seq_cst);  // pairs with the load in run
  shm::futex_wake(control_, INT_MAX);
}

void Alarm::clear() {
  std::uint64_t count = 0;
  while (::read(descriptor_, &count, sizeof count) < 0 && errno == EINTR) {
  }
}

void Alarm::run() {
  WatchedIfaces watched;
  while (true) {
    const std::uint32_t control = shm::load(control_, std::memory_order_seq_cst);
    const auto next = std::exchange(*next_.lock(), {});
    if (next.is_over) return;
    if (next.segments) watched.replace(*next.segments);
    const std::uint64_t one = 1;
    if (watched.take_news() && ::write(descriptor_, &one, sizeof one) < 0 && errno != EAGAIN) return;
    watched.sleep(control_, control, long_time);
  }
}

}  // namespace gateway
