// The state of a component: private to this folder and to RTObject.cpp. Locked for data only.
//
// A component whose callback does not return within exec_cxt.callback_timeout (5 s) is left in memory when it is taken away, named in the
// log, and freed when the callback returns after all: a thread cannot be taken out of user code.
#pragma once

#include <rtm/RTObject.h>
#include <rtm/SdoConfiguration.h>
#include <rtm/SdoOrganization.h>
#include <rtm/SdoServiceAdmin.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "base/clock.h"
#include "base/guarded.h"
#include "component/execute_fault.h"
#include "component/outside_calls.h"
#include "core/callback_gate.h"
#include "core/log_rate_limiter.h"

namespace RTC {

struct RTObject_impl::Port {
  std::string name;  // without the instance name
  PortService_var reference;
  PortBase* local = nullptr;  // the same port when it is in this process and added as such
  InPortBase* in = nullptr;
  OutPortBase* out = nullptr;
};

// The time for the calls by which a component that ends leaves its peers: what is left until the deadline; after it a moment for each, so
// that one peer that hangs does not keep the others from hearing of it, and two seconds for all.
class LastCalls {
 public:
  explicit LastCalls(std::chrono::steady_clock::time_point deadline)
      : deadline_(deadline), end_(std::max(deadline, std::chrono::steady_clock::now()) + std::chrono::seconds(2)) {}
  bool are_over() const { return std::chrono::steady_clock::now() >= end_; }
  std::chrono::milliseconds timeout() const {
    constexpr std::chrono::milliseconds shortest{200};
    return std::max(std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - std::chrono::steady_clock::now()), shortest);
  }

 private:
  std::chrono::steady_clock::time_point deadline_, end_;
};

// Foreign contexts a component takes part in, and organizations it is a member of: whoever ends it asks each.
inline constexpr std::size_t max_memberships = 64;

struct RTObject_impl::Impl {
  enum class Phase { created, initializing, alive, exiting, finalizing, finalized };

  struct Data {
    Phase phase = Phase::created;
    RTObject_var reference{};
    std::vector<ExecutionContext_var> own{};               // by handle
    std::vector<ExecutionContext_var> foreign{};           // by handle - foreign_offset; nil where one has left
    std::map<ExecutionContextHandle_t, bool> elsewhere{};  // those of `foreign` in other processes; whether the component is active there
    bool was_initialized_from_outside = false;
    std::vector<ExecutionContextBase*> contexts{};
    std::chrono::nanoseconds callback_timeout = ExecutionContextBase::default_callback_timeout;
    std::vector<Port> ports{};
    std::set<UniqueId> active_in{};  // contexts in which the component is active: ports work while there is one
    std::vector<SDOPackage::Organization_var> organizations{};
    std::size_t next_to_look_at = 0;                                    // of both, by leaveTheDead
    std::vector<SDOPackage::Organization_impl*> owned_organizations{};  // servants, one reference each
    SDOPackage::Configuration_impl* configuration = nullptr;            // a servant; one reference, none when it is finalized
    SDOPackage::Configuration_var configuration_reference{};            // asking the servant again would activate it again
    SDOPackage::DeviceProfile device{};
    std::map<int, StatusListener> status_listeners{};
    int next_status_listener = 1;
    bool reads_all = false, reads_on = false, writes_all = false, writes_on = false;
  };

  explicit Impl(RTObject_impl& component) : services(component) {}

  base::Guarded<Data, base::Rank::component> shared;
  // Held while the runtime reads or writes m_properties and profile_, which are the author's and no members of ours.
  base::Turn<base::Rank::profile> properties_turn;
  SdoServiceAdmin services;
  // Of the context that the component joined last; for time stamps.
  const std::shared_ptr<base::FollowingClock> clock = std::make_shared<base::FollowingClock>();
  std::unique_ptr<rt::ExecuteFaults> faults;  // null: none are asked for
  rt::CallbackGate gate;                      // all callbacks pass it
  std::string last_thrown{};                  // exception of the last callback; empty if it returned. Only for the thread inside the gate
  rt::LogRateLimiter rejection_limiter;
  base::Guarded<std::thread, base::Rank::tasks> exiter;  // runs exit() when a callback asked for it
};

inline constexpr ExecutionContextHandle_t foreign_offset = 1000;

// This thread runs a callback of some component, or of that one (null: of none).
bool isInsideCallback();
bool isInsideCallbackOf(const RTObject_impl* component);

// Takes a servant out of its object adapter; calls in progress end first, then its reference is given back there.
void deactivateServant(PortableServer::ServantBase& servant, CORBA::Object_ptr reference);

}  // namespace RTC
