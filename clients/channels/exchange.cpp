#include "exchange.h"

#include <condition_variable>
#include <deque>
#include <thread>
#include <utility>

#include "base/clock.h"
#include "base/guarded.h"

namespace channels {

namespace {

constexpr std::chrono::seconds last_wait{5};
constexpr std::size_t most_channels = 65535;
constexpr std::chrono::milliseconds gather_period{10};  // after the first sample, before a sink is given what has come

using SharedSample = std::shared_ptr<const Sample>;
using SharedChannel = std::shared_ptr<const Channel>;

// A sink, its queue and its thread.
class Outlet {
 public:
  Outlet(std::shared_ptr<Sink> sink, const QueueOptions& options) : sink_(std::move(sink)), options_(options), thread_([this] { run(); }) {}
  ~Outlet() {
    (void)drain(last_wait);
    data_.lock()->is_ending = true;
    changed_.notify_all();
    thread_.join();
  }

  void announce(ChannelId id, SharedChannel channel) {
    data_.lock()->news.emplace_back(id, std::move(channel));
    changed_.notify_all();
  }

  void close(ChannelId id) {
    data_.lock()->closed.push_back(id);
    changed_.notify_all();
  }

  // False when the sample was dropped.
  bool put(const SharedSample& sample) {
    const std::size_t size = sample->octets.size() + sizeof(Sample);
    auto data = data_.lock();
    const auto has_room = [&] {
      return data->failure || data->is_ending || data->queue.empty() || data->octets + size <= options_.most_octets;
    };
    if (!has_room()) {
      changed_.notify_one();
      if (!data.wait_for(room_, options_.patience, has_room)) return false;
    }
    if (data->failure || data->is_ending) return true;  // nobody is there who could miss it; failure() says why
    const bool was_urgent = is_urgent(*data);
    data->queue.push_back(sample);
    data->octets += size;
    // One wake for all samples of a tick: a wake for each costs more than the samples do.
    if (data->queue.size() == 1 || (is_urgent(*data) && !was_urgent)) changed_.notify_one();
    return true;
  }

  bool drain(std::chrono::milliseconds limit) {
    auto data = data_.lock();
    const auto wanted = ++data->rests_wanted;
    changed_.notify_all();
    return data.wait_for(room_, limit, [&] { return data->failure || data->rests_done >= wanted; });
  }

  std::optional<base::Error> failure() const { return data_.lock()->failure; }
  void on_failure(const std::function<void()>& told) {
    bool has_failed = false;
    {
      auto data = data_.lock();
      data->told = told;
      has_failed = data->failure.has_value();
    }
    if (has_failed && told) told();
  }

 private:
  struct Data {
    std::vector<std::pair<ChannelId, SharedChannel>> news;  // channels that the sink has not heard of
    std::deque<SharedSample> queue;
    std::vector<ChannelId> closed;  // behind the queue
    std::size_t octets = 0;
    std::uint64_t rests_wanted = 0;
    std::uint64_t rests_done = 0;
    std::optional<base::Error> failure;
    std::function<void()> told;  // of it
    bool is_ending = false;
  };
  struct Work {
    std::vector<std::pair<ChannelId, SharedChannel>> news;
    std::deque<SharedSample> samples;
    std::vector<ChannelId> closed;
    std::uint64_t rests_wanted = 0;
    bool is_ending = false;
  };

  // What is not to wait for more samples.
  bool is_urgent(const Data& data) const {
    return data.is_ending || data.rests_wanted != data.rests_done || data.octets >= options_.most_octets / 4;
  }

  Work next() {
    auto data = data_.lock();
    data.wait_for(changed_, rest_period, [&] {
      return !data->queue.empty() || !data->news.empty() || !data->closed.empty() || data->is_ending ||
             data->rests_wanted != data->rests_done;
    });
    if (!data->queue.empty()) data.wait_for(changed_, gather_period, [&] { return is_urgent(*data); });
    Work work{std::exchange(data->news, {}), std::exchange(data->queue, {}), std::exchange(data->closed, {}), data->rests_wanted,
              data->is_ending};
    data->octets = 0;
    room_.notify_all();
    return work;
  }

  base::Result<void> give(const Work& work) {
    for (const auto& [id, channel] : work.news) {
      if (const auto done = sink_->open(id, *channel); !done) return done;
    }
    for (const SharedSample& sample : work.samples) {
      if (const auto done = sink_->take(*sample); !done) return done;
    }
    for (const ChannelId id : work.closed) {
      if (const auto done = sink_->close(id); !done) return done;
    }
    return sink_->rest();
  }

  void run() {
    for (;;) {
      const Work work = next();
      const auto done = give(work);
      std::function<void()> told;
      {
        auto data = data_.lock();
        data->rests_done = work.rests_wanted;
        if (!done) {
          data->failure = done.error();
          told = data->told;
        }
        room_.notify_all();
      }
      if (told) told();
      if (!done || work.is_ending) return;
    }
  }

