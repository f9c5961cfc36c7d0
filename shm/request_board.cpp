#include "shm/request_board.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "base/text.h"
#include "shm/attention.h"
#include "shm/futex.h"
#include "shm/process.h"
#include "shm/spinning.h"
#include "shm/words.h"

namespace shm {
namespace {

constexpr std::chrono::milliseconds board_slice{100};

char* request_text(const Segment& segment, std::size_t index) {
  return reinterpret_cast<char*>(segment.at(AreaIndex::requests, index) + sizeof(RequestSlot));
}
char* reply_text(const Segment& segment, std::size_t index) { return request_text(segment, index) + text_piece; }

RequestSlot& slot_at(const Segment& segment, std::size_t index) { return segment.as<RequestSlot>(AreaIndex::requests, index); }

}  // namespace

struct RequestBoard::State {
  State(const Segment& s, ProcessWatch& w) : segment(s), watch(w), clients(s.area(AreaIndex::requests).count) {}

  // What the server knows of a slot; the slot itself is in the hands of its client.
  struct ClientRecord {
    std::uint64_t owner = 0, start_time = 0;
    std::shared_ptr<const Watched> watched;
    std::uint64_t id = 0;
    bool is_complete = false, is_answered = true;
    RawRequest incoming;
    std::string remainder;           // of the reply's text
    std::size_t remainder_sent = 0;  // of these octets

    void drop_remainder() {
      remainder = {};
      remainder_sent = 0;
    }
  };

  const Segment& segment;
  ProcessWatch& watch;
  std::vector<ClientRecord> clients;
  std::uint32_t seen_attention = 0;
  std::uint64_t seen_deaths = ~std::uint64_t{0};
  TurnWait turn;

