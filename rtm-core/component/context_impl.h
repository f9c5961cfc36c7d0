// What an execution context of the facade keeps: private to its .cpp files here and behind the facade. Locked for data only.
#pragma once

#include <rtm/ExecutionContextBase.h>

#include <deque>
#include <memory>
#include <optional>

#include "base/guarded.h"
#include "corba/remote_participant.h"
#include "core/execution_context.h"

namespace RTC {

struct ExecutionContextBase::Impl {
  struct Member {
    RTC::LightweightRTObject_var reference{};
    RTObject_impl* local = nullptr;  // for comparing only
    rt::MemberId id = 0;
    ExecutionContextHandle_t handle = 0;
    bool owner = false;
    std::shared_ptr<RTC_impl::RTObjectStateMachine> machine{};
  };
  // Contexts of authors may still be working with the machine of somebody who has just left: so many are kept.
  static constexpr std::size_t max_retired = 64;
  using Retired = std::deque<std::shared_ptr<RTC_impl::RTObjectStateMachine>>;
  static constexpr std::chrono::milliseconds default_timeout{500};
  struct Data {
    std::vector<Member> members{};
    std::vector<RTC::LightweightRTObject_var> joining{};  // asked to attach, no members yet
    RTC::ExecutionContextService_var reference{};
    RTC::RTObject_var owner{};
    RTC::ExecutionKind kind = RTC::PERIODIC;
    coil::Properties properties{};
    Retired retired{};
    // How long callers wait for a transition.
    std::chrono::nanoseconds activation = default_timeout, deactivation = default_timeout, reset = default_timeout;
    std::chrono::nanoseconds callback_timeout = default_callback_timeout;
    std::optional<std::chrono::steady_clock::time_point> stop_by{};
    bool is_changing = false;  // somebody starts or stops it
  };

  explicit Impl(const std::string& name) : context(name) {}

  std::optional<Member> find(RTC::LightweightRTObject_ptr component) const;
  std::vector<Member> snapshot() const { return shared.lock()->members; }
  static void retire(Data& data, const Member& member);
  // Tells the component that it has left.
  static void detach(const Member& member, Logger& rtclog);

  const std::shared_ptr<corba::MemberPatience> patience = std::make_shared<corba::MemberPatience>();
  rt::ExecutionContext context;
  base::Guarded<Data, base::Rank::component> shared;
  RTC::RTCList component_list{};  // what getComponentList() has answered
};

}  // namespace RTC
