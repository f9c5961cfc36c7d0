// A TCP port that clients connect to. One thread at a time.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"

namespace gateway {

class Listener {
 public:
  // `address` is an IPv4 or IPv6 address in numbers; port 0 takes any free one.
  static base::Result<Listener> open(const std::string& address, std::uint16_t port);
  Listener(Listener&& other) noexcept;
  Listener& operator=(Listener&&) = delete;
  ~Listener();

  int socket() const { return socket_; }
  std::uint16_t port() const { return port_; }

  struct Accepted {
    int socket = -1;  // -1: nobody waits
    std::string peer;
    bool is_exhausted = false;  // no descriptors left: try again when some are free
  };
  Accepted accept() const;

 private:
  Listener(int socket, std::uint16_t port) : socket_(socket), port_(port) {}
  int socket_;
  std::uint16_t port_;
};

}  // namespace gateway