  Control& control() const { return segment.as<Control>(AreaIndex::control); }
  void reap();
  std::optional<Asked> take(std::size_t index);
  void put_piece(std::size_t index, std::uint64_t id);
  bool begin_reply(std::size_t index, std::uint64_t id);
  void end_reply(std::size_t index);
};

RequestBoard::RequestBoard(IfaceWriter& simulation, Server& server)
    : state_(std::make_unique<State>(simulation.segment(), server.watch())) {}
RequestBoard::~RequestBoard() = default;

void RequestBoard::State::reap() {
  for (std::size_t i = 0; i < clients.size(); ++i) {
    RequestSlot& slot = slot_at(segment, i);
    ClientRecord& client = clients[i];
    std::uint64_t owner = load(slot.owner);
    if (owner == 0) {
      client.watched.reset();
      continue;
    }
    const std::uint64_t start_time = load(slot.start_time);
    // A client writes its start time after its owner: seen between the two, it is still the same client. One that came after the last
    // look here is not watched yet. Of both a request may be known already.
    const bool is_other = client.owner != owner || (client.start_time != 0 && client.start_time != start_time);
    if (is_other) client = {};
    if (!client.watched || client.start_time != start_time) {
      client.owner = owner;
      client.start_time = start_time;
      client.watched = watch.watch({owner_pid(owner), load(slot.pid_namespace), start_time});
    }
    if (!client.watched->is_dead()) continue;
    store(slot.state, static_cast<std::uint32_t>(RTMSIM_SLOT_IDLE));
    store(slot.start_time, std::uint64_t{0});
    word(slot.owner).compare_exchange_strong(owner, 0, std::memory_order_acq_rel);
    client = {};
  }
}

bool RequestBoard::State::begin_reply(std::size_t index, std::uint64_t id) {
  RequestSlot& slot = slot_at(segment, index);
  std::uint32_t asked = RTMSIM_SLOT_ASKED;
  if (!word(slot.state).compare_exchange_strong(asked, RTMSIM_SLOT_REPLYING, std::memory_order_acq_rel)) return false;
  if (load(slot.id) == id) return true;
  store(slot.state, static_cast<std::uint32_t>(RTMSIM_SLOT_ASKED));  // the client has given up and asks for something else
  return false;
}

void RequestBoard::State::end_reply(std::size_t index) {
  RequestSlot& slot = slot_at(segment, index);
  store(slot.state, static_cast<std::uint32_t>(RTMSIM_SLOT_REPLIED), std::memory_order_seq_cst);  // pairs with Requester's wait
  futex_wake(slot.state, 1);
}

void RequestBoard::State::put_piece(std::size_t index, std::uint64_t id) {
  RequestSlot& slot = slot_at(segment, index);
  ClientRecord& client = clients[index];
  const std::string_view rest = std::string_view(client.remainder).substr(client.remainder_sent);
  const std::size_t length = std::min(rest.size(), text_piece);
  std::memcpy(reply_text(segment, index), rest.data(), length);
  client.remainder_sent += length;
  if (length == rest.size()) client.drop_remainder();
  slot.reply_id = id;
  slot.reply_length = static_cast<std::uint32_t>(length);
  slot.reply_more = client.remainder.empty() ? 0 : 1;
}

// Takes a piece of a request over; the request when it is complete.
std::optional<RequestBoard::Asked> RequestBoard::State::take(std::size_t index) {
  RequestSlot& slot = slot_at(segment, index);
  if (load(slot.state) != RTMSIM_SLOT_ASKED) return std::nullopt;  // pairs with the release in Requester
  ClientRecord& client = clients[index];
  const std::uint64_t owner = load(slot.owner), id = load(slot.id);
  if (owner == 0 || id == 0) return std::nullopt;
  if (client.owner != owner) client = {};
  client.owner = owner;
  const bool is_next_piece = client.id == id;
  if (is_next_piece && client.is_answered) {
    if (client.remainder.empty() || !begin_reply(index, id)) return std::nullopt;
    put_piece(index, id);
    end_reply(index);
    return std::nullopt;
  }
  if (is_next_piece && client.is_complete) return std::nullopt;  // being worked on
  if (!is_next_piece) {
    client.id = id;
    client.is_complete = client.is_answered = false;
    client.incoming = {};
    client.drop_remainder();
    client.incoming.kind = slot.kind;
    std::memcpy(&client.incoming.body, &slot.body, sizeof slot.body);
  }
  const std::size_t length = std::min<std::size_t>(slot.text_length, text_piece);
  client.incoming.text.append(request_text(segment, index), length);
  if (slot.more != 0 && client.incoming.text.size() <= max_text) {
    if (!begin_reply(index, id)) return std::nullopt;
    slot.status = RTMSIM_STATUS_OK;
    put_piece(index, id);
    end_reply(index);
    return std::nullopt;
  }
  client.is_complete = true;
  Asked asked{{static_cast<std::uint32_t>(index), owner, id}, PauseRequest{}, owner_pid(owner)};
  auto request = slot.more == 0 ? decode(client.incoming) : base::Result<Request>(base::Error{"request text is longer than 64 MiB"});
  client.incoming.text.clear();
  client.incoming.text.shrink_to_fit();
  if (!request) {
    client.is_answered = true;
    if (!begin_reply(index, id)) return std::nullopt;
    slot.status = RTMSIM_STATUS_BAD_REQUEST;
    slot.reply = {};
    set_text(slot.reply.message, request.error().message);
    put_piece(index, id);
    end_reply(index);
    return std::nullopt;
  }
  asked.request = std::move(*request);
  return asked;
}

std::vector<RequestBoard::Asked> RequestBoard::poll() {
  State& state = *state_;
  const std::uint32_t attention = load(state.control().attention);  // pairs with call_attention
  const std::uint64_t deaths = state.watch.deaths();
  std::vector<Asked> all;
  if (attention == state.seen_attention && deaths == state.seen_deaths) return all;
  state.seen_attention = attention;
  state.seen_deaths = deaths;
  state.reap();
  for (std::size_t i = 0; i < state.clients.size(); ++i) {
    if (auto asked = state.take(i)) all.push_back(std::move(*asked));
  }
  return all;
}

void RequestBoard::reply(const RequestTicket& ticket, const Reply& reply) {
  State& state = *state_;
  if (ticket.slot >= state.clients.size()) return;
  State::ClientRecord& client = state.clients[ticket.slot];
  RequestSlot& slot = slot_at(state.segment, ticket.slot);
  if (client.id != ticket.id || client.is_answered || load(slot.owner) != ticket.owner) return;
  client.is_answered = true;
  if (!state.begin_reply(ticket.slot, ticket.id)) return;
  client.remainder = reply.text;
  slot.status = static_cast<std::uint32_t>(reply.status);
  slot.reply.sim_time_ns = reply.sim_time_ns;
  slot.reply.steps = reply.steps;
  slot.reply.hash = reply.hash;
  slot.reply.count = reply.count;
  std::copy(std::begin(reply.values), std::end(reply.values), slot.reply.values);
  set_text(slot.reply.message, reply.message);
  state.put_piece(ticket.slot, ticket.id);
  state.end_reply(ticket.slot);
}

bool RequestBoard::is_awaited(const RequestTicket& ticket) const {
  const RequestSlot& slot = slot_at(state_->segment, ticket.slot);
  return load(slot.owner) == ticket.owner && load(slot.id) == ticket.id && load(slot.state) == RTMSIM_SLOT_ASKED;
}

void RequestBoard::wait(std::chrono::steady_clock::time_point deadline) {
  Control& control = state_->control();
  if (load(control.attention) != state_->seen_attention) return;
  announce(control.attention_waiting, state_->seen_attention);
  if (load(control.attention, std::memory_order_seq_cst) != state_->seen_attention) return;
  futex_wait(control.attention, state_->seen_attention, deadline - std::chrono::steady_clock::now());
}

void RequestBoard::wait_for_clients(std::chrono::steady_clock::time_point deadline) {
  State& state = *state_;
  if (state.turn.look([&state] { return load(state.control().attention) != state.seen_attention; }, deadline)) return;
  wait(deadline);
  state.turn.slept();
}

void RequestBoard::wake() { call_attention(state_->segment); }

struct Requester::State {
  State(Iface opened) : simulation(std::move(opened)) {}
  ~State() { leave(); }

