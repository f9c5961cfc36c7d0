#include "corba/orb/guarded_transport.h"

#include <omniORB4/CORBA.h>

#include <omniORB4/giopEndpoint.h>
#include <omniORB4/omniInterceptors.h>
#include <omniORB4/omniTransport.h>

// Each needs the one before it.
// clang-format off
#include <omniORB4/internal/giopStream.h>
#include <omniORB4/internal/giopStrand.h>
#include <omniORB4/internal/GIOP_S.h>
// clang-format on

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "base/descriptors.h"
#include "base/guarded.h"
#include "base/log.h"
#include "base/peer_account.h"
#include "base/text.h"
#include "corba/orb/call_context.h"
#include "corba/orb/principal.h"

namespace corba {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::string_view prefix = "giop:guarded:";
constexpr std::chrono::seconds first_message_time{10};  // for the first whole message of a connection
constexpr std::chrono::seconds silence{30};             // in the middle of a message
constexpr std::size_t max_connections = 2000;           // each has a thread
constexpr std::size_t leaving_files = 16;               // of connections that have been sent away and are not gone yet
constexpr std::size_t reserved_files = 64;              // for everything that is no connection from outside, and for those

class GuardedConnection;

struct GateState {
  AccessSettings settings{};
  std::size_t most = max_connections;
  std::map<const omni::giopConnection*, GuardedConnection*> connections{};  // by the connection that is guarded
  Clock::time_point last_complaint{};
  std::size_t complaints = 0;         // that were not logged
  std::set<std::string> endpoints{};  // their texts
};

// The end points are those of the process. Never destroyed: connections may go after it otherwise.
struct AccessControl {
  base::Guarded<GateState, base::Rank::peers> state;
  std::condition_variable gone;             // a connection
  std::atomic<std::size_t> in_progress{0};  // see GiopGate
  std::atomic<bool> are_open{false};        // to others than the own account
  static AccessControl& instance() {
    static AccessControl& access = *new AccessControl;
    return access;
  }
};

// One line a second at most, however many are sent away.
void complain(const std::string& line) {
  constexpr std::chrono::seconds pause{1};
  std::size_t others = 0;
  {
    auto state = AccessControl::instance().state.lock();
    const auto now = Clock::now();
    if (now - state->last_complaint < pause) {
      ++state->complaints;
      return;
    }
    state->last_complaint = now;
    others = std::exchange(state->complaints, 0);
  }
  base::log(base::Level::warn, "doors", "{}{}", line, others > 0 ? "; so were " + std::to_string(others) + " others" : "");
}

// "giop:tcp:127.0.0.1:40000", "giop:ssl:[::1]:2809"; nothing for other kinds.
std::optional<base::TcpEnd> tcp_end(std::string_view address) {
  if (!address.starts_with("giop:tcp:") && !address.starts_with("giop:ssl:")) return std::nullopt;
  address.remove_prefix(9);
  const auto colon = address.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const auto port = base::parse_integer(address.substr(colon + 1));
  auto host = address.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  if (!port || *port < 0 || *port > 65535) return std::nullopt;
  return base::TcpEnd{std::string(host), static_cast<std::uint16_t>(*port)};
}

struct Visitor {
  std::string address;
  std::optional<uid_t> account;
  bool is_own = false;
};

std::string to_text(const Visitor& visitor) {
  if (visitor.address.starts_with("giop:unix:")) return visitor.address;
  return visitor.address + (visitor.account ? " (account " + std::to_string(*visitor.account) + ")" : " (account unknown)");
}

Visitor recognise(omni::giopConnection& connection) {
  const auto text = [](const char* address) { return std::string(address != nullptr ? address : ""); };
  Visitor visitor{text(connection.peeraddress()), std::nullopt, false};
  const auto theirs = tcp_end(visitor.address);
  const auto ours = tcp_end(text(connection.myaddress()));
  if (!theirs || !ours) {
    visitor.is_own = true;  // a unix socket: the folder that it lies in lets nobody else come here
    return visitor;
  }
  visitor.account = base::account_of(*theirs, *ours);
  visitor.is_own = base::is_own_account(visitor.account);
  return visitor;
}

bool may_come_in(const Visitor& visitor, OpenTo open_to) {
  // The handshake comes next and rejects clients without a certificate.
  if (visitor.address.starts_with("giop:ssl:")) return true;
  if (visitor.is_own || open_to == OpenTo::network) return true;
  return open_to == OpenTo::host && visitor.account;
}

Principal kind_of(const Visitor& visitor) {
  if (visitor.is_own) return Principal::own;
  if (visitor.address.starts_with("giop:ssl:")) return Principal::certificate;
  return visitor.account ? Principal::host : Principal::network;
}

bool may_come_in(Principal principal, const AccessSettings& settings) {
  if (principal == Principal::own || settings.open_to == OpenTo::network) return true;
  return principal == Principal::host ? settings.open_to == OpenTo::host : principal == Principal::certificate && settings.has_tls;
}

std::atomic<Clock::rep> now_of(Clock::time_point time) { return time.time_since_epoch().count(); }

// ---- a connection

class GuardedConnection final : public omni::giopConnection {
 public:
  GuardedConnection(omni::giopConnection* inner, Visitor visitor, const GiopLimits& limits)
      : inner_(inner), visitor_(std::move(visitor)), gate_(limits, AccessControl::instance().in_progress), last_use_(now_of(born_)) {}

