#include "studio/workers.h"

#include <omnithread.h>

#include <utility>

namespace studio {
namespace {

constexpr std::size_t max_acts_waiting = 256;

}  // namespace

// What is delegated to has made an object: the destructor ends those threads that are there when one more cannot be had.
Workers::Workers(std::size_t threads) : Workers() {
  for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

Workers::~Workers() {
  std::deque<Work> dropped;  // not in the lock: what work has bound may take other locks when it goes
  {
    auto data = data_.lock();
    data->is_ending = true;
    dropped.swap(data->waiting);
  }
  changed_.notify_all();
  for (auto& thread : threads_) thread.join();
}

bool Workers::give(Work work) {
  {
    auto data = data_.lock();
    if (data->is_ending || data->waiting.size() >= max_acts_waiting) return false;
    data->waiting.push_back(std::move(work));
  }
  changed_.notify_one();
  return true;
}

void Workers::run() {
  const omni_thread::ensure_self known_to_the_orb;  // time-outs per thread need it
  for (;;) {
    Work work;
    {
      auto data = data_.lock();
      data.wait(changed_, [&] { return data->is_ending || !data->waiting.empty(); });
      if (data->is_ending) return;
      work = std::move(data->waiting.front());
      data->waiting.pop_front();
    }
    work();
  }
}

}  // namespace studio
