// Passes received data to the ORB as complete GIOP messages. omniORB 4.2 allocates memory for the length in a message header before the
// data arrive, and writes to freed memory if fragments arrive in an unexpected order. So messages are collected here, in memory that grows
// with the received bytes, and fragments are merged. Samples of data ports pass without a copy: only their number of bytes is allocated.
// Independent of the ORB. One thread at a time.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace corba {

// [octets], without the header of 12.
struct GiopLimits {
  std::size_t sample = std::size_t{128} << 20;  // a message of a data port (put, push), when `room` does not say less
  std::size_t request = std::size_t{2} << 20;   // any other message
  std::size_t direct = std::size_t{4} << 20;    // a sample up to this passes while it comes; a longer one is collected first
  std::size_t total = std::size_t{512} << 20;   // collected and claimed by all connections of the process together
  // false: no octet of the message after is read with one, for who looks at the connection itself to learn whether there is more.
  bool reads_ahead = true;
  // [octets] of samples that the object with that key needs (corba/ports/sample_room.h); never less than a request may have. Null:
  // `sample`.
  std::size_t (*room)(std::span<const std::byte> object_key) = nullptr;
};

class GiopGate {
 public:
  // Reads at most `size` octets: their number, 0 or less when there will be none.
  using Read = std::function<int(std::byte* to, std::size_t size)>;

  // `in_progress` counts for all gates of a process.
  GiopGate(const GiopLimits& limits, std::atomic<std::size_t>& in_progress) : limits_(limits), in_progress_(in_progress) {}
  ~GiopGate() { settle(); }
  GiopGate(const GiopGate&) = delete;
  GiopGate& operator=(const GiopGate&) = delete;

  // Some octets of whole messages, at least one; what `read` said when that ended, -1 when the peer is rejected (see problem()).
  int receive(std::byte* to, std::size_t size, const Read& read);

  // A message has begun and has not come whole. Also asked by who reads for receive().
  bool is_in_message() const { return direct_left_ > 0 || !ahead_.empty() || (held_.size() > room_ && delivered_ == whole_); }
  // Octets have been read that receive() has not given yet.
  bool has_more() const { return delivered_ < whole_ || !ahead_.empty(); }
  // Whole messages (or their beginnings, of samples that pass) that were handed on.
  std::uint64_t messages() const { return messages_; }
  // Why the peer was rejected; empty while it is not.
  const std::string& problem() const { return problem_; }

 private:
  struct Header;
  struct Room {
    std::size_t limit = 0;  // [octets] of the message
    bool is_port = false;   // it goes to a data port
  };
  static bool parse(std::span<const std::byte> octets, Header& header);
  static bool is_sample(std::span<const std::byte> message, const Header& header, std::span<const std::byte>& object_key);
  Room room_for(const Header& header) const;
  static std::uint32_t number_at(std::span<const std::byte> octets, std::size_t at, bool is_little);

  std::size_t whole_messages(std::span<const std::byte> octets);
  int read_on(const Read& read, std::byte* to, std::size_t size);
  int collect(const Read& read);
  int collect_fragments(const Read& read, const Header& first, std::size_t limit);
  int fill(const Read& read, std::size_t size);
  int deliver(std::byte* to, std::size_t size);
  int refuse(std::string problem);
  bool claim(std::size_t size);
  void settle();

  const GiopLimits limits_;
  std::atomic<std::size_t>& in_progress_;
  std::vector<std::byte> ahead_;  // read, of messages after the one in held_
  std::vector<std::byte> held_;   // one message, as far as it has come
  std::size_t room_ = 0;          // at its end, for what is being read
  std::size_t whole_ = 0;         // so much of held_ may be handed on
  std::size_t delivered_ = 0;
  std::size_t direct_left_ = 0;
  std::size_t claimed_ = 0;  // our part of in_progress_
  std::uint64_t messages_ = 0;
  bool is_broken_ = false;  // what came is no GIOP: the ORB answers that and closes
  std::string problem_;
};

}  // namespace corba