  int Send(void* octets, std::size_t size, const omni_time_t& deadline) override { return inner_->Send(octets, size, deadline); }

  int Recv(void* to, std::size_t size, const omni_time_t& deadline) override {
    const auto read = [&](std::byte* at, std::size_t most) { return inner_->Recv(at, most, earlier(deadline)); };
    const int got = gate_.receive(static_cast<std::byte*>(to), size, read);
    last_use_.store(Clock::now().time_since_epoch().count(), std::memory_order_relaxed);  // a hint, it orders nothing
    if (got > 0) return got;
    if (!gate_.problem().empty() && !std::exchange(is_complained_, true)) complain(to_text(visitor_) + " rejected: " + gate_.problem());
    if (gate_.messages() == 0 && gate_.problem().empty() && Clock::now() - born_ >= first_message_time) {
      complain(to_text(visitor_) + " rejected: no whole message in " + std::to_string(first_message_time.count()) + " s");
    }
    return -1;
  }

  void Shutdown() override { inner_->Shutdown(); }
  const char* myaddress() override { return inner_->myaddress(); }
  const char* peeraddress() override { return inner_->peeraddress(); }
  const char* peeridentity() override { return inner_->peeridentity(); }
  void* peerdetails() override { return inner_->peerdetails(); }
  // Over TLS the handshake.
  _CORBA_Boolean gatekeeperCheckSpecific(omni::giopStrand* strand) override {
    if (inner_->gatekeeperCheckSpecific(strand)) return true;
    complain(to_text(visitor_) + " rejected: no certificate of corba.tls.authority");
    return false;
  }
  void setSelectable(int now, _CORBA_Boolean has_more) override { inner_->setSelectable(now, has_more || gate_.has_more()); }
  void clearSelectable() override { inner_->clearSelectable(); }
  _CORBA_Boolean isSelectable() override { return inner_->isSelectable(); }
  _CORBA_Boolean Peek() override { return gate_.has_more() || inner_->Peek(); }

  const Visitor& visitor() const { return visitor_; }
  bool is_leaving() const { return is_leaving_; }
  // Its thread finds that there is nothing more to read, and takes it away.
  void send_away() {
    is_leaving_ = true;
    inner_->Shutdown();
  }
  Clock::rep last_use() const { return last_use_.load(std::memory_order_relaxed); }

 private:
  ~GuardedConnection() override {
    AccessControl::instance().state.lock()->connections.erase(inner_);
    AccessControl::instance().gone.notify_all();
    inner_->decrRefCount(true);
  }

  // The ORB's deadline, or ours if that is earlier.
  omni_time_t earlier(const omni_time_t& given) const {
    std::optional<Clock::duration> left;
    if (gate_.messages() == 0) left = born_ + first_message_time - Clock::now();
    if (gate_.is_in_message() && gate_.messages() > 0) left = silence;
    if (!left) return given;
    const auto ns = std::max<std::int64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(*left).count(), 1'000'000);
    constexpr std::int64_t second = 1'000'000'000;
    omni_time_t own;
    omni_thread::get_time(own, omni_time_t(static_cast<unsigned long>(ns / second), static_cast<unsigned long>(ns % second)));
    return given && given < own ? given : own;
  }

  omni::giopConnection* const inner_;
  const Visitor visitor_;
  const Clock::time_point born_ = Clock::now();
  GiopGate gate_;
  std::atomic<Clock::rep> last_use_;
  bool is_complained_ = false;
  bool is_leaving_ = false;  // guarded by the lock of AccessControl
};

// ---- a call

// Who sent the request that this thread runs; an address is shorter.
thread_local std::array<char, 128> address_of_caller{};

