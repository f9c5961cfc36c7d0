#include "bell.h"

#include <errno.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <utility>

#include "shm/futex.h"
#include "shm/words.h"

namespace ros2 {

Bell::Bell(std::function<void()> on_ring)
    : on_ring_(std::move(on_ring)), epoll_(::epoll_create1(EPOLL_CLOEXEC)), over_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (ring_for(over_)) thread_ = std::thread([this] { run(); });
}

Bell::~Bell() {
  const std::uint64_t one = 1;
  while (over_ >= 0 && ::write(over_, &one, sizeof one) < 0 && errno == EINTR) {
  }
  if (thread_.joinable()) thread_.join();
  if (over_ >= 0) ::close(over_);
  if (epoll_ >= 0) ::close(epoll_);
}

bool Bell::ring_for(int descriptor) {
  epoll_event one{};
  one.events = EPOLLIN | EPOLLET;
  one.data.fd = descriptor;
  return ::epoll_ctl(epoll_, EPOLL_CTL_ADD, descriptor, &one) == 0;
}

void Bell::ring() {
  shm::word(rings_).fetch_add(1, std::memory_order_seq_cst);  // pairs with the load in rings()
  shm::futex_wake(rings_, 1);
  if (on_ring_) on_ring_();
}

std::uint32_t Bell::rings() const { return shm::load(rings_, std::memory_order_seq_cst); }

void Bell::sleep(const gateway::WatchedIfaces& ifaces, std::uint32_t seen, std::chrono::nanoseconds time) const {
  ifaces.sleep(rings_, seen, time);
}

void Bell::run() {
  while (true) {
    epoll_event event{};
    const int count = ::epoll_wait(epoll_, &event, 1, -1);
    if (count < 0 && errno != EINTR) return;
    if (count == 1 && event.data.fd == over_) return;
    if (count == 1) ring();
  }
}

}  // namespace ros2
