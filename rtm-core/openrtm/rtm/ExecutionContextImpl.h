// What an execution context of the facade keeps: private to the ExecutionContext*.cpp files. Locked for data only.
#pragma once

#include <rtm/ExecutionContextBase.h>

#include <optional>

#include "base/guarded.h"
#include "core/execution_context.h"

namespace RTC {

struct ExecutionContextBase::Impl {
  struct Member {
    RTC::LightweightRTObject_var reference{};
    RTObject_impl* local = nullptr;  // for comparing only
    rt::MemberId id = 0;
    ExecutionContextHandle_t handle = 0;
    bool owner = false;
  };
  // Whether callers wait for a transition, and how long.
  struct Patience {
    bool wait = true;
    std::chrono::nanoseconds timeout = std::chrono::milliseconds(500);
  };
  struct Data {
    std::vector<Member> members{};
    std::vector<RTC::LightweightRTObject_var> joining{};  // asked to attach, no members yet
    RTC::ExecutionContextService_var reference{};
    RTC::RTObject_var owner{};
    RTC::ExecutionKind kind = RTC::PERIODIC;
    coil::Properties properties{};
    Patience activation{}, deactivation{}, reset{};
    std::chrono::nanoseconds callback_timeout = default_callback_timeout;
    std::optional<std::chrono::steady_clock::time_point> stop_by{};
    bool is_changing = false;  // somebody starts or stops it
  };

  explicit Impl(const std::string& name) : context(name) {}

  std::optional<Member> find(RTC::LightweightRTObject_ptr component) const;
  std::vector<Member> snapshot() const { return shared.lock()->members; }
  // Tells the component that it has left.
  static void detach(const Member& member, Logger& rtclog);

  rt::ExecutionContext context;
  base::Guarded<Data, base::Rank::component> shared;
};

}  // namespace RTC