const char* to_text(Principal principal) {
  return principal == Principal::host          ? "another account of this machine"
         : principal == Principal::certificate ? "the owner of a certificate"
                                               : "another host";
}

// A process of our account may call for somebody else.
Principal principal_of(omni::GIOP_S& request) {
  const auto* connection = dynamic_cast<const GuardedConnection*>(request.strand().connection);
  if (connection == nullptr) return Principal::network;  // another kind of end point than those that are guarded
  const Principal who = kind_of(connection->visitor());
  if (who != Principal::own) return who;
  const auto said = said_by_call(request.service_contexts(), CallContext::principal);
  if (!said) return Principal::own;
  return *said == static_cast<std::uint64_t>(Principal::host) || *said == static_cast<std::uint64_t>(Principal::certificate)
             ? static_cast<Principal>(*said)
             : Principal::network;
}

_CORBA_Boolean remember_caller(omni::omniInterceptors::serverReceiveRequest_T::info_T& request) {
  const char* address = request.peeraddress();
  const std::string_view text = address != nullptr ? address : "";
  const auto length = text.copy(address_of_caller.data(), address_of_caller.size() - 1);
  address_of_caller[length] = '\0';
  const Principal who = principal_of(request.giop_s);
  set_principal(who);
  if (who != Principal::own && !may_come_in(who, AccessControl::instance().state.lock()->settings)) {
    complain(caller() + " asked for " + request.operation() + " for " + to_text(who) + " and was rejected");
    throw CORBA::NO_PERMISSION(0, CORBA::COMPLETED_NO);
  }
  return true;
}

// ---- an end point

class GuardedEndpoint final : public omni::giopEndpoint {
 public:
  // The end point of omniORB points into the text that it is made from, and deletes itself with its last connection, some time. So texts
  // are kept, each once.
  static omni::giopEndpoint* make(const std::string& plain) {
    const std::string& text = *AccessControl::instance().state.lock()->endpoints.insert(plain).first;
    omni::giopEndpoint* inner = omni::giopEndpoint::str2Endpoint(text.c_str());
    return inner != nullptr ? new GuardedEndpoint(inner) : nullptr;
  }
  ~GuardedEndpoint() override { delete inner_; }

  const char* type() const override { return inner_->type(); }
  const char* address() const override { return inner_->address(); }
  const omni::orbServer::EndpointList* addresses() const override { return inner_->addresses(); }
  _CORBA_Boolean publish(const omni::orbServer::PublishSpecs& specs, _CORBA_Boolean all_specs, _CORBA_Boolean all_endpoints,
                         omni::orbServer::EndpointList& published) override {
    if (no_publish()) inner_->set_no_publish();
    return inner_->publish(specs, all_specs, all_endpoints, published);
  }
  _CORBA_Boolean Bind() override { return inner_->Bind(); }

  omni::giopConnection* AcceptAndMonitor(omni::giopConnection::notifyReadable_t notify, void* cookie) override {
    notify_ = notify;
    cookie_ = cookie;
    for (;;) {
      omni::giopConnection* come = inner_->AcceptAndMonitor(&GuardedEndpoint::on_readable, this);
      if (come == nullptr) return nullptr;
      if (omni::giopConnection* guarded = let_in(come)) return guarded;
      come->Shutdown();
      come->decrRefCount(true);
    }
  }

  void Poke() override {
    is_poked_ = true;  // the next one to come is ourselves, and gone at once
    inner_->Poke();
  }

  void Shutdown() override {
    std::exchange(inner_, nullptr)->Shutdown();
    delete this;
  }

 private:
  omni::giopConnection* let_in(omni::giopConnection* come) {
    auto& access = AccessControl::instance();
    Visitor visitor = recognise(*come);
    const AccessSettings settings = access.state.lock()->settings;
    if (!is_poked_ && !may_come_in(visitor, settings.open_to)) {
      complain(to_text(visitor) + " rejected: corba.open_to is " + (settings.open_to == OpenTo::host ? "host" : "account"));
      return nullptr;
    }
    make_room();
    auto* made = new GuardedConnection(come, std::move(visitor), settings.limits);
    access.state.lock()->connections[come] = made;
    return made;
  }

