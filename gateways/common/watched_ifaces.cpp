#include "common/watched_ifaces.h"

#include <errno.h>
#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "shm/futex.h"
#include "shm/words.h"

namespace gateway {
namespace {

constexpr std::size_t max_futexes = 128;            // that the kernel lets one thread sleep on
constexpr std::chrono::milliseconds look_again{2};  // where it cannot sleep on all of them

std::uint32_t wake_word(const shm::Segment& segment) { return shm::load(segment.header().wake_word, std::memory_order_seq_cst); }

timespec moment_in(std::chrono::nanoseconds time) {
  const auto end = std::chrono::steady_clock::now().time_since_epoch() + time;  // the steady clock is CLOCK_MONOTONIC
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(end);
  return {seconds.count(), std::chrono::nanoseconds(end - seconds).count()};
}

}  // namespace

void WatchedIfaces::replace(const std::vector<SharedSegment>& segments) {
  watched_.clear();
  for (const auto& segment : segments) watched_.push_back({segment, wake_word(*segment)});
  is_new_ = !watched_.empty();
}

bool WatchedIfaces::take_news() {
  bool is_news = std::exchange(is_new_, false);
  for (Watched& one : watched_) {
    const std::uint32_t word = wake_word(*one.segment);
    is_news = is_news || word != one.seen;
    one.seen = word;
    shm::announce(one.segment->header().waiting, word);
  }
  return is_news;
}

void WatchedIfaces::sleep(const std::uint32_t& word, std::uint32_t value, std::chrono::nanoseconds time) const {
  if (is_new_) return;
  if (watched_.empty()) return shm::futex_wait(word, value, time);
  std::array<futex_waitv, max_futexes> words;  // unused ones are not initialized, because this runs in each step
  unsigned count = 0;
  const auto add = [&](const std::uint32_t& one, std::uint32_t expected) {
    words[count++] = {.val = expected, .uaddr = reinterpret_cast<std::uintptr_t>(&one), .flags = FUTEX_32, .__reserved = 0};
  };
  add(word, value);
  if (watched_.size() < max_futexes) {
    for (const Watched& one : watched_) add(one.segment->header().wake_word, one.seen);
    const timespec end = moment_in(time);
    if (::syscall(SYS_futex_waitv, words.data(), count, 0, &end, CLOCK_MONOTONIC) >= 0) return;
    if (errno == EAGAIN || errno == EINTR || errno == ETIMEDOUT) return;
  }
  // More than the kernel takes, or a kernel (or its guard) that does not know the call.
  shm::futex_wait(word, value, std::min<std::chrono::nanoseconds>(time, look_again));
}

}  // namespace gateway
