// The unread samples of a port: a ring for each connection, each with its own policies, read in order of arrival over all of them. Any
// thread.
//
// Samples of a connection that has ended can still be read (of ended connections at most 64 samples), so that a tool may connect, put a
// value and disconnect.
//
// Unread samples take a limited memory. A channel with unread samples is full when its next sample would exceed the limit. The first sample
// of another channel is accepted up to twice the limit, in which the samples that were read last count as well, and rejected beyond that.
//
// In lock step (base/tick.h) samples of an odd phase counter are hidden until a later one: the order of the components of a phase decides
// neither what is read nor whether a ring is full. Phase counters of readers and writers that are even, or 0, have no such rule. Among
// samples of one phase those of the channel with the first name are read first.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "core/connector_settings.h"
#include "core/port_status.h"
#include "core/ring.h"

namespace rt {

struct WriteResult {
  PortStatus status = PortStatus::ok;  // ok, buffer_full, buffer_timeout; precondition_not_met: the channel is closed
  bool overwrote = false;              // an unread sample was lost
};

enum class Channel : std::uint64_t { any = 0 };

struct ReadResult {
  PortStatus status = PortStatus::buffer_empty;  // ok, buffer_empty, buffer_timeout; precondition_not_met: no such channel
  Sample sample;
  bool is_fresh = false;  // false: read before
  Channel channel = Channel::any;
};

class Mailbox {
 public:
  explicit Mailbox(std::size_t max_octets = max_octets_waiting) : max_octets_(max_octets) {}

  // `name`: orders the channels where time does not.
  Channel open(const BufferSettings& settings, const std::string& name = "");
  // Drops what is in it; whoever waits to write or read there is released.
  void close(Channel channel);
  // Nothing more comes: whoever waits to write there is released. What is unread can still be read; the channel closes with its last
  // sample.
  void finish(Channel channel);

  // As long as the channel's settings say.
  static constexpr std::chrono::nanoseconds as_set = std::chrono::nanoseconds::max();

  // A full ring overwrites, rejects or waits, according to the settings of the channel. A wait is at most `most`. The sample carries the
  // phase counter of the writer.
  WriteResult write(Channel channel, Sample sample, std::chrono::nanoseconds most = as_set);
  // The oldest sample (of that channel). If nothing is unread: the last one again, nothing, or waits, as the settings of the channel say
  // from which the last sample came; before the first sample one channel that waits is enough to wait. At an odd phase counter
  // only a rendezvous waits, because samples of this phase cannot be read yet. No wait is longer than `most`.
  ReadResult read(Channel channel = Channel::any, std::uint64_t phase_counter = 0, std::chrono::nanoseconds most = as_set);
  std::size_t unread(Channel channel = Channel::any, std::uint64_t phase_counter = 0) const;
  // Waits until something is unread in any channel, at most `most`; true if so. For readers in real time: in lock step a tick finds what it
  // may read without waiting.
  bool wait_unread(std::chrono::nanoseconds most);
  // Throws away what is unread in that channel, and the last sample with it.
  void drop_unread(Channel channel);
  // The same for what is of another epoch than this one, in all channels.
  void drop_other_epochs(std::uint64_t epoch);
  // The last sample of that channel is not read again.
  void forget_last(Channel channel);
  // Writers wait for readers and readers for writers while this is set (dataport.sync_readwrite).
  void set_rendezvous(Channel channel, bool is_rendezvous);

 private:
  struct Entry {
    Channel channel;
    std::string name;
    BufferSettings settings;
    Ring ring;
    Sample last;                      // what was read last
    std::deque<Sample> aside{};       // samples that were written in the phase of `phase_counter`
    std::uint64_t phase_counter = 0;  // the latest phase in which something happened here
    std::size_t size_at_start = 0;    // of the ring, in that phase
    bool is_rendezvous = false;
    bool is_finished = false;
    std::uint64_t read_count = 0;
    std::uint64_t epoch = 0;  // of what was dropped last

    bool is_empty() const { return ring.is_empty() && aside.empty(); }
    // Of what is unread.
    std::size_t octets() const;
    Sample drop_oldest();
    // Takes in what later moments may read.
    void settle(std::uint64_t now);
    // As a writer with this phase counter sees it.
    bool is_full(std::uint64_t now) const;
    // True if an unread sample was lost.
    bool put(Sample sample);
    std::size_t readable(std::uint64_t now) const;
  };
  struct State {
    std::vector<Entry> entries;
    std::uint64_t last_channel = 0;
    std::uint64_t arrivals = 0;

    Entry* find(Channel channel);
    // nullptr also for one that is finished.
    Entry* find_writable(Channel channel);
    void erase(const Entry& entry);
    // The entry (of that channel) with the oldest unread sample.
    Entry* oldest(Channel channel);
    Entry* last_read(Channel channel);
    ReadResult take(Entry& entry);
    std::size_t unread_octets() const;
    // With what was read last.
    std::size_t all_octets() const;
    // How long a reader waits for the first or next sample; nothing if it does not.
    std::optional<std::chrono::nanoseconds> longest_wait(Channel channel);
  };

  const std::size_t max_octets_;
  mutable base::Guarded<State, base::Rank::samples> state_;
  std::condition_variable arrived_;
  std::condition_variable freed_;
};

}  // namespace rt
