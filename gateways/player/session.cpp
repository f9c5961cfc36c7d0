#include "session.h"

#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "base/log.h"
#include "base/text.h"

namespace gateway {
namespace {

void set_flag(int socket, int level, int option) {
  const int on = 1;
  ::setsockopt(socket, level, option, &on, sizeof on);
}

}  // namespace

Session::Session(int socket, std::string peer, const AccessPolicy& access, bool needs_key, Robot& robot, const Timeline& timeline)
    : socket_(socket),
      peer_(std::move(peer)),
      access_(access),
      robot_(robot),
      timeline_(timeline),
      outbox_(robot.port()),
      needs_key_(needs_key) {
  set_flag(socket_, IPPROTO_TCP, TCP_NODELAY);
  set_flag(socket_, SOL_SOCKET, SO_KEEPALIVE);
  // Clients expect it whole in their first read.
  outbox_.respond(player::banner(RTMSIM_VERSION));
  send();
}

Session::~Session() {
  robot_.leave(*this);
  ::close(socket_);
}

void Session::end(const std::string& why) {
  if (!is_over_ && !why.empty()) base::log(base::Level::info, "player-gateway", "port {}: {}: {}; closed", robot_.port(), peer_, why);
  is_over_ = true;
}

void Session::check_timeouts(ClientTimeouts::Time now) {
  // Bytes that wait while the client is not listened to are not its fault.
  if (const auto why = timeouts_.expired(now, is_admitted(), is_listening() && parser_.pending() > 0)) end(std::string(*why));
}

void Session::deliver(const player::Address& device, std::uint8_t subtype, const SharedBytes& message) {
  outbox_.deliver(device, subtype, message);
}

std::uint32_t Session::wanted_events() const {
  return (is_listening() ? static_cast<std::uint32_t>(EPOLLIN) : 0U) | (is_blocked_ ? static_cast<std::uint32_t>(EPOLLOUT) : 0U);
}

void Session::receive() {
  std::array<char, 65536> buffer;
  const ssize_t size = ::recv(socket_, buffer.data(), buffer.size(), 0);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) return end("");
  // Clients write a command and then a request; without this the second waits for a delayed acknowledgement of the first.
  set_flag(socket_, IPPROTO_TCP, TCP_QUICKACK);
  parser_.feed({buffer.data(), static_cast<std::size_t>(size)});
}

void Session::serve() {
  while (!is_over_ && is_listening()) {
    auto message = parser_.next();
    if (!message) return end(message.error().message);
    if (!*message) break;
    handle(**message);
  }
  if (!is_over_) send();
}

void Session::handle(const player::Message& message) {
  const player::Header& header = message.header;
  const bool is_player = header.address.interface == player::Interface::player;
  if (header.type == player::Type::request) has_asked_ = true;
  if (needs_key_ && !(header.type == player::Type::request && is_player && header.address.index == 0)) {
    if (header.type == player::Type::request) answer(header, nack());
    return;
  }
  if (header.type == player::Type::command) {
    Device* device = robot_.find(header.address);
    if (device != nullptr && !device->command(*this, header.subtype, message.payload))
      complain(header.address, header.subtype,
               fmt::format("command {} of {} is not served", header.subtype, player::to_text(header.address)));
    return;
  }
  if (header.type != player::Type::request) return;  // clients have nothing else to say
  if (is_player && header.address.index == 0) return handle_player(message);
  Device* device = robot_.find(header.address);
  if (device == nullptr) return answer(header, nack());
  is_waiting_ = true;
  const auto later = [weak = std::weak_ptr(self_), header](const Answer& given) {
    const auto self = weak.lock();
    if (!self) return;
    (*self)->is_waiting_ = false;
    (*self)->answer(header, given);
  };
  const auto at_once = device->request(header.subtype, message.payload, later);
  if (at_once) later(*at_once);
}

void Session::authenticate(const player::Message& message) {
  constexpr int max_wrong_keys = 3;
  const auto key = player::decode_key(message.payload);
  const bool is_right = key && access_.fits(*key);
  needs_key_ = needs_key_ && !is_right;
  answer(message.header, is_right ? ack() : nack());
  if (!is_right && needs_key_ && ++wrong_keys_ == max_wrong_keys) end("has sent three keys that are wrong");
}

