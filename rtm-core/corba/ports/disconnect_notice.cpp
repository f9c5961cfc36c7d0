#include "corba/ports/disconnect_notice.h"

#include <omnithread.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "base/guarded.h"
#include "base/log.h"
#include "base/text.h"
#include "corba/orb/call_timeout.h"
#include "corba/ports/peer_watch.h"

namespace corba {
namespace {

using Clock = std::chrono::steady_clock;

// Leaving takes a port no time.
constexpr auto disconnect_notice_limit = std::chrono::milliseconds(1000);
// Of one of the calls by which a process that hangs is tried again; the end of the ORB waits for the last of them.
constexpr auto attempt = std::chrono::milliseconds(300);
// Between two of them, the longer the process has hung.
constexpr auto longest_pause = std::chrono::milliseconds(1000);
constexpr auto longest_hang = std::chrono::minutes(10);
constexpr auto longest_absence = std::chrono::hours(24);
// Each is a thread. Who gives a thousand addresses to ports and answers at none of them is told nothing at further ones.
constexpr std::size_t max_processes = 1024;

std::chrono::milliseconds timeout_of_one() { return std::min(port_call_timeout(), disconnect_notice_limit); }

struct Message {
  RTC::PortService_var port;
  std::string connector_id;
  Clock::time_point deadline;
  std::shared_ptr<const RTC::ConnectorProfile> connects{};  // when it is told; null: nothing
};

enum class Answer { reached, silent, gone };

struct Process {
  std::deque<Message> untold;
  bool hangs = false;  // a call has taken its time-out
};

struct DisconnectNoticeState {
  std::map<std::string, Process> processes;  // by address; each has a thread that tries
  int threads = 0;
  bool is_ending = true;  // also before the beginning
};

// The processes are for all ports, so this is a global. Never destroyed: ports may die after it otherwise.
struct DisconnectNotices {
  base::Guarded<DisconnectNoticeState, base::Rank::peers> state;
  std::condition_variable changed;
  static DisconnectNotices& instance() {
    static DisconnectNotices& table = *new DisconnectNotices;
    return table;
  }
};

// False if the process is not known to hang.
bool leave_message(const std::string& address, RTC::PortService_ptr port, const char* connector_id) {
  auto state = DisconnectNotices::instance().state.lock();
  const auto found = state->processes.find(address);
  if (found == state->processes.end() || !found->second.hangs) return false;
  found->second.untold.push_back({RTC::PortService::_duplicate(port), connector_id, Clock::now() + port_call_timeout(), nullptr});
  return true;
}

// It is asked something harmless until it answers: what waits in its sockets when it wakes must not end a connection that was made anew
// under the same id.
Answer deliver(const Message& message, bool is_awake) {
  try {
    limit_calls(message.port, std::min(port_call_timeout(), attempt));
    if (!is_awake && message.port->_non_existent()) return Answer::gone;
    message.port->notify_disconnect(message.connector_id.c_str());
  } catch (const CORBA::OBJECT_NOT_EXIST&) {
    return Answer::gone;
  } catch (const CORBA::SystemException& e) {
    if (is_time_out(e)) return Answer::silent;
    // On another host the way there may be what is broken.
    const bool may_return = message.connects && !is_on_loopback(process_address(message.port));
    return may_return ? Answer::silent : Answer::gone;
  } catch (const CORBA::Exception&) {
    // Of another make, and odd: it has got the message.
  }
  return Answer::reached;
}

bool have_all(const RTC::ConnectorProfile& profile) {
  for (CORBA::ULong i = 0; i < profile.ports.length(); ++i) {
    limit_calls(profile.ports[i], port_call_timeout());
    const RTC::ConnectorProfile_var own = profile.ports[i]->get_connector_profile(profile.connector_id);
    if (std::string_view(own->connector_id) != profile.connector_id.in()) return false;
  }
  return true;
}

// False: it did not work, and may work later.
bool connect_again(const RTC::ConnectorProfile& profile) {
  const std::string name = profile.name.in();
  RTC::ConnectorProfile again = profile;
  try {
    limit_calls(again.ports[0], port_call_timeout() * static_cast<int>(again.ports.length()));
    const RTC::ReturnCode_t code = again.ports[0]->connect(again);
    if (code == RTC::RTC_OK) base::log(base::Level::info, "port", "connection {} is back", base::in_quotes(name));
    // PRECONDITION_NOT_MET: somebody was faster, or a port that has just woken is still ending the connection that was.
    return code == RTC::RTC_OK || (code == RTC::PRECONDITION_NOT_MET && have_all(again));
  } catch (const CORBA::OBJECT_NOT_EXIST&) {
    base::log(base::Level::info, "port", "connection {} is not restored: a port was deleted", base::in_quotes(name));
    return true;
  } catch (const CORBA::Exception&) {
    return false;
  }
}

// Until each message is delivered or past its deadline.
void tell_late(const std::string& address) {
  const omni_thread::ensure_self known_to_the_orb;  // time-outs need it
  auto& table = DisconnectNotices::instance();
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
    const Answer answer = deliver(message, is_awake);
    is_awake = answer != Answer::silent;
    const bool is_done = is_awake && (answer == Answer::gone || !message.connects || connect_again(*message.connects));
    auto state = table.state.lock();
    Process& process = state->processes[address];
    process.hangs = !is_awake;
    process.untold.pop_front();
    if (is_done || Clock::now() >= message.deadline) continue;
    // One that could not be connected lets the others through.
    if (is_awake)
      process.untold.push_back(std::move(message));
    else
      process.untold.push_front(std::move(message));
    state.wait_for(table.changed, std::min<Clock::duration>((Clock::now() - start) / 4, longest_pause), [&] { return state->is_ending; });
  }
}

// The messages for that process are dropped.
void give_up(const std::string& address, const char* reason) {
  std::deque<Message> dropped;  // let go without the lock
  {
    auto state = DisconnectNotices::instance().state.lock();
    const auto found = state->processes.find(address);
    if (found != state->processes.end()) {
      dropped = std::move(found->second.untold);
      state->processes.erase(found);
    }
    --state->threads;
  }
  DisconnectNotices::instance().changed.notify_all();
  base::log(base::Level::warn, "port", "cannot notify the process at {} that its connections were closed: {}", address, reason);
}

// Does not throw for want of a thread.
void tell_later(const std::string& address, RTC::PortService_ptr port, const char* connector_id, bool hangs, Clock::duration lasts,
                std::shared_ptr<const RTC::ConnectorProfile> connects = nullptr) {
  {
    auto state = DisconnectNotices::instance().state.lock();
    if (state->is_ending) return;
    const bool has_thread = state->processes.contains(address);
    if (!has_thread && state->processes.size() >= max_processes) return;
    Process& process = state->processes[address];
    process.hangs = process.hangs || hangs;
    process.untold.push_back({RTC::PortService::_duplicate(port), connector_id, Clock::now() + lasts, std::move(connects)});
    if (has_thread) return;
    ++state->threads;
  }
  try {
    std::thread([address] {
      tell_late(address);
      --DisconnectNotices::instance().state.lock()->threads;
      DisconnectNotices::instance().changed.notify_all();
    }).detach();
  } catch (const std::system_error& error) {
    give_up(address, error.what());
  }
}

}  // namespace

