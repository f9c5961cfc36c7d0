// Requests to a simulation: the server's side (RequestBoard) and the client's (Requester). One thread at a time each.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/result.h"
#include "shm/client.h"
#include "shm/requests.h"
#include "shm/server.h"

namespace shm {

// Of a request and of a reply [bytes].
inline constexpr std::size_t max_text = std::size_t{64} << 20;

// Says which request a reply belongs to.
struct RequestTicket {
  std::uint32_t slot = 0;
  std::uint64_t owner = 0;
  std::uint64_t id = 0;
};

class RequestBoard {
 public:
  // `simulation` is the writer of the simulation iface; both must outlive the board.
  RequestBoard(IfaceWriter& simulation, Server& server);
  ~RequestBoard();

  struct Asked {
    RequestTicket ticket;
    Request request;
    pid_t pid;
  };
  // The requests that came since the last call, at most one per client. One that can't be decoded is answered here and not returned.
  // One load when there is nothing.
  std::vector<Asked> poll();
  // Once per request, now or later. Does nothing when the client has given up or died in between.
  void reply(const RequestTicket& ticket, const Reply& reply);
  // False once its client has given up or died, as far as poll() has noticed.
  bool is_awaited(const RequestTicket& ticket) const;

  // Sleeps until a client asks for something, joins or leaves, or wake() was called, or the deadline passes.
  void wait(std::chrono::steady_clock::time_point deadline);
  // The same for a server that has nothing else to do: a client that asks again at once finds it awake (see TurnWait).
  void wait_for_clients(std::chrono::steady_clock::time_point deadline);
  // Any thread.
  void wake();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// A client's line to the simulation of a server.
class Requester {
 public:
  static base::Result<Requester> open(std::uint32_t server_id);
  Requester(Requester&&) noexcept;
  Requester& operator=(Requester&&) noexcept;
  ~Requester();

  // The server's answer, also when it is a rejection. An error when the server does not answer in time or is gone.
  base::Result<Reply> ask(const Request& request, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  base::Result<Reply> ask_raw(const RawRequest& request, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  // The same in two calls, for a request without text that takes long: begin() sends it, await() waits for the answer. Nothing: there is
  // none yet; call await() again. The next begin() or ask(), and the end of this object, withdraw a request without an answer.
  base::Result<void> begin(const Request& request);
  base::Result<std::optional<Reply>> await(std::chrono::nanoseconds timeout);
  // The simulation iface: clock, statistics.
  Iface& simulation();

 private:
  struct State;
  explicit Requester(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace shm
