#include "run/interrupt.h"

#include <signal.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>

namespace editor {
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

}  // namespace editor
