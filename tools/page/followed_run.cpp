#include "page/followed_run.h"

#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>

namespace page {
namespace {

using namespace std::chrono_literals;

constexpr auto period = 50ms;
constexpr auto first_work = 450ms;  // of a processor: the scene of the world
constexpr auto idle_window = 300ms;
constexpr double idle_processors = 2;  // one is left for the run

std::chrono::duration<double> used(int who) {
  rusage usage{};
  ::getrusage(who, &usage);
  return std::chrono::seconds(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         std::chrono::microseconds(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

// Since the start of the machine. 0: it does not say.
std::uint64_t idle_ticks() {
  std::ifstream in("/proc/stat");
  std::string cpu;
  std::uint64_t user = 0, nice = 0, system = 0, idle = 0;
  in >> cpu >> user >> nice >> system >> idle;
  return in ? idle : 0;
}

}  // namespace

FollowedRun::FollowedRun(double share) : share_(share), idle_ticks_(idle_ticks()) {}

RecordingState FollowedRun::wait(studio::Json& summary) {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  for (auto limit = 0ms;; limit = period) {
    while (::poll(&input, 1, static_cast<int>(limit.count())) > 0) {
      std::array<char, 4096> octets{};
      const auto count = ::read(STDIN_FILENO, octets.data(), octets.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return end(summary);
      text_.append(octets.data(), static_cast<std::size_t>(count));
    }
    if (may_work()) return RecordingState::growing;
  }
}

RecordingState FollowedRun::end(studio::Json& summary) const {
  summary = studio::Json::parse(text_, nullptr, false);
  return summary.is_object() ? RecordingState::complete : RecordingState::abandoned;
}

bool FollowedRun::may_work() {
  const auto granted = share_ * (Clock::now() - began_);
  const bool is_in_share = granted > first_work && used(RUSAGE_SELF) + used(RUSAGE_CHILDREN) < granted;
  return is_in_share || are_processors_idle();
}

bool FollowedRun::are_processors_idle() {
  const auto now = Clock::now();
  const std::chrono::duration<double> window = now - looked_;
  if (window < idle_window) return false;
  const auto ticks = idle_ticks();
  const double idle_seconds = static_cast<double>(ticks - idle_ticks_) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  looked_ = now;
  idle_ticks_ = ticks;
  return idle_seconds > idle_processors * window.count();
}

}  // namespace page
