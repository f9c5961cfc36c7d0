#include "shm/process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>

#include "base/guarded.h"

namespace shm {
namespace {

// A small file of /proc in one piece; empty when it can't be read.
std::string slurp(const char* path) {
  const int file = ::open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  char buffer[1024];
  const ssize_t got = ::read(file, buffer, sizeof buffer);
  ::close(file);
  return got > 0 ? std::string(buffer, static_cast<std::size_t>(got)) : std::string();
}

struct Stat {
  char state = 0;  // 0: no such process
  std::uint64_t start_time = 0;
};

// The name in field 2 may hold blanks and brackets, so fields are counted from the last bracket on.
Stat read_stat(pid_t pid) {
  char path[64];
  std::snprintf(path, sizeof path, "/proc/%d/stat", pid);
  const std::string text = slurp(path);
  const auto bracket = text.rfind(')');
  if (bracket == std::string::npos || bracket + 2 >= text.size()) return {};
  Stat stat;
  stat.state = text[bracket + 2];
  std::size_t at = bracket + 2;
  for (int field = 3; field < 22 && at != std::string::npos; ++field) at = text.find(' ', at + 1);
  if (at != std::string::npos) stat.start_time = std::strtoull(text.c_str() + at + 1, nullptr, 10);
  return stat;
}

std::uint32_t own_namespace() {
  struct stat status {};
  return ::stat("/proc/self/ns/pid", &status) == 0 ? static_cast<std::uint32_t>(status.st_ino) : 0;
}

std::int64_t read_clock(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

ProcessMark own_mark() {
  const pid_t pid = getpid();
  return {pid, own_namespace(), read_stat(pid).start_time};
}

const std::string& own_program() {
  static const std::string name = [] {
    std::string text = slurp("/proc/self/comm");
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
  }();
  return name;
}

const std::array<std::uint8_t, 16>& boot_id() {
  static const std::array<std::uint8_t, 16> id = [] {
    std::array<std::uint8_t, 16> bytes{};
    const std::string text = slurp("/proc/sys/kernel/random/boot_id");
    std::size_t digit = 0;
    for (char c : text) {
      const bool is_digit = c >= '0' && c <= '9';
      if ((!is_digit && !(c >= 'a' && c <= 'f')) || digit >= 32) continue;
      const int value = is_digit ? c - '0' : c - 'a' + 10;
      bytes[digit / 2] = static_cast<std::uint8_t>(bytes[digit / 2] * 16 + value);
      ++digit;
    }
    return bytes;
  }();
  return id;
}

bool is_alive(const ProcessMark& mark) {
  static const std::uint32_t here = own_namespace();
  if (mark.pid <= 0) return false;
  if (mark.pid_namespace != 0 && here != 0 && mark.pid_namespace != here) return true;
  const Stat stat = read_stat(mark.pid);
  if (stat.state == 0) return ::kill(mark.pid, 0) == 0 || errno == EPERM;  // no /proc: the pid must do
  if (stat.state == 'Z' || stat.state == 'X') return false;
  return mark.start_time == 0 || stat.start_time == mark.start_time;
}

// The pid may be another process's by now: the pidfd holds whom it has, and then the mark is looked at.
ProcessLife::ProcessLife(const ProcessMark& mark) : mark_(mark) {
  const bool is_here = mark.pid > 0 && mark.start_time != 0 && mark.pid_namespace == own_namespace();
  if (!is_here) return;
  base::FileHandle pidfd(static_cast<int>(::syscall(SYS_pidfd_open, mark.pid, 0)));
  if (pidfd.get() >= 0 && shm::is_alive(mark)) pidfd_ = std::move(pidfd);
}

bool ProcessLife::is_alive() const {
  if (pidfd_.get() < 0) return shm::is_alive(mark_);
  pollfd ended{pidfd_.get(), POLLIN, 0};
  const int told = ::poll(&ended, 1, 0);
  if (told == 0) return true;
  return (ended.revents & POLLIN) == 0 && shm::is_alive(mark_);
}

std::shared_ptr<const ProcessLife> ProcessLife::of(const ProcessMark& mark) {
  using Known = std::map<ProcessKey, std::weak_ptr<const ProcessLife>>;
  // Never destroyed: threads may still ask at the very end.
  static auto& known = *new base::Guarded<Known, base::Rank::peers>;
  const ProcessKey key = key_of(mark);
  if (auto life = (*known.lock())[key].lock()) return life;
  auto made = std::make_shared<const ProcessLife>(mark);
  auto all = known.lock();
  std::erase_if(*all, [](const auto& entry) { return entry.second.expired(); });
  auto& place = (*all)[key];
  auto life = place.lock();  // another thread's, made meanwhile
  if (!life) place = life = std::move(made);
  return life;
}

std::uint64_t make_owner() {
  static std::atomic<std::uint32_t> next{1};
  std::uint32_t number = next.fetch_add(1, std::memory_order_relaxed);
  return (static_cast<std::uint64_t>(getpid()) << 32) | number;
}

std::int64_t monotonic_ns() { return read_clock(CLOCK_MONOTONIC); }
std::int64_t wall_ns() { return read_clock(CLOCK_REALTIME); }

}  // namespace shm
