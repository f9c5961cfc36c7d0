#include "corba/members/member_watch.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "base/log.h"

namespace corba {

namespace {

struct PortWatch {
  std::shared_ptr<MemberWatch> watch;
  bool is_over = true;
};

base::Guarded<PortWatch, base::Rank::peers>& watch_of_ports() {
  static auto& watch = *new base::Guarded<PortWatch, base::Rank::peers>;  // never destroyed: calls may end at the very end
  return watch;
}

}  // namespace

void begin_port_watch() { watch_of_ports().lock()->is_over = false; }

// Without a thread for it nobody is told of anything, and that is all.
std::shared_ptr<MemberWatch> port_watch() {
  auto ports = watch_of_ports().lock();
  if (!ports->watch && !ports->is_over) {
    try {
      ports->watch = std::make_shared<MemberWatch>();
    } catch (const std::system_error&) {
      ports->is_over = true;
    }
  }
  return ports->watch;
}

// Whoever calls still holds it.
void end_port_watch() {
  std::shared_ptr<MemberWatch> last;
  auto ports = watch_of_ports().lock();
  ports->is_over = true;
  last.swap(ports->watch);
}

MemberWatch::~MemberWatch() {
  shared_.lock()->stopping = true;
  changed_.notify_all();
  thread_.join();
}

MemberWatch::Call::Call(MemberWatch& watch, const std::string& who, std::string_view operation, const std::string* connection)
    : watch_(watch) {
  bool sleeps = false;
  {
    auto data = watch_.shared_.lock();
    number_ = ++data->last;
    data->running.push_back({number_, &who, operation, connection, Clock::now(), false});
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
  base::log(base::Level::warn, *call.who, "{} has returned from {} after {:.1f} s", text_of(call), call.operation, took.count());
}

std::string MemberWatch::text_of(const Running& call) {
  return call.connection ? std::string(port_waits_mark.substr(2)) + *call.connection : "component of another process";
}

bool MemberWatch::look(std::uint64_t& seen) {
  std::vector<std::pair<std::string, std::string>> long_ones;  // copies: who is called may have gone when it is told
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
      long_ones.emplace_back(*call.who, text_of(call) + " has not returned from " + std::string(call.operation));
    }
  }
  for (const auto& [who, what] : long_ones) base::log(base::Level::warn, who, "{} for {} s; still waiting", what, long_time.count());
  return true;
}

void MemberWatch::run() {
  for (std::uint64_t seen = 0; look(seen);) continue;
}

}  // namespace corba
