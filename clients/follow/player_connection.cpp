#include "player_connection.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <memory>
#include <utility>

#include "protocol/payloads.h"

namespace follow {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds answer_limit{5};

// True when the socket is ready before the deadline.
bool wait_for(int socket, short events, Clock::time_point deadline) {
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd one{socket, events, 0};
    const int ready = ::poll(&one, 1, static_cast<int>(left > 0 ? left : 0));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
    if (left <= 0) return false;
  }
}

// Empty when it is connected.
std::string why_not_connected(int socket, const addrinfo& address) {
  if (::connect(socket, address.ai_addr, address.ai_addrlen) == 0) return {};
  if (errno != EINPROGRESS) return std::strerror(errno);
  if (!wait_for(socket, POLLOUT, Clock::now() + answer_limit)) return "does not answer";
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size);
  return error == 0 ? std::string() : std::strerror(error);
}

}  // namespace

base::Result<int> PlayerConnection::connect(const std::string& host, std::uint16_t port) {
  const std::string where = host + ":" + std::to_string(port);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int code = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); code != 0)
    return base::Error{where + ": " + ::gai_strerror(code)};
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> info(found, &::freeaddrinfo);
  std::string why = "no address";
  for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
    const int socket = ::socket(one->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    why = socket >= 0 ? why_not_connected(socket, *one) : std::strerror(errno);
    if (why.empty()) return socket;
    if (socket >= 0) ::close(socket);
  }
  return base::Error{where + ": " + why};
}

PlayerConnection::PlayerConnection(PlayerConnection&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      where_(std::move(other.where_)),
      port_(other.port_),
      parser_(std::move(other.parser_)),
      data_(std::move(other.data_)) {}

PlayerConnection& PlayerConnection::operator=(PlayerConnection&& other) noexcept {
  std::swap(socket_, other.socket_);
  std::swap(where_, other.where_);
  std::swap(port_, other.port_);
  std::swap(parser_, other.parser_);
  std::swap(data_, other.data_);
  return *this;
}

PlayerConnection::~PlayerConnection() {
  if (socket_ >= 0) ::close(socket_);
}

base::Result<PlayerConnection> PlayerConnection::open(int socket, const std::string& host, std::uint16_t port, const std::string& key) {
  PlayerConnection connection(socket);
  connection.where_ = host + ":" + std::to_string(port);
  connection.port_ = port;
  const int on = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  std::array<char, player::banner_size> hello;
  std::size_t size = 0;
  const auto deadline = Clock::now() + answer_limit;
  while (size < hello.size()) {
    if (!wait_for(socket, POLLIN, deadline)) return base::Error{connection.where_ + " does not respond: it is not a Player server"};
    const ssize_t got = ::recv(socket, hello.data() + size, hello.size() - size, 0);
    if (got <= 0) return base::Error{connection.where_ + " has closed the connection"};
    size += static_cast<std::size_t>(got);
  }
  if (!std::string_view(hello.data(), hello.size()).starts_with("Player"))
    return base::Error{connection.where_ + " is not a Player server"};
  const auto pull =
      connection.request({}, player::player_request::datamode, player::encode_u32(static_cast<std::uint32_t>(player::DataMode::pull)));
  if (!pull) return pull.error();
  if (!key.empty()) {
    const auto admitted = connection.request({}, player::player_request::auth, player::encode_key(key));
    if (!admitted) return base::Error{connection.where_ + " rejects the key"};
  }
  return connection;
}

base::Result<void> PlayerConnection::subscribe(const player::Address& device) {
  const player::DeviceRequest wanted{device, static_cast<std::uint32_t>(player::Access::open), ""};
  auto answer = request({}, player::player_request::dev, player::encode(wanted));
  if (!answer) return answer.error();
  const auto given = player::decode_device_request(*answer);
  if (!given || given->access != wanted.access) return base::Error{where_ + " does not give " + player::to_text(device)};
  return {};
}

base::Result<std::string> PlayerConnection::request(const player::Address& device, std::uint8_t subtype, const std::string& payload) {
  const player::Header header{.address = device, .type = player::Type::request, .subtype = subtype, .timestamp = 0, .size = 0};
  if (auto good = send(player::encode(header, port_, payload)); !good) return good.error();
  const auto deadline = Clock::now() + answer_limit;
  while (true) {
    auto message = receive(deadline);
    if (!message) return message.error();
    if (!*message) return base::Error{where_ + " does not answer"};
    const player::Header& got = (*message)->header;
    if (got.type != player::Type::ack && got.type != player::Type::nack) {
      data_.push_back(std::move(**message));
      continue;
    }
    if (got.address != device || got.subtype != subtype) continue;  // of a round of data
    if (got.type == player::Type::nack)
      return base::Error{where_ + " rejects request " + std::to_string(subtype) + " to " + player::to_text(device)};
    return std::move((*message)->payload);
  }
}

base::Result<void> PlayerConnection::command(const player::Address& device, std::uint8_t subtype, const std::string& payload) {
  const player::Header header{.address = device, .type = player::Type::command, .subtype = subtype, .timestamp = 0, .size = 0};
  return send(player::encode(header, port_, payload));
}

base::Result<void> PlayerConnection::ask_for_data() {
  const player::Header header{
      .address = {}, .type = player::Type::request, .subtype = player::player_request::data, .timestamp = 0, .size = 0};
  return send(player::encode(header, port_));
}

base::Result<std::vector<player::Message>> PlayerConnection::read(std::chrono::milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  while (true) {
    auto message = receive(deadline);
    if (!message) return message.error();
    if (!*message) return std::vector<player::Message>();
    const auto type = (*message)->header.type;
    if (type == player::Type::data) data_.push_back(std::move(**message));
    if (type == player::Type::synch) return std::exchange(data_, {});
  }
}

base::Result<void> PlayerConnection::send(const std::string& bytes) {
  std::size_t sent = 0;
  const auto deadline = Clock::now() + answer_limit;
  while (sent < bytes.size()) {
    if (!wait_for(socket_, POLLOUT, deadline)) return base::Error{where_ + " accepts no more data"};
    const ssize_t size = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return base::Error{where_ + ": " + std::strerror(errno)};
    sent += static_cast<std::size_t>(size);
  }
  return {};
}

base::Result<std::optional<player::Message>> PlayerConnection::receive(Clock::time_point deadline) {
  while (true) {
    auto message = parser_.next();
    if (!message) return base::Error{where_ + " sends " + message.error().message};
    if (*message) return message;
    if (!wait_for(socket_, POLLIN, deadline)) return std::optional<player::Message>();
    std::array<char, 65536> buffer;
    const ssize_t size = ::recv(socket_, buffer.data(), buffer.size(), 0);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return base::Error{where_ + (size == 0 ? " has closed the connection" : std::string(": ") + std::strerror(errno))};
    parser_.feed({buffer.data(), static_cast<std::size_t>(size)});
  }
}

}  // namespace follow
