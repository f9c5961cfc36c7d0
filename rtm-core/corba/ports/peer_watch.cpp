#include "corba/ports/peer_watch.h"

#include <omniORB4/omniORB.h>

#include <algorithm>
#include <condition_variable>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "base/guarded.h"
#include "base/log.h"
#include "corba/orb/call_timeout.h"
#include "corba/transport/transport.h"

namespace corba {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto question_timeout = std::chrono::milliseconds(1000);  // of one question
constexpr auto soon = std::chrono::milliseconds(200);               // after a first sign of death, and to meet a new peer
constexpr auto hung_timeout = std::chrono::milliseconds(100);       // is spent whole as long as it hangs
constexpr auto hung_timeout_afar = std::chrono::milliseconds(300);

struct Peer {
  RTC::PortService_var port;
  std::string address;  // of its process
};

// A connection of one of our ports.
using Key = std::pair<const LossHandler*, std::string>;
struct Watched {
  std::shared_ptr<LossHandler> loss;
  std::vector<Peer> peers;
};

struct State {
  std::map<Key, Watched> connections;
  bool has_new = false;
  bool is_stopping = false;
};

// The process is what its ports have in common, so this is a global. Never destroyed: ports may die after it otherwise.
struct Table {
  base::Guarded<State, base::Rank::peers> state;
  std::condition_variable changed;
  static Table& instance() {
    static Table& table = *new Table;
    return table;
  }
};

enum class Sign { life, object_is_gone, process_is_gone, silence };

Sign ask(CORBA::Object_ptr port, std::chrono::milliseconds limit = question_timeout) {
  try {
    // A reference of its own, so that the time-out touches nobody else's calls.
    const CORBA::ORB_var the_orb = orb();
    const CORBA::String_var text = the_orb->object_to_string(port);
    const CORBA::Object_var own = the_orb->string_to_object(text);
    limit_calls(own, limit);
    return own->_non_existent() ? Sign::object_is_gone : Sign::life;
  } catch (const CORBA::OBJECT_NOT_EXIST&) {
    return Sign::object_is_gone;
  } catch (const CORBA::TIMEOUT&) {
    return Sign::silence;
  } catch (const CORBA::TRANSIENT& e) {
    return e.minor() == omni::TRANSIENT_ConnectFailed ? Sign::process_is_gone : Sign::silence;
  } catch (const CORBA::COMM_FAILURE&) {
    return Sign::process_is_gone;
  } catch (const CORBA::Exception&) {
    return Sign::life;  // it says something
  }
}

class Rounds {
 public:
  explicit Rounds(std::chrono::milliseconds interval) : interval_(interval) {}

  void run() {
    auto& table = Table::instance();
    std::chrono::milliseconds pause = interval_;
    for (;;) {
      std::map<Key, Watched> connections;
      {
        auto state = table.state.lock();
        constexpr auto far = std::chrono::hours(24 * 365);
        state.wait_until(table.changed, Clock::now() + far, [&] { return state->is_stopping || !state->connections.empty(); });
        state.wait_until(table.changed, Clock::now() + pause, [&] { return state->is_stopping || state->has_new; });
        if (std::exchange(state->has_new, false)) {
          state.wait_until(table.changed, Clock::now() + std::min(soon, interval_), [&] { return state->is_stopping; });
        }
        if (state->is_stopping) return;
        connections = state->connections;
      }
      pause = look(connections) ? std::min(soon, interval_) : interval_;
    }
  }

 private:
  // True if somebody has shown the first sign of death.
  bool look(const std::map<Key, Watched>& connections) {
    ++round_;
    std::map<std::string, std::vector<std::pair<const Key*, const Peer*>>> processes;
    for (const auto& [key, watched] : connections) {
      for (const auto& peer : watched.peers) processes[peer.address].emplace_back(&key, &peer);
    }
    std::erase_if(hanging_, [&](const auto& address) { return !processes.contains(address); });
    std::erase_if(met_, [&](const auto& address) { return !processes.contains(address); });
    std::set<Key> suspects;
    const auto hung = hanging_;
    for (const bool hangs : {false, true}) {
      for (const auto& [address, members] : processes) {
        if (is_stopping()) return false;
        if (hung.contains(address) == hangs) look_at(address, members, suspects);
      }
    }
    std::vector<Key> dead;
    for (const auto& key : suspects) {
      if (suspects_.contains(key)) dead.push_back(key);
    }
    suspects_ = std::move(suspects);
    for (const auto& key : dead) {
      base::log(base::Level::warn, "port", "connection {}: the other port does not exist any more", key.second);
      suspects_.erase(key);
      try {
        connections.at(key).loss->lost(key.second);
      } catch (const std::exception& e) {  // the others are watched all the same
        base::log(base::Level::error, "port", "connection {}: its end failed: {}", key.second, e.what());
      }
    }
    return !suspects_.empty();
  }

