// Access control. Accepts the account of this process and root on this machine, other clients with the key if one is set, and every client
// if the gateway is open. Values; one thread at a time.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace gateway {

enum class Entry {
  welcome,
  needs_key,  // by an authentication request, before anything else is done for it
  refused,
};

struct AccessPolicy {
  static constexpr std::size_t max_key = 32;

  bool is_open = false;
  std::string key;  // at most max_key characters; empty: there is none

  // `socket` is connected.
  Entry entry(int socket) const;
  // Takes as long for each key that is wrong.
  bool fits(std::string_view offered) const;
};

// What is open, or shut, for people, where that is not what a user expects who said nothing; empty otherwise.
std::string describe(const AccessPolicy& access, const std::string& address);

// Timeouts of one client. Silent connections hold descriptors that other clients need; clients of Player ask for a mode at once.
class ClientTimeouts {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds first_request{5};  // whole, or the key, from the connection on
  static constexpr std::chrono::seconds whole_message{30};

  explicit ClientTimeouts(Time connected) : connected_(connected) {}
  // `is_admitted`: has sent a whole request, and the key where one is needed. `has_part`: a message has begun and not ended. Returns the
  // reason for closing the connection, if one has expired.
  std::optional<std::string_view> expired(Time now, bool is_admitted, bool has_part);

 private:
  Time connected_;
  std::optional<Time> part_since_;
};

}  // namespace gateway
