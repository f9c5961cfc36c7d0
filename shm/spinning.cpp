#include "shm/spinning.h"

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <thread>

namespace shm {

using std::chrono::nanoseconds;

namespace {

// One descriptor for a process, whose components can be many.
int load_of_this_machine() {
  static const int file = open("/proc/loadavg", O_RDONLY | O_CLOEXEC);
  return file;
}

}  // namespace

void give_way() { sched_yield(); }

std::size_t processors() {
  static const std::size_t count = std::max(1U, std::thread::hardware_concurrency());
  return count;
}

FreeProcessors::FreeProcessors()
    : file_(load_of_this_machine()), is_file_own_(false), all_(static_cast<double>(processors())), wanted_(all_) {}

FreeProcessors::FreeProcessors(const char* file, std::size_t all)
    : file_(open(file, O_RDONLY | O_CLOEXEC)), is_file_own_(true), all_(static_cast<double>(all)), wanted_(all_) {}

FreeProcessors::~FreeProcessors() {
  if (is_file_own_ && file_ >= 0) close(file_);
}

void FreeProcessors::look(std::chrono::steady_clock::time_point now, std::size_t taking_part) {
  if (!is_due(now)) return;
  next_look_ = now + pause;
  std::array<char, 128> text{};
  unsigned running = 0;  // after three averages: "0.15 0.22 0.30 2/345 6789"
  if (pread(file_, text.data(), text.size() - 1, 0) <= 0 || std::sscanf(text.data(), "%*s %*s %*s %u/", &running) != 1) return;
  constexpr double weight = 0.25;
  const auto known = static_cast<double>(taking_part) + 1;
  wanted_ += weight * (std::max(running - known, 0.0) - wanted_);
}

bool FreeProcessors::are_there_for(std::size_t others) const {
  constexpr double now_and_then = 0.4;  // processors that are wanted now and then do not count
  return wanted_ + static_cast<double>(others) + 1 <= all_ + now_and_then;
}

nanoseconds SpinLimit::next() const {
  constexpr nanoseconds margin = std::chrono::microseconds(20);
  const nanoseconds limit = 2 * usual_ + margin;
  return usual_ + margin > most_ ? nanoseconds(0) : std::min(limit, most_);
}

void SpinLimit::took(nanoseconds wait) {
  constexpr int weight = 8;
  usual_ += (std::min(wait, 4 * most_) - usual_) / weight;  // a very long wait is forgotten as soon as others
}

void WakeAhead::began(nanoseconds since, bool is_awake) {
  constexpr std::uint32_t retry_ticks = 32;  // ticks before a later wake-up is tried
  if (since > longest) {
    --steps_;
  } else if (!is_awake) {
    steps_ = std::min(steps_ + 1, max_steps);
  } else if (++count_ % retry_ticks == 0) {
    steps_ = std::max<std::int64_t>(steps_ - 1, 1);
  }
}

void WakeAhead::began() {
  constexpr std::uint32_t pause = 64;
  if (++count_ % pause == 0) steps_ = 1;
}

}  // namespace shm