  // Sends away whoever has been silent longest, strangers first. Callers that still want something connect again.
  static void make_room() {
    std::string gone;
    {
      auto& access = AccessControl::instance();
      auto state = access.state.lock();
      // Those that leave have their files until their threads have seen it.
      constexpr std::chrono::milliseconds timeout{500};
      if (state->connections.size() >= state->most + leaving_files)
        state.wait_for(access.gone, timeout, [&] { return state->connections.size() < state->most + leaving_files; });
      std::size_t staying = 0;
      GuardedConnection* oldest = nullptr;
      for (const auto& [inner, connection] : state->connections) {
        if (connection->is_leaving()) continue;
        ++staying;
        const auto order = [](const GuardedConnection& c) { return std::pair(c.visitor().is_own, c.last_use()); };
        if (oldest == nullptr || order(*connection) < order(*oldest)) oldest = connection;
      }
      if (staying < state->most || oldest == nullptr) return;
      gone = to_text(oldest->visitor());
      oldest->send_away();
    }
    complain(gone + " rejected: too many connections, and this one was silent longest");
  }

  // The ORB forgets a connection before it goes; nothing keeps it from going between the socket's news and this call but the count.
  static void on_readable(void* self, omni::giopConnection* inner) {
    auto* endpoint = static_cast<GuardedEndpoint*>(self);
    GuardedConnection* connection = nullptr;
    {
      const omni_tracedmutex_lock transport(*omni::omniTransportLock);
      auto state = AccessControl::instance().state.lock();
      const auto found = state->connections.find(inner);
      if (found == state->connections.end()) return;
      connection = found->second;
      connection->incrRefCount();
    }
    endpoint->notify_(endpoint->cookie_, connection);
    const omni_tracedmutex_lock transport(*omni::omniTransportLock);
    connection->decrRefCount();
  }

  explicit GuardedEndpoint(omni::giopEndpoint* inner) : inner_(inner) {}

  omni::giopEndpoint* inner_;
  omni::giopConnection::notifyReadable_t notify_ = nullptr;
  void* cookie_ = nullptr;
  std::atomic<bool> is_poked_{false};
};

// ---- the transport

class GuardedTransport final : public omni::giopTransportImpl {
 public:
  GuardedTransport() : giopTransportImpl("giop:guarded") {}
  omni::giopEndpoint* toEndpoint(const char* rest) override { return GuardedEndpoint::make(plain(rest)); }
  omni::giopAddress* toAddress(const char* rest) override { return omni::giopAddress::str2Address(plain(rest).c_str()); }
  _CORBA_Boolean isValid(const char* rest) override { return omni::giopEndpoint::strIsValidEndpoint(plain(rest).c_str()); }
  _CORBA_Boolean addToIOR(const char* rest, omni::IORPublish* publish) override {
    return omni::giopEndpoint::addToIOR(plain(rest).c_str(), publish);
  }
  const omnivector<const char*>* getInterfaceAddress() override { return nullptr; }

 private:
  static std::string plain(const char* rest) { return "giop:" + std::string(rest); }
};

}  // namespace

void set_access(const AccessSettings& settings) {
  static GuardedTransport& transport = *new GuardedTransport;  // known to the ORB from now on
  (void)transport;
  std::size_t most = max_connections;
  if (const std::size_t allowed = base::raise_descriptor_limit(); allowed > 0) {
    most = std::min(most, allowed > 2 * reserved_files ? allowed - reserved_files : allowed / 2);
  }
  auto state = AccessControl::instance().state.lock();
  state->settings = settings;
  AccessControl::instance().are_open = settings.open_to != OpenTo::account || settings.has_tls;
  state->most = std::max<std::size_t>(most, 1);
}

bool accepts_other_accounts() { return AccessControl::instance().are_open.load(std::memory_order_relaxed); }  // set before there is an ORB

std::string guarded(const std::string& endpoint) {
  for (const std::string_view kind : {"giop:tcp:", "giop:unix:", "giop:ssl:"}) {
    if (endpoint.starts_with(kind)) return std::string(prefix) + endpoint.substr(5);
  }
  return endpoint;
}

std::string unguarded(const std::string& endpoint) {
  return endpoint.starts_with(prefix) ? "giop:" + endpoint.substr(std::string_view(prefix).size()) : endpoint;
}

void remember_callers() {
  omniORB::getInterceptors()->serverReceiveRequest.add(&remember_caller);
  pass_on_principal();
}

bool has_caller() { return address_of_caller.front() != '\0'; }

std::string caller() {
  const std::string address = address_of_caller.data();
  if (address.empty()) return "this process";
  auto state = AccessControl::instance().state.lock();
  for (const auto& [inner, connection] : state->connections) {
    if (connection->visitor().address == address) return to_text(connection->visitor());
  }
  return address;
}

}  // namespace corba
