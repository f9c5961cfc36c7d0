#include "corba/farewell.h"

#include <omniORB4/minorCode.h>
#include <omnithread.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <string>
#include <thread>
#include <utility>

#include "base/guarded.h"
#include "base/log.h"
#include "corba/call_timeout.h"
#include "corba/peer_watch.h"

namespace corba {
namespace {

// Leaving takes a port no time.
constexpr auto patience = std::chrono::milliseconds(1000);

struct Message {
  RTC::PortService_var port;
  std::string connector_id;
};

// What the processes that hang have not been told yet, by their address; each has a thread that tries. A global, as the processes are for
// all ports. Never destroyed: a thread may be in a call at the very end.
using Untold = std::map<std::string, std::deque<Message>>;
base::Guarded<Untold, base::Rank::registry>& untold() {
  static auto& table = *new base::Guarded<Untold, base::Rank::registry>;
  return table;
}

// False if the process is not known to hang.
bool leave_message(const std::string& address, RTC::PortService_ptr port, const char* connector_id) {
  auto table = untold().lock();
  const auto found = table->find(address);
  if (found == table->end()) return false;
  found->second.push_back({RTC::PortService::_duplicate(port), connector_id});
  return true;
}

// Gives up with the first message that nobody takes.
void tell_late(const std::string& address) {
  const omni_thread::ensure_self known_to_the_orb;  // time-outs need it
  for (;;) {
    Message message;
    {
      auto table = untold().lock();
      auto& messages = (*table)[address];
      if (messages.empty()) {
        table->erase(address);
        return;
      }
      message = std::move(messages.front());
      messages.pop_front();
    }
    try {
      limit_calls(message.port, port_call_timeout());
      message.port->notify_disconnect(message.connector_id.c_str());
    } catch (const CORBA::Exception& e) {
      std::deque<Message> dropped;  // let go without the lock
      {
        auto table = untold().lock();
        dropped = std::move((*table)[address]);
        table->erase(address);
      }
      base::log(base::Level::debug, "port", "{} does not hear that {} connections have ended: {}", address, dropped.size() + 1, e._name());
      return;
    }
  }
}

void tell_later(const std::string& address, RTC::PortService_ptr port, const char* connector_id) {
  {
    auto table = untold().lock();
    const bool has_thread = table->contains(address);
    (*table)[address].push_back({RTC::PortService::_duplicate(port), connector_id});
    if (has_thread) return;
  }
  std::thread([address] { tell_late(address); }).detach();
}

}  // namespace

std::optional<RTC::ReturnCode_t> take_leave(RTC::PortService_ptr port, const char* connector_id, CORBA::ULong left) {
  std::string address;
  try {
    address = process_address(port);
    if (leave_message(address, port, connector_id)) return std::nullopt;
    limit_calls(port, std::min(port_call_timeout(), patience) * static_cast<int>(left));
    return port->notify_disconnect(connector_id);
  } catch (const CORBA::TIMEOUT&) {
    tell_later(address, port, connector_id);
  } catch (const CORBA::TRANSIENT& e) {
    if (e.minor() == omni::TRANSIENT_CallTimedout) tell_later(address, port, connector_id);
  } catch (const CORBA::Exception&) {
    // Dead: there is nobody to tell.
  }
  return std::nullopt;
}

}  // namespace corba