void Session::handle_player(const player::Message& message) {
  const player::Header& header = message.header;
  // The mode is asked for before anything else, by clients that do not look at the answer.
  if (needs_key_ && header.subtype != player::player_request::auth && header.subtype != player::player_request::datamode)
    return answer(header, nack());
  switch (header.subtype) {
    case player::player_request::auth:
      return authenticate(message);
    case player::player_request::devlist:
      return answer(header, ack(player::encode_device_list(robot_.devices())));
    case player::player_request::driverinfo:
      return name_driver(message);
    case player::player_request::dev:
      return open_or_close(message);
    case player::player_request::data:
      answer(header, ack());
      return outbox_.ask_for_data();
    case player::player_request::datamode: {
      const auto mode = player::decode_byte(message.payload);
      if (!mode ||
          (*mode != static_cast<std::uint8_t>(player::DataMode::push) && *mode != static_cast<std::uint8_t>(player::DataMode::pull)))
        return answer(header, nack());
      outbox_.set_mode(static_cast<player::DataMode>(*mode));
      return answer(header, ack());
    }
    case player::player_request::add_replace_rule: {
      const auto rule = player::decode_replace_rule(message.payload);
      return answer(header, rule && outbox_.add_rule(*rule) ? ack() : nack());
    }
    default:
      return answer(header, nack());
  }
}

void Session::name_driver(const player::Message& message) {
  auto info = player::decode_driver_info(message.payload);
  const Device* device = info ? robot_.find(info->address) : nullptr;
  if (device == nullptr) return answer(message.header, nack());
  info->driver = device->driver();
  answer(message.header, ack(player::encode(*info)));
}

base::Error Session::why_unknown(const player::Address& device) const {
  std::vector<std::string> there;
  for (const auto& one : robot_.devices()) there.push_back(player::to_text(one));
  const std::string list = there.empty() ? "" : "; there are " + base::join(there, " ");
  // No program reads the numbers, and another index would not help.
  if (player::to_text(device.interface).empty()) {
    const auto name = player::any_name(device.interface);
    return {(name.empty() ? "interface " + std::to_string(static_cast<unsigned>(device.interface)) : std::string(name)) + " is not served" +
            list};
  }
  return {"there is no " + player::to_text(device) + list};
}

void Session::complain(const player::Address& device, std::uint8_t command, const std::string& what) {
  constexpr std::size_t most = 20;  // of one client
  if (complaints_.size() >= most || !complaints_.insert({device, command}).second) return;
  base::log(base::Level::warn, "player-gateway", "port {}: {}: {}", robot_.port(), peer_, what);
}

// Clients look into the answer without asking whether there is one, so also a rejection has it.
void Session::open_or_close(const player::Message& message) {
  auto request = player::decode_device_request(message.payload);
  if (!request) return answer(message.header, nack());
  Device* device = robot_.find(request->address);
  bool is_done = false;
  const bool is_new = device != nullptr && !device->is_subscribed(*this);
  if (request->access == static_cast<std::uint32_t>(player::Access::open)) {
    const auto opened = device != nullptr ? device->subscribe(*this) : base::Result<void>(why_unknown(request->address));
    is_done = opened.ok();
    if (!opened) complain(request->address, 0, "subscription rejected: " + opened.error().message);
  } else if (device != nullptr && request->access == static_cast<std::uint32_t>(player::Access::close)) {
    is_done = device->unsubscribe(*this);
    if (!device->is_subscribed(*this)) outbox_.forget(request->address);
  }
  request->driver = is_done ? device->driver() : std::string();
  if (!is_done) request->access = static_cast<std::uint32_t>(player::Access::error);
  answer(message.header, {is_done, player::encode(*request)});
  if (is_new && is_done) device->show_latest(*this);
}

void Session::answer(const player::Header& asked, const Answer& given) {
  player::Header header = asked;
  header.type = given.is_ack ? player::Type::ack : player::Type::nack;
  header.timestamp = timeline_.latest();
  outbox_.respond(player::encode(header, robot_.port(), given.payload));
}

void Session::send() {
  constexpr std::size_t at_once = 256;
  is_blocked_ = false;
  outbox_.flush(timeline_.latest());
  while (!outbox_.pieces().empty()) {
    std::array<iovec, at_once> parts;
    msghdr message{};
    message.msg_iov = parts.data();
    for (const auto& piece : outbox_.pieces()) {
      if (message.msg_iovlen == at_once) break;
      // sendmsg does not write to it.
      parts[message.msg_iovlen++] = {const_cast<char*>(piece.bytes->data()) + piece.sent, piece.bytes->size() - piece.sent};
    }
    const ssize_t size = ::sendmsg(socket_, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      is_blocked_ = true;
      return;
    }
    if (size < 0) return end("");
    outbox_.sent(static_cast<std::size_t>(size));
    if (outbox_.pieces().empty()) outbox_.flush(timeline_.latest());
  }
}

}  // namespace gateway
