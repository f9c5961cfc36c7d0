#include "base/cut_guard.h"

#include <signal.h>
#include <sys/mman.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>

namespace base {
namespace {

// Read by the signal handler, which may interrupt any line of any thread: no lock, no memory that moves. Untouched pages cost nothing.
struct Slot {
  std::atomic<bool> is_taken;
  std::atomic<std::uintptr_t> begin;  // 0 = nothing to guard
  std::atomic<std::size_t> size;
  std::atomic<bool> is_cut;
};
constexpr std::size_t no_slot = 65536;
std::array<Slot, no_slot> slots;
std::atomic<std::size_t> used{0};  // slots from here on have never been used
std::atomic<std::size_t> hint{0};  // where a free slot is looked for first; any value is right
std::atomic<std::size_t> cut_count{0};
struct sigaction before {};

void on_bus_error(int signal, siginfo_t* info, void* context) {
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  const std::size_t end = used.load(std::memory_order_acquire);  // pairs with the release in CutGuard
  for (std::size_t i = 0; i < end; ++i) {
    const std::uintptr_t begin = slots[i].begin.load(std::memory_order_acquire);  // pairs with the release in CutGuard
    const std::size_t size = slots[i].size.load(std::memory_order_relaxed);
    if (begin == 0 || address < begin || address - begin >= size) continue;
    const int error = errno;
    void* zeros = ::mmap(reinterpret_cast<void*>(begin), size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
    errno = error;
    if (zeros == MAP_FAILED) break;
    if (!slots[i].is_cut.exchange(true)) cut_count.fetch_add(1);
    return;
  }
  if ((before.sa_flags & SA_SIGINFO) != 0) return before.sa_sigaction(signal, info, context);
  if (before.sa_handler != SIG_DFL && before.sa_handler != SIG_IGN) return before.sa_handler(signal);
  ::sigaction(SIGBUS, &before, nullptr);  // the access that faulted is made again, and now ends the process
}

void install_handler() {
  static const bool done = [] {
    struct sigaction action {};
    action.sa_sigaction = on_bus_error;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
    sigemptyset(&action.sa_mask);
    return ::sigaction(SIGBUS, &action, &before) == 0;
  }();
  (void)done;
}

}  // namespace

CutGuard::CutGuard(void* base, std::size_t size) : slot_(no_slot) {
  install_handler();
  const std::size_t first = hint.load(std::memory_order_relaxed);
  for (std::size_t i = 0; i < no_slot && slot_ == no_slot; ++i) {
    const std::size_t at = (first + i) % no_slot;
    if (!slots[at].is_taken.exchange(true, std::memory_order_acquire)) slot_ = at;  // pairs with the release in ~CutGuard
  }
  if (slot_ == no_slot) return;
  hint.store(slot_ + 1, std::memory_order_relaxed);
  Slot& slot = slots[slot_];
  slot.size.store(size, std::memory_order_relaxed);
  slot.is_cut.store(false, std::memory_order_relaxed);
  slot.begin.store(reinterpret_cast<std::uintptr_t>(base), std::memory_order_release);  // pairs with the acquire in the handler
  std::size_t end = used.load(std::memory_order_relaxed);
  while (end <= slot_ && !used.compare_exchange_weak(end, slot_ + 1, std::memory_order_release)) {  // pairs with the acquire in the handler
  }
}

CutGuard::~CutGuard() {
  if (slot_ == no_slot) return;
  slots[slot_].begin.store(0, std::memory_order_release);         // pairs with the acquire in the handler
  slots[slot_].is_taken.store(false, std::memory_order_release);  // pairs with the acquire in CutGuard
  if (slot_ < hint.load(std::memory_order_relaxed)) hint.store(slot_, std::memory_order_relaxed);
}

bool was_cut(const void* base) {
  const auto begin = reinterpret_cast<std::uintptr_t>(base);
  const std::size_t end = used.load(std::memory_order_acquire);  // pairs with the release in CutGuard
  for (std::size_t i = 0; i < end; ++i) {
    if (slots[i].begin.load(std::memory_order_acquire) == begin) return slots[i].is_cut.load();
  }
  return false;
}

std::size_t cuts() { return cut_count.load(); }

}  // namespace base