  // One port speaks for its whole process, another one each time; if it is gone, each is asked.
  void look_at(const std::string& address, const std::vector<std::pair<const Key*, const Peer*>>& members, std::set<Key>& suspects) {
    const auto& first = members[round_ % members.size()];
    const bool has_hung = hanging_.erase(address) > 0;
    const auto brief = is_on_loopback(address) ? hung_timeout : hung_timeout_afar;
    const Sign sign = ask(first.second->port, has_hung ? brief : question_timeout);
    if (sign == Sign::silence) hanging_.insert(address);
    if (sign != Sign::process_is_gone) met_.insert(address);
    // One of another host that could never be called may be behind a wall and send to us all the same.
    if (sign == Sign::process_is_gone && (met_.contains(address) || is_on_loopback(address))) {
      for (const auto& [key, peer] : members) suspects.insert(*key);
    }
    if (sign != Sign::object_is_gone) return;
    for (const auto& [key, peer] : members) {
      if (is_stopping()) return;
      const Sign each = ask(peer->port);
      if (each == Sign::object_is_gone || each == Sign::process_is_gone) suspects.insert(*key);
      if (each == Sign::silence) return;
    }
  }

  static bool is_stopping() { return Table::instance().state.lock()->is_stopping; }

  const std::chrono::milliseconds interval_;
  std::size_t round_ = 0;
  std::set<Key> suspects_;
  std::set<std::string> met_;  // addresses that have answered once
  std::set<std::string> hanging_;
};

}  // namespace

bool is_on_loopback(std::string_view address) { return address.starts_with("127.") || address.starts_with("::1"); }

std::string process_address(CORBA::Object_ptr object) {
  omniIOR_var ior = object->_PR_getobj()->_getIOR();
  const auto& profiles = ior->iopProfiles();
  for (CORBA::ULong i = 0; i < profiles.length(); ++i) {
    if (profiles[i].tag != IOP::TAG_INTERNET_IOP) continue;
    IIOP::ProfileBody body;
    IIOP::unmarshalProfile(profiles[i], body);
    if (*body.address.host.in()) return std::string(body.address.host.in()) + ":" + std::to_string(body.address.port);
  }
  const CORBA::String_var text = orb()->object_to_string(object);
  return text.in();
}

PeerWatch::PeerWatch(std::chrono::milliseconds interval) : interval_(interval) {
  Table::instance().state.lock()->is_stopping = false;
  thread_ = std::thread([this] {
    try {
      Rounds(interval_).run();
    } catch (const std::exception& e) {
      base::log(base::Level::error, "port", "exited peers are not detected any more: {}", e.what());
    } catch (...) {
      base::log(base::Level::error, "port", "exited peers are not detected any more");
    }
  });
}

PeerWatch::~PeerWatch() {
  Table::instance().state.lock()->is_stopping = true;
  Table::instance().changed.notify_all();
  thread_.join();
}

void watch_peers(const std::string& connector_id, const RTC::PortServiceList& ports, RTC::PortService_ptr self,
                 const std::shared_ptr<LossHandler>& loss) {
  Watched watched{loss, {}};
  try {
    const std::string here = process_address(self);
    for (CORBA::ULong i = 0; i < ports.length(); ++i) {
      if (CORBA::is_nil(ports[i])) continue;
      const std::string address = process_address(ports[i]);
      if (address != here) watched.peers.push_back({RTC::PortService::_duplicate(ports[i]), address});
    }
  } catch (const CORBA::Exception&) {
    return;  // a reference of another kind, which cannot be grouped; its connection ends when it is used
  }
  if (watched.peers.empty()) return;
  auto& table = Table::instance();
  {
    auto state = table.state.lock();
    state->connections[{loss.get(), connector_id}] = std::move(watched);
    state->has_new = true;
  }
  table.changed.notify_all();
}

void forget_peers(const std::string& connector_id, const LossHandler& loss) {
  Watched forgotten;  // let go without the lock
  auto state = Table::instance().state.lock();
  const auto it = state->connections.find({&loss, connector_id});
  if (it == state->connections.end()) return;
  forgotten = std::move(it->second);
  state->connections.erase(it);
}

}  // namespace corba
