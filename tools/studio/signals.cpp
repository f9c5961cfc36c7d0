#include "studio/signals.h"

#include <omnithread.h>

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "studio/client_message.h"

namespace studio {
namespace {

using namespace std::chrono_literals;

constexpr auto signals_period = 10ms;
constexpr std::size_t max_samples = 256;  // of an event
constexpr auto rate_period = 1s;

}  // namespace

Json member_at(const Json& value, const std::string& path) {
  const Json* at = &value;
  for (std::size_t i = 0; i < path.size();) {
    if (path[i] == '[') {
      const auto end = path.find(']', i);
      const auto index = end == std::string::npos ? std::nullopt : base::parse_integer(path.substr(i + 1, end - i - 1));
      if (!index || *index < 0 || !at->is_array() || static_cast<std::size_t>(*index) >= at->size()) return {};
      at = &(*at)[static_cast<std::size_t>(*index)];
      i = end + 1;
      continue;
    }
    if (path[i] == '.') ++i;
    const auto end = std::min(path.find_first_of(".[", i), path.size());
    const auto found = at->is_object() ? at->find(path.substr(i, end - i)) : at->end();
    if (!at->is_object() || found == at->end() || end == i) return {};
    at = &*found;
    i = end;
  }
  return *at;
}

Signals::Signals(SignalSettings settings, Workers& workers, Tell tell)
    : settings_(std::move(settings)), workers_(workers), tell_(std::move(tell)), thread_([this] { run(); }) {}

Signals::~Signals() {
  data_.lock()->is_ending = true;
  changed_.notify_all();
  thread_.join();
}

base::Result<void> Signals::watch(const WatchKey& key, WatchOrder order) {
  auto data = data_.lock();
  if (data->orders.size() >= max_watches && !data->orders.contains(key)) return base::Error{"watch: 512 signals are watched already"};
  data->orders[key] = std::move(order);
  ++data->changes;
  changed_.notify_all();
  return {};
}

void Signals::unwatch(const WatchKey& key) {
  auto data = data_.lock();
  if (data->orders.erase(key) > 0) ++data->changes;
}

void Signals::unwatch_all(std::uint64_t viewer) {
  auto data = data_.lock();
  if (std::erase_if(data->orders, [&](const auto& entry) { return entry.first.viewer == viewer; }) > 0) ++data->changes;
}

void Signals::run() {
  const omni_thread::ensure_self known_to_the_orb;  // connections to ports end here
  for (auto next = Clock::now();; next = std::max(next + signals_period, Clock::now())) {
    {
      auto data = data_.lock();
      data.wait(changed_, [&] { return data->is_ending || !data->orders.empty() || data->changes != changes_; });
      data.wait_until(changed_, next, [&] { return data->is_ending; });
      if (data->is_ending) break;
    }
    take_orders();
    gather();
  }
  sources_.clear();
}

// Sources come and go with the watches of their topics.
void Signals::take_orders() {
  std::map<WatchKey, WatchOrder> orders;
  {
    auto data = data_.lock();
    if (data->changes == changes_) return;
    changes_ = data->changes;
    orders = data->orders;
  }
  std::erase_if(watches_, [&](const auto& entry) { return !orders.contains(entry.first); });
  for (auto& [key, order] : orders) {
    const auto known = watches_.find(key);
    const bool is_same =
        known != watches_.end() && known->second.order.topic == order.topic && known->second.order.members == order.members;
    if (is_same) continue;
    watches_[key] = {};
    watches_[key].order = std::move(order);
  }
  std::erase_if(sources_, [&](const auto& entry) {
    return std::none_of(watches_.begin(), watches_.end(), [&](const auto& watch) { return watch.second.order.topic == entry.first; });
  });
  for (const auto& [key, watch] : watches_) {
    const auto& topic = watch.order.topic;
    if (sources_.contains(topic)) continue;
    sources_[topic].source = topic.starts_with('/') ? port_source(settings_, topic, workers_) : iface_source(settings_, topic);
  }
}

void Signals::add(Watch& watch, const SignalSample& sample) {
  watch.latency = sample.latency;
  if (watch.order.members.empty()) {
    watch.times = {sample.time};
    watch.whole = sample.value;
    return;
  }
  Json row = Json::array();
  for (const auto& member : watch.order.members) row.push_back(member_at(sample.value, member));
  watch.times.push_back(sample.time);
  watch.rows.push_back(std::move(row));
}

void Signals::Rate::count(std::size_t samples, Clock::time_point now) {
  counted += samples;
  const std::chrono::duration<double> passed = now - since;
  if (passed < rate_period) return;
  hz = static_cast<double>(counted) / passed.count();
  counted = 0;
  since = now;
}

void Signals::gather() {
  for (auto& [topic, from] : sources_) {
    auto samples = from.source->take();
    from.rate.count(samples.size(), Clock::now());
    if (!from.source->problem().empty()) from.last.reset();
    for (auto& [key, watch] : watches_) {
      if (watch.order.topic != topic) continue;
      if (std::exchange(watch.is_new, false) && samples.empty() && from.last) add(watch, *from.last);
      for (const auto& sample : samples) add(watch, sample);
      flush(key, watch, from);
    }
    if (!samples.empty()) from.last = std::move(samples.back());
  }
}

void Signals::flush(const WatchKey& key, Watch& watch, Source& from) {
  const auto now = Clock::now();
  if (now < watch.next) return;
  Json event{{"op", "values"}, {"watch", key.watch}};
  if (auto problem = from.source->problem(); problem != watch.told_problem) {
    watch.told_problem = std::move(problem);
    if (!watch.told_problem.empty()) return event["error"] = watch.told_problem, tell_(key, to_text(event));
  }
  if (watch.times.empty()) return;
  watch.next = now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / watch.order.hz));
  if (const auto count = watch.times.size(); count > max_samples) {
    const auto surplus = static_cast<std::ptrdiff_t>(count - max_samples);
    watch.times.erase(watch.times.begin(), watch.times.begin() + surplus);
    watch.rows.erase(watch.rows.begin(), watch.rows.begin() + surplus);
  }
  event["t"] = std::exchange(watch.times, {});
  if (watch.order.members.empty()) {
    event["value"] = std::exchange(watch.whole, {});
    if (from.rate.hz) event["rate"] = *from.rate.hz;
    if (watch.latency) event["latency"] = *watch.latency;
  } else {
    event["v"] = std::exchange(watch.rows, Json::array());
  }
  tell_(key, to_text(event));
}

}  // namespace studio
