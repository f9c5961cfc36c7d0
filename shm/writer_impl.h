// The state of an IfaceWriter, for it and for the Server. The thread rule is that of writer.h.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "shm/frame_ring.h"
#include "shm/futex.h"
#include "shm/lease_table.h"
#include "shm/process.h"
#include "shm/words.h"
#include "shm/writer.h"

namespace shm {

// Of all ifaces of a server.
using Bytes = std::shared_ptr<std::atomic<std::uint64_t>>;

struct IfaceWriter::Impl {
  Impl(Segment made, std::size_t sample, std::size_t elements, Bytes all)
      : segment(std::move(made)),
        bytes(std::move(all)),
        sample_size(sample),
        count(elements),
        staging((sample + 7) / 8),
        command_values(segment.facts().command_values),
        fresh_values(segment.facts().command_values),
        leases(segment),
        ring(segment) {
    bytes->fetch_add(segment.facts().total_size);
  }
  ~Impl() { bytes->fetch_sub(segment.facts().total_size); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Segment segment;
  Bytes bytes;
  std::size_t sample_size;
  std::size_t count;  // elements in each array that follows a sample
  std::vector<std::uint64_t> staging;
  std::vector<double> command_values, fresh_values;  // of the command in force; of the one that is being read
  LeaseTable leases;
  FrameRing ring;
  std::uint64_t sequence = 0;
  std::uint32_t resets = 0;
  std::atomic<std::uint32_t> served{0};  // LeaseTable::times_switched_on at the last publication

  std::uint64_t seen_command = 0;
  std::uint64_t commanding_owner = 0;  // owner word of the lease whose command is in force
  std::size_t commanding_lease = 0;
  std::vector<std::uint64_t> seen_of_leases;  // sequence of the command taken last, by lease; see poll_commands
  bool is_cut_told = false;                   // under the lock of the server's ifaces

  Stamp next_stamp(std::chrono::nanoseconds sim_time, bool is_valid) const {
    return {sequence + 1, sim_time.count(), wall_ns(), is_valid ? 1U : 0U, resets};
  }
  void announce_latest() {
    Header& header = segment.header();
    served.store(leases.times_switched_on(), std::memory_order_relaxed);
    store(header.sequence, sequence);  // pairs with the acquire in Iface::sequence
    store(header.wake_word, static_cast<std::uint32_t>(sequence), std::memory_order_seq_cst);
    ring_readers();
  }
  void ring_readers() { shm::ring(segment.header().wake_word, segment.header().waiting); }
  // Fills fresh_values.
  bool read_command(std::size_t index, CommandHead& head);
  CommandChange lose();
};

}  // namespace shm
