// Calls of other processes to a component that are accepted: the operations of RTC::ComponentAction, RTC::DataFlowComponentAction and
// RTC::LightweightRTObject that run code of its author or change its life. The ORB calls them on its own threads. Any thread.
//
// Rights, for callers of other accounts and machines (corba/orb/principal.h): with manager.remote_rights `read` none of these operations
// does anything; the answer is RTC_ERROR. The other operations of a component, its contexts, ports and configuration are open to every
// caller that the process accepts.
//
// States, for all callers from outside. The answer is PRECONDITION_NOT_MET for everything that this table does not have:
//   initialize        created, without a manager: a manager initializes its components itself
//   finalize          never; exit ends a component
//   exit              alive
//   on_initialize     created, without a manager, once
//   on_finalize       never; the runtime calls it when the component ends
//   on_startup, ...   with the handle that attach_context has given to an execution context of another process, until detach_context.
//                     Handles of contexts of this process are rejected: these contexts call the component directly.
//     on_activated      while that context has the component not active
//     on_execute, on_state_update, on_deactivated   while that context has it active
//     on_error          while that context has it not active
//     on_startup, on_shutdown, on_rate_changed, on_aborting, on_reset   at any time
// A handle is not bound to a caller: a tool may attach a context that another process has, and a context calls over several connections.
// It says which context calls; who may call is the matter of the rights above.
// Active is from on_activated to on_deactivated, on_aborting or on_reset. OpenRTM-aist and this runtime call on_deactivated, then
// on_aborting when a callback fails; a context that gave up one of the calls can reset the component.
//
// Turns: core/callback_gate.h. Failures:
//   the component's callback runs    the caller waits `remote_timeout` for it, then PRECONDITION_NOT_MET
//   the caller's time is simulated   it waits `simulated_timeout`: the answer would be part of a run
//   64 callers wait already          PRECONDITION_NOT_MET
//   the component ends               PRECONDITION_NOT_MET, or OBJECT_NOT_EXIST
//   a callback calls another process, which calls back into the component by a thread of the ORB    as "the component's callback runs": the
//                                    call that comes back fails in time, and the callback goes on. CORBA passes on no chain of calls, so
//                                    such a call cannot be told from one that comes by chance; to let it in is to let callbacks overlap
// A context of this process waits as long as the component's callbacks may take when it ends (exec_cxt.callback_timeout, at least a second;
// in lock step `simulated_timeout`). Then its call fails like a callback that returns RTC_ERROR.
// A component that was compiled with headers before these rules passes the gate too, but all its calls count as calls of this process.
// The log has one line per second and component about rejected calls, with the number of those left out.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "core/lifecycle.h"

namespace RTC {

class RTObject_impl;

inline constexpr std::chrono::milliseconds remote_timeout{500};
inline constexpr std::chrono::seconds local_timeout{1};  // at least
inline constexpr std::chrono::minutes simulated_timeout{1};

// The operations above.
bool is_watched_operation(std::string_view name);

// Around an operation that the ORB carries out for another process. The component's function asks with is_mine() whether it is the one that
// was called from there; what it calls in turn gets false.
class OutsideCall {
 public:
  explicit OutsideCall(const RTObject_impl& component);
  ~OutsideCall();
  OutsideCall(const OutsideCall&) = delete;
  OutsideCall& operator=(const OutsideCall&) = delete;
  static bool is_mine(const RTObject_impl& component);

 private:
  const RTObject_impl* const before_;
};

// Why a context of another process may not call that now; nothing if it may. `active`: whether it has the component active, no value for a
// handle that no such context has.
std::optional<std::string> why_not(rt::Action action, std::optional<bool> active);
// Whether the context has the component active after that.
bool is_active_after(rt::Action action, bool active);

}  // namespace RTC
