#include "common/alarm.h"

#include <errno.h>
#include <linux/futex.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <climits>
#include <utility>

#include "shm/futex.h"
#include "shm/words.h"

namespace gateway {
namespace {

constexpr std::size_t max_futexes = 128;            // that the kernel lets one thread sleep on
constexpr std::chrono::milliseconds look_again{2};  // where it cannot sleep on all of them

std::uint32_t wake_word(const shm::Segment& segment) { return shm::load(segment.header().wake_word, std::memory_order_seq_cst); }

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
  std::vector<Watched> watched;
  while (true) {
    const std::uint32_t control = shm::load(control_, std::memory_order_seq_cst);
    bool is_news = false;
    auto next = std::exchange(*next_.lock(), {});
    if (next.is_over) return;
    if (next.segments) {
      watched.clear();
      // Nobody knows what the loop has seen of new ones: it is told once.
      for (auto& segment : *next.segments) watched.push_back({segment, wake_word(*segment)});
      is_news = !watched.empty();
    }
    for (Watched& one : watched) {
      const std::uint32_t word = wake_word(*one.segment);
      is_news = is_news || word != one.seen;
      one.seen = word;
      shm::announce(one.segment->header().waiting, word);
    }
    const std::uint64_t one = 1;
    if (is_news && ::write(descriptor_, &one, sizeof one) < 0 && errno != EAGAIN) return;
    sleep(watched, control);
  }
}

// Until a word is no longer what it was, or for a moment.
void Alarm::sleep(const std::vector<Watched>& watched, std::uint32_t control) const {
  futex_waitv words[max_futexes] = {};
  unsigned count = 0;
  const auto add = [&](const std::uint32_t& word, std::uint32_t value) {
    words[count].uaddr = reinterpret_cast<std::uintptr_t>(&word);
    words[count].val = value;
    words[count].flags = FUTEX_32;
    ++count;
  };
  add(control_, control);
  if (watched.size() < max_futexes) {
    for (const Watched& one : watched) add(one.segment->header().wake_word, one.seen);
    if (::syscall(SYS_futex_waitv, words, count, 0, nullptr, 0) >= 0 || errno == EAGAIN || errno == EINTR) return;
  }
  // More than the kernel takes, or a kernel (or its guard) that does not know the call.
  shm::futex_wait(control_, control, watched.empty() ? std::chrono::milliseconds(1000) : look_again);
}

}  // namespace gateway
