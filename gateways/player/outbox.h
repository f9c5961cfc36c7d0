// The queue of messages to one client, and the rules by which a newer sample replaces an older one: PUSH, PULL and the replace rules of the
// client. No sockets. One thread at a time.
//
// Replies are sent at once. Data wait: in PULL until the client requests them, in PUSH until earlier data have been sent. The newest sample
// of a device and subtype replaces the one before, unless a rule of the client keeps all. Then, if too many wait, the oldest is dropped
// without a message, because clients crash on the message that has the number of lost samples.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "protocol/message.h"
#include "protocol/payloads.h"

namespace gateway {

// One encoding for all clients that get it.
using SharedBytes = std::shared_ptr<const std::string>;

class Outbox {
 public:
  // Of data that a rule keeps: messages of one device and subtype.
  static constexpr std::size_t max_kept = 64;
  static constexpr std::size_t max_rules = 256;

  explicit Outbox(std::uint32_t robot) : robot_(robot) {}

  void respond(std::string message);
  void deliver(const player::Address& device, std::uint8_t subtype, SharedBytes message);
  // The client has let go of the device: nothing of it may come any more.
  void forget(const player::Address& device);

  void set_mode(player::DataMode mode);
  player::DataMode mode() const { return mode_; }
  // The client asks for a round of data. In PULL the next flush() that has data ends with a synch message.
  void ask_for_data();
  // False when there are too many rules or `replace` is none of 0, 1, 2.
  bool add_rule(const player::ReplaceRule& rule);

  // Moves what may go now to the bytes to be sent; `time` [s] stamps the synch message.
  void flush(double time);

  // ---- bytes to be sent ----
  struct Piece {
    SharedBytes bytes;
    std::size_t sent = 0;
  };
  const std::deque<Piece>& pieces() const { return pieces_; }
  // [bytes]
  std::size_t size() const { return size_; }
  void sent(std::size_t bytes);

 private:
  struct Waiting {
    player::Address device;
    std::uint8_t subtype;
    SharedBytes message;
  };
  int rule_for(const player::Address& device, std::uint8_t subtype) const;
  void append(SharedBytes bytes);

  std::uint32_t robot_;
  player::DataMode mode_ = player::DataMode::push;
  bool is_asked_ = false;
  std::vector<player::ReplaceRule> rules_;
  std::deque<Waiting> waiting_;
  std::deque<Piece> pieces_;
  std::size_t size_ = 0;
};

}  // namespace gateway
