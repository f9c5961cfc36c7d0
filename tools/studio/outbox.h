// The queue of messages to one viewer. Replies wait in order. Of each other kind only the newest message waits: a slow viewer gets fewer
// messages, never older ones. One thread at a time.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace studio {

struct Frame {
  bool is_binary = false;
  std::shared_ptr<const std::string> octets;
};

Frame text_frame(std::string text);
Frame binary_frame(std::string octets);

class Outbox {
 public:
  // Makes the frame when its turn comes; nothing: there is nothing new after all.
  using Maker = std::function<std::optional<Frame>()>;

  explicit Outbox(std::size_t max_octets) : max_octets_(max_octets) {}

  void put(Frame frame);
  // Takes the place of one with this key that still waits.
  void put_newest(const std::string& key, Frame frame);
  void put_newest(const std::string& key, Maker maker);
  void drop(const std::string& key);

  std::optional<Frame> next();
  bool is_empty() const { return entries_.empty(); }
  // More answers wait than one may hold: the viewer asks and does not read.
  bool is_overfull() const { return octets_ > max_octets_; }

 private:
  struct Entry {
    std::string key;  // empty: in order
    std::variant<Frame, Maker> what;
  };
  void replace(const std::string& key, std::variant<Frame, Maker> what);

  const std::size_t max_octets_;
  std::size_t octets_ = 0;  // of those in order
  std::deque<Entry> entries_;
};

}  // namespace studio
