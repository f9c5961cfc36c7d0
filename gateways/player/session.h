// The connection of one client: requests, subscriptions and its queue. Memory is limited: a client that does not read gets newer data
// later, and its requests are not read while replies to it wait. One thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "access_policy.h"
#include "outbox.h"
#include "protocol/message.h"
#include "robot.h"

namespace gateway {

class Session final : public Client {
 public:
  // The largest payload that is taken; no request comes near it.
  static constexpr std::size_t max_payload = 1 << 20;
  // Answers that wait [bytes] before the client is no longer listened to.
  static constexpr std::size_t max_answers = 1 << 18;

  // Takes the connected, non-blocking socket and says hello. `access`, `robot` and `timeline` outlive the session. A client that needs the
  // key is served once it has sent it.
  Session(int socket, std::string peer, const AccessPolicy& access, bool needs_key, Robot& robot, const Timeline& timeline);
  ~Session() override;  // leaves all devices and closes
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void deliver(const player::Address& device, std::uint8_t subtype, const SharedBytes& message) override;

  // What poll said.
  void receive();
  // Answers what has come and sends what may go; to be called after anything has happened.
  void serve();
  // Ends the session of a client that lets others wait; to be called now and then.
  void check_timeouts(ClientTimeouts::Time now);
  // Has sent a whole request, and the key if it needs it.
  bool is_admitted() const { return has_asked_ && !needs_key_; }
  // Makes room for somebody else.
  void give_way() { end("too many clients, and this one has sent no request"); }
  // Once true it stays: the session is to be ended.
  bool is_over() const { return is_over_; }
  // EPOLLIN and EPOLLOUT as they are needed now.
  std::uint32_t wanted_events() const;
  int socket() const { return socket_; }
  std::uint32_t known_events = 0;  // what the event loop has set

 private:
  bool is_listening() const { return !is_waiting_ && outbox_.size() < max_answers; }
  void end(const std::string& why);
  void handle(const player::Message& message);
  void handle_player(const player::Message& message);
  void authenticate(const player::Message& message);
  void open_or_close(const player::Message& message);
  base::Error why_unknown(const player::Address& device) const;
  // Once for each device and command (0: of a subscription).
  void complain(const player::Address& device, std::uint8_t command, const std::string& what);
  void name_driver(const player::Message& message);
  void answer(const player::Header& asked, const Answer& answer);
  void send();

  const int socket_;
  const std::string peer_;
  const AccessPolicy& access_;
  Robot& robot_;
  const Timeline& timeline_;
  player::MessageParser parser_{max_payload};
  Outbox outbox_;
  std::set<std::pair<player::Address, std::uint8_t>> complaints_;
  ClientTimeouts timeouts_{std::chrono::steady_clock::now()};
  bool needs_key_, has_asked_ = false;
  int wrong_keys_ = 0;
  bool is_waiting_ = false;  // for the simulator to answer: the next request is not looked at before
  bool is_blocked_ = false;  // the socket takes no more
  bool is_over_ = false;
  std::shared_ptr<Session*> self_ = std::make_shared<Session*>(this);  // ends with us, for answers that come later
};

}  // namespace gateway