  const std::shared_ptr<Sink> sink_;
  const QueueOptions options_;
  base::Guarded<Data, base::Rank::buffer> data_;
  std::condition_variable changed_;  // for the thread
  std::condition_variable room_;     // for those who put and drain
  std::thread thread_;               // last: it uses all of these
};

}  // namespace

using Outlets = std::vector<std::shared_ptr<Outlet>>;
using SharedOutlets = std::shared_ptr<const Outlets>;  // a new one when a sink comes, so that whoever puts need not copy it

struct Exchange::State {
  struct Data {
    std::vector<SharedChannel> channels;   // by id - 1
    std::vector<std::uint32_t> sequences;  // likewise: of the next sample
    std::vector<std::uint64_t> dropped;
    SharedOutlets outlets = std::make_shared<const Outlets>();
    std::function<void()> told;  // of failures
  };
  base::Guarded<Data, base::Rank::connector> data;
};

Exchange::Exchange() : state_(std::make_unique<State>()) {}
Exchange::~Exchange() = default;

void Exchange::attach(std::shared_ptr<Sink> sink, const QueueOptions& options) {
  auto outlet = std::make_shared<Outlet>(std::move(sink), options);
  auto data = state_->data.lock();
  outlet->on_failure(data->told);
  for (std::size_t i = 0; i < data->channels.size(); ++i) outlet->announce(static_cast<ChannelId>(i + 1), data->channels[i]);
  auto outlets = *data->outlets;
  outlets.push_back(std::move(outlet));
  data->outlets = std::make_shared<const Outlets>(std::move(outlets));
}

base::Result<ChannelId> Exchange::open(Channel channel) {
  auto data = state_->data.lock();
  if (data->channels.size() >= most_channels) return base::Error{"channel " + channel.topic + ": is one too many; at most 65535"};
  data->channels.push_back(std::make_shared<const Channel>(std::move(channel)));
  data->sequences.push_back(0);
  data->dropped.push_back(0);
  const auto id = static_cast<ChannelId>(data->channels.size());
  for (const auto& outlet : *data->outlets) outlet->announce(id, data->channels.back());
  return id;
}

void Exchange::put(ChannelId channel, Time log_time, std::span<const char> head, std::span<const char> octets) {
  std::vector<char> all;
  all.reserve(head.size() + octets.size());
  all.insert(all.end(), head.begin(), head.end());
  all.insert(all.end(), octets.begin(), octets.end());
  put(channel, log_time, std::move(all));
}

// Samples of one channel are put by one thread at a time, so their numbers are in the order of each queue.
void Exchange::put(ChannelId channel, Time log_time, std::vector<char>&& octets) {
  Sample sample{channel, 0, log_time, base::SystemClock().now(), std::move(octets)};
  SharedOutlets outlets;
  {
    auto data = state_->data.lock();
    if (channel == 0 || channel > data->channels.size()) return;
    sample.sequence = data->sequences[channel - 1u]++;
    outlets = data->outlets;
  }
  const auto shared = std::make_shared<const Sample>(std::move(sample));
  std::uint64_t dropped = 0;
  for (const auto& outlet : *outlets) dropped += outlet->put(shared) ? 0 : 1;
  if (dropped > 0) state_->data.lock()->dropped[channel - 1u] += dropped;
}

void Exchange::close(ChannelId channel) {
  const auto outlets = state_->data.lock()->outlets;
  for (const auto& outlet : *outlets) outlet->close(channel);
}

bool Exchange::drain(std::chrono::milliseconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  const auto outlets = state_->data.lock()->outlets;
  bool is_done = true;
  for (const auto& outlet : *outlets) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    is_done = outlet->drain(std::max(left, std::chrono::milliseconds(0))) && is_done;
  }
  return is_done;
}

std::map<std::string, std::uint64_t> Exchange::dropped() const {
  auto data = state_->data.lock();
  std::map<std::string, std::uint64_t> all;
  for (std::size_t i = 0; i < data->channels.size(); ++i) {
    if (data->dropped[i] > 0) all[data->channels[i]->topic] += data->dropped[i];
  }
  return all;
}

std::optional<base::Error> Exchange::failure() const {
  const auto outlets = state_->data.lock()->outlets;
  for (const auto& outlet : *outlets) {
    if (auto failure = outlet->failure()) return failure;
  }
  return std::nullopt;
}

std::string_view cdr_head(bool is_little_endian) {
  using namespace std::string_view_literals;
  return is_little_endian ? "\0\1\0\0"sv : "\0\0\0\0"sv;
}

void Exchange::on_failure(const std::function<void()>& told) {
  SharedOutlets outlets;
  {
    auto data = state_->data.lock();
    data->told = told;
    outlets = data->outlets;
  }
  for (const auto& outlet : *outlets) outlet->on_failure(told);
}

}  // namespace channels
