// A client's connection to a server of Player, in PULL mode. One thread at a time; every call waits at most its timeout.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "protocol/message.h"

namespace follow {

class PlayerConnection {
 public:
  // A socket for open().
  static base::Result<int> connect(const std::string& host, std::uint16_t port);
  // With the server's hello, PULL mode agreed upon, and the key sent, if there is one. Takes the socket.
  static base::Result<PlayerConnection> open(int socket, const std::string& host, std::uint16_t port, const std::string& key);
  PlayerConnection(PlayerConnection&& other) noexcept;
  PlayerConnection& operator=(PlayerConnection&& other) noexcept;
  ~PlayerConnection();

  base::Result<void> subscribe(const player::Address& device);
  // The payload of the answer; an error when the server rejects.
  base::Result<std::string> request(const player::Address& device, std::uint8_t subtype, const std::string& payload = {});
  base::Result<void> command(const player::Address& device, std::uint8_t subtype, const std::string& payload);

  // Asks for data; read() then gives it when there is some. One round at a time.
  base::Result<void> ask_for_data();
  // The data of the round, once it is complete; empty after the time-out.
  base::Result<std::vector<player::Message>> read(std::chrono::milliseconds timeout);

 private:
  explicit PlayerConnection(int socket) : socket_(socket) {}
  base::Result<void> send(const std::string& bytes);
  // The next message; nothing after the time-out.
  base::Result<std::optional<player::Message>> receive(std::chrono::steady_clock::time_point deadline);

  int socket_ = -1;
  std::string where_;
  std::uint16_t port_ = 0;
  player::MessageParser parser_{player::max_message};
  std::vector<player::Message> data_;  // of the round that comes
};

}  // namespace follow