  Iface simulation;
  std::uint64_t owner = 0;
  std::optional<std::size_t> index;
  std::uint64_t next_id = 1;
  TurnWait turn;

  const Segment& segment() const { return simulation.segment(); }
  RequestSlot& slot() const { return slot_at(segment(), *index); }
  base::Error fail(const std::string& what) const {
    return base::Error{"server " + std::to_string(simulation.server_id()) + " (pid " + std::to_string(segment().facts().server.pid) + ") " +
                       what};
  }
  base::Result<void> enter();
  void leave();
  std::optional<std::uint64_t> pending = std::nullopt;  // that was begun, and has no answer yet

  void hand_over();
  base::Result<bool> await(std::uint64_t id, std::chrono::steady_clock::time_point deadline);
  bool withdraw();
  void abandon();
  base::Result<void> exchange(std::uint64_t id, std::chrono::steady_clock::time_point deadline);
  std::uint64_t put(const RawRequest& request);
  base::Result<Reply> take_reply(std::uint64_t id, std::chrono::steady_clock::time_point deadline);
};

base::Result<void> Requester::State::enter() {
  if (index && load(slot().owner) == owner) return {};
  owner = make_owner();
  const ProcessMark mark = own_mark();
  for (std::size_t i = 0; i < segment().area(AreaIndex::requests).count; ++i) {
    std::uint64_t free = 0;
    RequestSlot& candidate = slot_at(segment(), i);
    if (!word(candidate.owner).compare_exchange_strong(free, owner, std::memory_order_acq_rel)) continue;
    store(candidate.pid_namespace, mark.pid_namespace);
    store(candidate.start_time, mark.start_time);
    store(candidate.state, static_cast<std::uint32_t>(RTMSIM_SLOT_IDLE));
    index = i;
    return {};
  }
  return fail("has no free slot for requests");
}

void Requester::State::leave() {
  if (!index || load(slot().owner) != owner) return;
  store(slot().state, static_cast<std::uint32_t>(RTMSIM_SLOT_IDLE));
  store(slot().start_time, std::uint64_t{0});
  word(slot().owner).compare_exchange_strong(owner, 0, std::memory_order_acq_rel);
  index.reset();
}

void Requester::State::hand_over() {
  store(slot().state, static_cast<std::uint32_t>(RTMSIM_SLOT_ASKED), std::memory_order_seq_cst);  // pairs with RequestBoard's take
  call_attention(segment());
}

// Waits until the slot comes back. False: not until the deadline; the server may still answer.
base::Result<bool> Requester::State::await(std::uint64_t id, std::chrono::steady_clock::time_point deadline) {
  RequestSlot& mine = slot();
  const auto is_back = [&mine] {
    const std::uint32_t state = load(mine.state);
    return state == RTMSIM_SLOT_REPLIED || state == RTMSIM_SLOT_IDLE;
  };
  const bool sleeps = !turn.look(is_back, deadline);
  while (true) {
    const std::uint32_t seen = load(mine.state, std::memory_order_seq_cst);
    if (sleeps && is_back()) turn.slept();
    if (seen == RTMSIM_SLOT_REPLIED && mine.reply_id == id) return true;
    if (seen == RTMSIM_SLOT_REPLIED || seen == RTMSIM_SLOT_IDLE) return fail("answered something that was not asked");
    if (simulation.status() != Status::live) return fail("has ended");
    const auto left = deadline - std::chrono::steady_clock::now();
    if (left.count() <= 0) return false;
    futex_wait(mine.state, seen, std::min<std::chrono::nanoseconds>(left, board_slice));
  }
}

// Takes the slot back. False: the server is just writing its reply.
bool Requester::State::withdraw() {
  std::uint32_t asked = RTMSIM_SLOT_ASKED;
  return word(slot().state).compare_exchange_strong(asked, RTMSIM_SLOT_IDLE, std::memory_order_acq_rel);
}

// Hands the slot to the server and waits until it comes back.
base::Result<void> Requester::State::exchange(std::uint64_t id, std::chrono::steady_clock::time_point deadline) {
  hand_over();
  auto answered = await(id, deadline);
  if (answered && !*answered && !withdraw()) answered = await(id, deadline + std::chrono::seconds(1));
  if (!answered) return answered.error();
  return *answered ? base::Result<void>() : fail("did not answer in time");
}

std::uint64_t Requester::State::put(const RawRequest& request) {
  RequestSlot& mine = slot();
  const std::uint64_t id = (owner << 32) ^ next_id++;
  store(mine.id, id);
  mine.kind = request.kind;
  mine.body = request.body;
  return id;
}

base::Result<Reply> Requester::State::take_reply(std::uint64_t id, std::chrono::steady_clock::time_point deadline) {
  RequestSlot& mine = slot();
  Reply reply;
  reply.status = static_cast<RequestStatus>(mine.status);
  reply.sim_time_ns = mine.reply.sim_time_ns;
  reply.steps = mine.reply.steps;
  reply.hash = mine.reply.hash;
  reply.count = mine.reply.count;
  std::copy(std::begin(mine.reply.values), std::end(mine.reply.values), reply.values);
  reply.message.assign(mine.reply.message, strnlen(mine.reply.message, sizeof mine.reply.message));
  while (true) {
    reply.text.append(reply_text(segment(), *index), std::min<std::size_t>(mine.reply_length, text_piece));
    if (mine.reply_more == 0 || reply.text.size() > max_text) break;
    mine.text_length = 0;
    mine.more = 0;
    if (auto good = exchange(id, deadline); !good) return good.error();
  }
  store(mine.state, static_cast<std::uint32_t>(RTMSIM_SLOT_IDLE));
  return reply;
}

// A request that nobody waits for any more must not be answered into the next one. A server that is just writing its reply ends it first.
void Requester::State::abandon() {
  const auto id = std::exchange(pending, std::nullopt);
  if (!id || !index || load(slot().owner) != owner || withdraw()) return;
  static_cast<void>(await(*id, std::chrono::steady_clock::now() + std::chrono::seconds(1)));
  store(slot().state, static_cast<std::uint32_t>(RTMSIM_SLOT_IDLE));
}

Requester::Requester(std::unique_ptr<State> state) : state_(std::move(state)) {}
Requester::Requester(Requester&&) noexcept = default;
Requester& Requester::operator=(Requester&&) noexcept = default;
Requester::~Requester() = default;

base::Result<Requester> Requester::open(std::uint32_t server_id) {
  auto simulation = Iface::open(server_id, IfaceType::simulation, "world");
  if (!simulation) return simulation.error();
  if (simulation->segment().area(AreaIndex::control).count == 0) return base::Error{"the simulation iface has no slots for requests"};
  return Requester(std::make_unique<State>(std::move(*simulation)));
}

Iface& Requester::simulation() { return state_->simulation; }

base::Result<Reply> Requester::ask(const Request& request, std::chrono::nanoseconds timeout) { return ask_raw(encode(request), timeout); }

base::Result<Reply> Requester::ask_raw(const RawRequest& request, std::chrono::nanoseconds timeout) {
  State& state = *state_;
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  if (request.text.size() > max_text) return base::Error{"request text is longer than 64 MiB"};
  state.abandon();
  if (auto good = state.enter(); !good) return good.error();
  RequestSlot& slot = state.slot();
  const std::uint64_t id = state.put(request);
  std::size_t sent = 0;
  do {
    const std::size_t length = std::min(request.text.size() - sent, text_piece);
    std::memcpy(request_text(state.segment(), *state.index), request.text.data() + sent, length);
    sent += length;
    slot.text_length = static_cast<std::uint32_t>(length);
    slot.more = sent < request.text.size() ? 1 : 0;
    if (auto good = state.exchange(id, deadline); !good) return good.error();
  } while (sent < request.text.size() && slot.status == RTMSIM_STATUS_OK);
  return state.take_reply(id, deadline);
}

base::Result<void> Requester::begin(const Request& request) {
  State& state = *state_;
  const RawRequest raw = encode(request);
  if (!raw.text.empty()) return base::Error{"request " + std::string(request_name(request)) + ": has a text, which ask() sends"};
  state.abandon();
  if (auto good = state.enter(); !good) return good;
  RequestSlot& slot = state.slot();
  state.pending = state.put(raw);
  slot.text_length = 0;
  slot.more = 0;
  state.hand_over();
  return {};
}

base::Result<std::optional<Reply>> Requester::await(std::chrono::nanoseconds timeout) {
  State& state = *state_;
  if (!state.pending) return base::Error{"no request was begun"};
  const auto answered = state.await(*state.pending, std::chrono::steady_clock::now() + timeout);
  if (!answered) return answered.error();
  if (!*answered) return std::optional<Reply>();
  const auto id = *std::exchange(state.pending, std::nullopt);
  constexpr std::chrono::seconds rest_of_text{10};
  auto reply = state.take_reply(id, std::chrono::steady_clock::now() + rest_of_text);
  if (!reply) return reply.error();
  return std::optional(std::move(*reply));
}

}  // namespace shm
