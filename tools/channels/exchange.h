// Connects sources and sinks of channels. Each sink has a thread and a queue of its own, so a slow sink delays the sources and the other
// sinks only when its queue is full.
//
// Any thread may put, open, close and attach. A sink is called on its thread alone: open() before the first sample of a channel, take() in
// the order in which samples were put, close() behind the last sample, rest() when there is nothing to take and at least once in
// rest_period. A sink gets samples some ten milliseconds after they were put, together. When a sink fails it is called no more, and
// failure() says why. When a queue is full, put() waits up to the `timeout` of that sink; then the sample is dropped for it and counted.
// With a timeout of zero a source never waits.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "channels/channel.h"

namespace channels {

inline constexpr std::chrono::milliseconds rest_period{500};

class Sink {
 public:
  virtual ~Sink() = default;
  virtual base::Result<void> open(ChannelId id, const Channel& channel) = 0;
  virtual base::Result<void> take(const Sample& sample) = 0;
  virtual base::Result<void> close(ChannelId) { return {}; }
  virtual base::Result<void> rest() { return {}; }
};

struct QueueOptions {
  std::size_t max_octets = 64 << 20;
  std::chrono::milliseconds timeout{0};
};

struct Block;   // samples that were put together
struct Blocks;  // that nobody uses

// Samples that are put together, as those of a tick: in one piece of memory, which is used again when all sinks have done with it. One
// thread at a time.
class Batch {
 public:
  Batch();
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;
  ~Batch();

  // Room for the octets of a sample. They are to be written before the next one is added.
  std::span<char> add(ChannelId channel, Time log_time, std::size_t size);
  bool is_empty() const;

 private:
  friend class Exchange;
  const std::shared_ptr<Blocks> free_;
  std::unique_ptr<Block> block_;  // that is being filled; null while empty
};

class Exchange final {
 public:
  Exchange();
  ~Exchange();  // gives every sink what waits for it, for at most five seconds
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;

  // A sink hears of all channels, also of those that were opened before it came.
  void attach(std::shared_ptr<Sink> sink, const QueueOptions& options = {});
  // At most 65535, with those that were closed.
  base::Result<ChannelId> open(Channel channel);
  void put(ChannelId channel, Time log_time, std::span<const char> head, std::span<const char> octets = {});
  // All of it, in the order in which they were added; the batch is empty then.
  void put(Batch& batch);
  // Nothing more comes on it.
  void close(ChannelId channel);
  // Gives the sinks what waits for them and lets them rest; false when they have not done so in time.
  bool drain(std::chrono::milliseconds limit);

  // By topic, of all sinks; nothing for topics without.
  std::map<std::string, std::uint64_t> dropped() const;
  // What the first sink that failed said.
  std::optional<base::Error> failure() const;
  // Called once for each sink that fails, on its thread; also for those that came before. It must not wait, nor call the exchange.
  void on_failure(const std::function<void()>& told);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace channels
