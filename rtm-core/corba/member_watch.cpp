#include "corba/member_watch.h"

#include <algorithm>
#include <utility>

#include "base/log.h"

namespace corba {

MemberWatch::~MemberWatch() {
  shared_.lock()->stopping = true;
  changed_.notify_all();
  thread_.join();
}

MemberWatch::Call::Call(MemberWatch& watch, const std::string& member, rt::Action action) : watch_(watch) {
  bool sleeps = false;
  {
    auto data = watch_.shared_.lock();
    number_ = ++data->last;
    data->running.push_back({number_, &member, action, Clock::now(), false});
    sleeps = std::exchange(data->sleeps, false);
  }
  if (sleeps) watch_.changed_.notify_all();
}

MemberWatch::Call::~Call() {
  Running call{};
  {
    auto data = watch_.shared_.lock();
    const auto it = std::ranges::find(data->running, number_, &Running::number);
    call = *it;
    data->running.erase(it);
  }
  if (!call.is_told) return;
  const std::chrono::duration<double> took = Clock::now() - call.since;
  base::log(base::Level::warn, *call.member, "has returned from {} after {:.1f} s", rt::callback_of(call.action), took.count());
}

bool MemberWatch::look(std::uint64_t& seen) {
  std::vector<std::pair<std::string, rt::Action>> long_ones;  // copies: who is called may have gone when it is told
  {
    auto data = shared_.lock();
    // While calls come and go nobody has to wake this thread.
    data->sleeps = data->running.empty() && data->last == seen;
    seen = data->last;
    if (data->sleeps) {
      data.wait(changed_, [&] { return data->stopping || !data->sleeps; });
    } else {
      data.wait_for(changed_, std::chrono::milliseconds(long_time) / 4, [&] { return data->stopping; });
    }
    if (data->stopping) return false;
    for (Running& call : data->running) {
      if (call.is_told || Clock::now() - call.since < long_time) continue;
      call.is_told = true;
      long_ones.emplace_back(*call.member, call.action);
    }
  }
  for (const auto& [member, action] : long_ones)
    base::log(base::Level::warn, member, "component of another process has not returned from {} for {} s; it is waited for",
              rt::callback_of(action), long_time.count());
  return true;
}

void MemberWatch::run() {
  for (std::uint64_t seen = 0; look(seen);) continue;
}

}  // namespace corba
