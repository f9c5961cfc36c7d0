#include "base/interrupt.h"

#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <utility>

namespace base {
namespace {

std::atomic<bool> interrupted{false};
std::atomic<int> handle{-1};

void note(int) {
  const int saved = errno;
  interrupted.store(true, std::memory_order_relaxed);
  const std::uint64_t one = 1;
  static_cast<void>(!write(handle.load(std::memory_order_relaxed), &one, sizeof one));
  errno = saved;
}

}  // namespace

void catch_interrupts() {
  if (handle.load() < 0) handle.store(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  struct sigaction action {};
  action.sa_handler = note;
  sigemptyset(&action.sa_mask);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaction(number, &action, nullptr);
}

bool is_interrupted() { return interrupted.load(std::memory_order_relaxed); }

int interrupt_handle() { return handle.load(std::memory_order_relaxed); }

OnInterrupt::OnInterrupt(std::function<void()> act)
    : end_(::eventfd(0, EFD_CLOEXEC)), thread_([this, act = std::move(act)] {
        pollfd handles[2] = {{interrupt_handle(), POLLIN, 0}, {end_, POLLIN, 0}};
        while (::poll(handles, 2, -1) < 0 && errno == EINTR) continue;
        if (handles[0].revents != 0) act();
      }) {}

OnInterrupt::~OnInterrupt() {
  (void)::eventfd_write(end_, 1);
  thread_.join();
  ::close(end_);
}

}  // namespace base
