#include "corba/farewell.h"

#include <omniORB4/minorCode.h>
#include <omnithread.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <string>
#include <thread>
#include <utility>

#include "base/guarded.h"
#include "corba/call_timeout.h"
#include "corba/peer_watch.h"

namespace corba {
namespace {

using Clock = std::chrono::steady_clock;

// Leaving takes a port no time.
constexpr auto patience = std::chrono::milliseconds(1000);
// Of one of the calls by which a process that hangs is tried again; the end of the ORB waits for the last of them.
constexpr auto attempt = std::chrono::milliseconds(300);
// Between two of them, the longer the process has hung.
constexpr auto longest_pause = std::chrono::milliseconds(1000);
constexpr auto longest_hang = std::chrono::minutes(10);

struct Message {
  RTC::PortService_var port;
  std::string connector_id;
  Clock::time_point deadline;
};

struct Process {
  std::deque<Message> untold;
  bool hangs = false;  // a call has taken its time-out
};

struct State {
  std::map<std::string, Process> processes;  // by address; each has a thread that tries
  int threads = 0;
  bool is_ending = true;  // also before the beginning
};

// The processes are for all ports, so this is a global. Never destroyed: ports may die after it otherwise.
struct Table {
  base::Guarded<State, base::Rank::registry> state;
  std::condition_variable changed;
  static Table& instance() {
    static Table& table = *new Table;
    return table;
  }
};

// False if the process is not known to hang.
bool leave_message(const std::string& address, RTC::PortService_ptr port, const char* connector_id) {
  auto state = Table::instance().state.lock();
  const auto found = state->processes.find(address);
  if (found == state->processes.end() || !found->second.hangs) return false;
  found->second.untold.push_back({RTC::PortService::_duplicate(port), connector_id, Clock::now() + port_call_timeout()});
  return true;
}

bool is_time_out(const CORBA::SystemException& problem) {
  return dynamic_cast<const CORBA::TIMEOUT*>(&problem) ||
         (dynamic_cast<const CORBA::TRANSIENT*>(&problem) && problem.minor() == omni::TRANSIENT_CallTimedout);
}

// Whether the process was reached. It is asked something harmless until it answers: what waits in its sockets when it wakes must not end a
// connection that was made anew under the same id.
bool deliver(const Message& message, bool is_awake) {
  try {
    limit_calls(message.port, std::min(port_call_timeout(), attempt));
    if (!is_awake) message.port->_non_existent();
    message.port->notify_disconnect(message.connector_id.c_str());
  } catch (const CORBA::SystemException& e) {
    return !is_time_out(e);  // any other problem is an answer, too
  } catch (const CORBA::Exception&) {
    // Of another make, and odd: it has got the message.
  }
  return true;
}

// Until each message is delivered or past its deadline.
void tell_late(const std::string& address) {
  const omni_thread::ensure_self known_to_the_orb;  // time-outs need it
  auto& table = Table::instance();
  const auto start = Clock::now();
  bool is_awake = false;
  while (true) {
    std::deque<Message> dropped;  // let go without the lock
    Message message;
    {
      auto state = table.state.lock();
      auto& messages = state->processes[address].untold;
      if (messages.empty() || state->is_ending) {
        dropped = std::move(messages);
        state->processes.erase(address);
        break;
      }
      message = messages.front();
    }
    is_awake = deliver(message, is_awake);
    auto state = table.state.lock();
    Process& process = state->processes[address];
    process.hangs = !is_awake;
    if (is_awake || Clock::now() >= message.deadline)
      process.untold.pop_front();
    else
      state.wait_for(table.changed, std::min<Clock::duration>((Clock::now() - start) / 4, longest_pause), [&] { return state->is_ending; });
  }
}

void tell_later(const std::string& address, RTC::PortService_ptr port, const char* connector_id, bool hangs, Clock::duration lasts) {
  {
    auto state = Table::instance().state.lock();
    if (state->is_ending) return;
    const bool has_thread = state->processes.contains(address);
    Process& process = state->processes[address];
    process.hangs = process.hangs || hangs;
    process.untold.push_back({RTC::PortService::_duplicate(port), connector_id, Clock::now() + lasts});
    if (has_thread) return;
    ++state->threads;
  }
  std::thread([address] {
    tell_late(address);
    --Table::instance().state.lock()->threads;
    Table::instance().changed.notify_all();
  }).detach();
}

}  // namespace

void begin_farewells() { Table::instance().state.lock()->is_ending = false; }

void end_farewells() {
  auto& table = Table::instance();
  auto state = table.state.lock();
  state->is_ending = true;
  table.changed.notify_all();
  state.wait_for(table.changed, attempt * 10, [&] { return state->threads == 0; });
}

std::optional<RTC::ReturnCode_t> take_leave(RTC::PortService_ptr port, const char* connector_id, CORBA::ULong left) {
  std::string address;
  try {
    address = process_address(port);
    if (leave_message(address, port, connector_id)) return std::nullopt;
    limit_calls(port, std::min(port_call_timeout(), patience) * static_cast<int>(left));
    return port->notify_disconnect(connector_id);
  } catch (const CORBA::SystemException& e) {
    if (is_time_out(e)) tell_later(address, port, connector_id, true, port_call_timeout());  // or it is dead, and there is nobody to tell
  } catch (const CORBA::Exception&) {
    // Of another make, and odd.
  }
  return std::nullopt;
}

void take_leave_when_awake(RTC::PortService_ptr port, const char* connector_id) {
  try {
    tell_later(process_address(port), port, connector_id, false, longest_hang);
  } catch (const CORBA::SystemException&) {
    // Nothing to reach it by.
  }
}

}  // namespace corba