void start_disconnect_notices() { DisconnectNotices::instance().state.lock()->is_ending = false; }

void stop_disconnect_notices() {
  auto& table = DisconnectNotices::instance();
  auto state = table.state.lock();
  state->is_ending = true;
  table.changed.notify_all();
  state.wait_for(table.changed, attempt * 10, [&] { return state->threads == 0; });
}

ChainDeadline disconnect_deadline(bool has_waited) {
  return ChainDeadline(has_waited ? std::chrono::milliseconds::zero() : 2 * timeout_of_one());
}

std::optional<RTC::ReturnCode_t> notify_disconnect_of(RTC::PortService_ptr port, const char* connector_id, CORBA::ULong left,
                                                      const ChainDeadline& deadline) {
  std::string address;
  try {
    address = process_address(port);
    if (leave_message(address, port, connector_id)) return std::nullopt;
    if (deadline.is_over()) {
      tell_later(address, port, connector_id, false, port_call_timeout());
      return std::nullopt;
    }
    limit_calls(port, std::min(deadline.left(), timeout_of_one() * static_cast<int>(std::min<CORBA::ULong>(left, 3))));
    return port->notify_disconnect(connector_id);
  } catch (const CORBA::SystemException& e) {
    if (is_time_out(e)) tell_later(address, port, connector_id, true, port_call_timeout());  // or it is dead, and there is nobody to tell
  } catch (const CORBA::Exception&) {
    // Of another make, and odd.
  }
  return std::nullopt;
}

void reconnect_later(RTC::PortService_ptr port, const RTC::ConnectorProfile& profile) {
  try {
    tell_later(process_address(port), port, profile.connector_id, false, longest_absence,
               std::make_shared<const RTC::ConnectorProfile>(profile));
  } catch (const CORBA::SystemException&) {
    // Nothing to reach it by.
  }
}

void notify_disconnect_later(RTC::PortService_ptr port, const char* connector_id) {
  try {
    tell_later(process_address(port), port, connector_id, false, longest_hang);
  } catch (const CORBA::SystemException&) {
    // Nothing to reach it by.
  }
}

}  // namespace corba
