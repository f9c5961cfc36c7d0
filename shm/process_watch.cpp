#include "shm/process_watch.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <map>
#include <system_error>

#include "base/file_handle.h"
#include "base/text.h"
#include "shm/process.h"

namespace shm {
namespace {

struct Entry {
  std::shared_ptr<Watched> watched;
  base::FileHandle pidfd;
  std::uint64_t number = 0;
};

constexpr std::size_t purge_size = 256;

}  // namespace

struct ProcessWatch::State {
  base::FileHandle epoll, stop;
  struct Table {
    std::map<ProcessKey, Entry> entries;
    std::uint64_t next_number = 1;  // 0 is the stop event
    std::function<void()> callback;
    bool is_calling = false;
  };
  std::condition_variable called;
  base::Guarded<Table, base::Rank::peers> table;
};

bool Watched::is_dead() const {
  if (dead_.load(std::memory_order_acquire)) return true;  // pairs with the release of the watching thread
  return is_polled_.load(std::memory_order_relaxed) && !is_alive(mark_);
}

ProcessWatch::ProcessWatch() : state_(std::make_unique<State>()) {}

base::Result<std::unique_ptr<ProcessWatch>> ProcessWatch::start() {
  std::unique_ptr<ProcessWatch> watch(new ProcessWatch());
  watch->state_->epoll = base::FileHandle(epoll_create1(EPOLL_CLOEXEC));
  watch->state_->stop = base::FileHandle(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (watch->state_->epoll.get() < 0 || watch->state_->stop.get() < 0) {
    return base::Error{std::string("process watch can't start: ") + std::strerror(errno)};
  }
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = 0;
  epoll_ctl(watch->state_->epoll.get(), EPOLL_CTL_ADD, watch->state_->stop.get(), &event);
  try {
    watch->thread_ = std::thread([raw = watch.get()] { raw->run(); });
  } catch (const std::system_error& error) {
    return base::Error{std::string("process watch can't start: no thread: ") + error.what()};
  }
  return watch;
}

ProcessWatch::~ProcessWatch() {
  if (!thread_.joinable()) return;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(state_->stop.get(), &one, sizeof one);
  thread_.join();
}

void ProcessWatch::on_death(std::function<void()> callback) {
  auto table = state_->table.lock();
  while (table->is_calling) table.wait_for(state_->called, std::chrono::seconds(1), [&] { return !table->is_calling; });
  table->callback = std::move(callback);
}

std::shared_ptr<const Watched> ProcessWatch::watch(const ProcessMark& mark) {
  auto table = state_->table.lock();
  if (auto found = table->entries.find(key_of(mark)); found != table->entries.end()) return found->second.watched;
  if (table->entries.size() >= purge_size) {
    std::erase_if(table->entries, [](const auto& entry) { return entry.second.watched.use_count() == 1; });
  }
  auto watched = std::make_shared<Watched>(mark);
  base::FileHandle pidfd(mark.pid > 0 ? static_cast<int>(syscall(SYS_pidfd_open, mark.pid, 0)) : -1);
  // The pid may belong to another process by now, so it is asked only after the pidfd holds it.
  if (!is_alive(mark)) {
    watched->dead_.store(true, std::memory_order_release);
    return watched;
  }
  const std::uint64_t number = table->next_number++;
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = number;
  const bool is_watched = pidfd.get() >= 0 && epoll_ctl(state_->epoll.get(), EPOLL_CTL_ADD, pidfd.get(), &event) == 0;
  watched->is_polled_.store(!is_watched, std::memory_order_relaxed);
  table->entries.emplace(key_of(mark), Entry{watched, std::move(pidfd), number});
  return watched;
}

void ProcessWatch::run() {
  while (true) {
    epoll_event events[16];
    const int count = epoll_wait(state_->epoll.get(), events, 16, -1);
    if (count < 0 && errno != EINTR) return;
    std::function<void()> callback;
    bool has_died = false;
    for (int i = 0; i < count; ++i) {
      if (events[i].data.u64 == 0) return;
      auto table = state_->table.lock();
      for (auto entry = table->entries.begin(); entry != table->entries.end(); ++entry) {
        if (entry->second.number != events[i].data.u64) continue;
        entry->second.watched->dead_.store(true, std::memory_order_release);  // pairs with is_dead
        table->entries.erase(entry);
        has_died = true;
        break;
      }
    }
    if (!has_died) continue;
    deaths_.fetch_add(1, std::memory_order_release);  // pairs with deaths
    {
      auto table = state_->table.lock();
      callback = table->callback;
      table->is_calling = true;
    }
    if (callback) callback();
    state_->table.lock()->is_calling = false;
    state_->called.notify_all();
  }
}

}  // namespace shm
