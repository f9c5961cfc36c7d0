#include "channels/exchange.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <thread>
#include <utility>

#include "base/clock.h"
#include "base/guarded.h"

namespace channels {

namespace {

constexpr std::size_t smallest_block = 1024;  // [bytes]
constexpr std::size_t largest_free = 4 << 20;
constexpr std::size_t max_free = 8;

}  // namespace

struct Block {
  struct Head {
    ChannelId channel;
    std::uint32_t sequence;
    Time log_time;
    std::size_t begin, size;  // of the octets
  };

  std::vector<Head> heads;
  std::unique_ptr<char[]> octets;
  std::size_t capacity = 0, used = 0;
  Time put_at{0};

  void reserve(std::size_t size);
  std::span<char> add(ChannelId channel, Time log_time, std::size_t size);
  std::size_t size() const { return capacity + heads.size() * sizeof(Sample); }
};

void Block::reserve(std::size_t size) {
  auto larger = std::make_unique_for_overwrite<char[]>(size);
  std::copy_n(octets.get(), used, larger.get());
  octets = std::move(larger);
  capacity = size;
}

std::span<char> Block::add(ChannelId channel, Time log_time, std::size_t size) {
  if (used + size > capacity) reserve(std::max({used + size, 2 * capacity, smallest_block}));
  heads.push_back({channel, 0, log_time, used, size});
  used += size;
  return {octets.get() + used - size, size};
}

struct Blocks {
  base::Guarded<std::vector<std::unique_ptr<Block>>, base::Rank::memory> free;

  std::unique_ptr<Block> take() {
    auto blocks = free.lock();
    if (blocks->empty()) return std::make_unique<Block>();
    auto block = std::move(blocks->back());
    blocks->pop_back();
    return block;
  }
  void give_back(std::unique_ptr<Block> block) {
    block->heads.clear();
    block->used = 0;
    auto blocks = free.lock();
    if (blocks->size() < max_free && block->capacity <= largest_free) blocks->push_back(std::move(block));
  }
};

Batch::Batch() : free_(std::make_shared<Blocks>()) {}
Batch::~Batch() = default;

std::span<char> Batch::add(ChannelId channel, Time log_time, std::size_t size) {
  if (!block_) block_ = free_->take();
  return block_->add(channel, log_time, size);
}

bool Batch::is_empty() const { return !block_; }

namespace {

constexpr std::chrono::seconds last_wait{5};
constexpr std::size_t max_channels = 65535;
constexpr std::chrono::milliseconds gather_period{10};  // after the first sample, before a sink is given what has come

using SharedBlock = std::shared_ptr<const Block>;
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

  // False when it was dropped.
  bool put(const SharedBlock& block) {
    const std::size_t size = block->size();
    auto data = data_.lock();
    const auto has_room = [&] {
      return data->failure || data->is_ending || data->queue.empty() || data->octets + size <= options_.max_octets;
    };
    if (!has_room()) {
      changed_.notify_one();
      if (!data.wait_for(room_, options_.timeout, has_room)) return false;
    }
    if (data->failure || data->is_ending) return true;  // nobody is there who could miss it; failure() says why
    const bool was_urgent = is_urgent(*data);
    data->queue.push_back(block);
    data->octets += size;
    // One wake for all that comes about now: a wake for each sample costs more than the samples do.
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
    std::deque<SharedBlock> queue;
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
    std::deque<SharedBlock> blocks;
    std::vector<ChannelId> closed;
    std::uint64_t rests_wanted = 0;
    bool is_ending = false;
  };

  // What is not to wait for more samples.
  bool is_urgent(const Data& data) const {
    return data.is_ending || data.rests_wanted != data.rests_done || data.octets >= options_.max_octets / 4;
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

  base::Result<void> give(const SharedBlock& block) {
    Sample sample;
    sample.publish_time = block->put_at;
    sample.owner = block;
    for (const auto& head : block->heads) {
      sample.channel = head.channel;
      sample.sequence = head.sequence;
      sample.log_time = head.log_time;
      sample.octets = {block->octets.get() + head.begin, head.size};
      if (const auto done = sink_->take(sample); !done) return done;
    }
    return {};
  }

  base::Result<void> give(const Work& work) {
    for (const auto& [id, channel] : work.news) {
      if (const auto done = sink_->open(id, *channel); !done) return done;
    }
    for (const SharedBlock& block : work.blocks) {
      if (const auto done = give(block); !done) return done;
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
  base::Guarded<Data, base::Rank::queue> data_;
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

  void put(std::shared_ptr<Block> block);
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
  if (data->channels.size() >= max_channels) return base::Error{"channel " + channel.topic + ": is one too many; at most 65535"};
  data->channels.push_back(std::make_shared<const Channel>(std::move(channel)));
  data->sequences.push_back(0);
  data->dropped.push_back(0);
  const auto id = static_cast<ChannelId>(data->channels.size());
  for (const auto& outlet : *data->outlets) outlet->announce(id, data->channels.back());
  return id;
}

void Exchange::put(ChannelId channel, Time log_time, std::span<const char> head, std::span<const char> octets) {
  auto block = std::make_shared<Block>();
  block->reserve(head.size() + octets.size());
  const auto room = block->add(channel, log_time, head.size() + octets.size());
  std::ranges::copy(octets, std::ranges::copy(head, room.begin()).out);
  state_->put(std::move(block));
}

void Exchange::put(Batch& batch) {
  if (batch.is_empty()) return;
  state_->put({batch.block_.release(), [free = batch.free_](Block* block) { free->give_back(std::unique_ptr<Block>(block)); }});
}

// Samples of one channel are put by one thread at a time, so their numbers are in the order of each queue.
void Exchange::State::put(std::shared_ptr<Block> block) {
  SharedOutlets outlets;
  {
    auto now = data.lock();
    std::erase_if(block->heads, [&](const auto& head) { return head.channel == 0 || head.channel > now->channels.size(); });
    for (auto& head : block->heads) head.sequence = now->sequences[head.channel - 1u]++;
    outlets = now->outlets;
  }
  block->put_at = base::SystemClock().now();
  std::uint64_t dropped = 0;
  for (const auto& outlet : *outlets) dropped += outlet->put(block) ? 0 : 1;
  if (dropped == 0) return;
  auto now = data.lock();
  for (const auto& head : block->heads) now->dropped[head.channel - 1u] += dropped;
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

Sample copy_of(const Sample& sample) {
  const auto octets = std::make_shared<std::vector<char>>(sample.octets.begin(), sample.octets.end());
  Sample copy = sample;
  copy.octets = *octets;
  copy.owner = octets;
  return copy;
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
