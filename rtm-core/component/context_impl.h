// The state of an execution context of the facade: private to its .cpp files here and behind the facade. Locked for data only.
#pragma once

#include <rtm/ExecutionContextBase.h>

#include <deque>
#include <memory>
#include <optional>

#include "base/clock.h"
#include "base/guarded.h"
#include "corba/members/remote_participant.h"
#include "core/execution_context.h"

namespace RTC {

struct ExecutionContextBase::Impl {
  // What is known about somebody who takes part. A copy: it keeps nobody from leaving.
  struct Member {
    RTC::LightweightRTObject_var reference{};
    RTObject_impl* local = nullptr;  // for comparing only
    rt::MemberId id = 0;
    ExecutionContextHandle_t handle = 0;
    bool owner = false;
    std::shared_ptr<RTC_impl::RTObjectStateMachine> machine{};
  };
  // The one list of members is that of `context`; each of its participants is one of these.
  class Entry final : public rt::Participant {
   public:
    // `callee`: the component, here or in another process.
    Entry(ExecutionContextBase& context, Member member, std::shared_ptr<rt::Participant> callee)
        : context_(context), member_(std::move(member)), callee_(std::move(callee)) {}
    const Member& member() const { return member_; }

    void joined(rt::MemberId id) override;
    std::string name() const override { return callee_->name(); }
    std::string place() const override { return callee_->place(); }
    rt::ReturnCode call(rt::Action action) override { return callee_->call(action); }

   private:
    ExecutionContextBase& context_;
    Member member_;
    const std::shared_ptr<rt::Participant> callee_;
  };
  // Contexts of authors may still be working with the machine of somebody who has just left: so many are kept.
  static constexpr std::size_t max_retired = 64;
  using Retired = std::deque<std::shared_ptr<RTC_impl::RTObjectStateMachine>>;
  static constexpr std::chrono::milliseconds default_timeout{500};
  // Of a context with a clock of its own; see component/context_clock.h.
  struct Clocks {
    std::shared_ptr<const base::Clock> of_ticks, of_others;
  };
  struct Data {
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
    bool is_changing = false;                     // somebody starts or stops it
    std::shared_ptr<corba::MemberWatch> watch{};  // from the first member of another process on
  };

  explicit Impl(const std::string& name) : context(name) {}

  std::optional<Member> find(RTC::LightweightRTObject_ptr component) const;
  std::vector<Member> members() const;
  // All participants of `context` are entries.
  static const Member& member_of(const rt::Participant& participant) { return static_cast<const Entry&>(participant).member(); }
  // The calling thread runs a callback that must return before the context can call the member: it cannot wait for that.
  bool is_waited_for_by_callback(const Member& member) const;
  // False when somebody else has been faster. `is_left_alone`: no callback of it runs any more.
  bool remove(const Member& member, std::chrono::nanoseconds timeout, bool* is_left_alone = nullptr);
  std::shared_ptr<corba::MemberWatch> member_watch();
  // Tells the component that it has left.
  static void detach(const Member& member, Logger& rtclog);
  // The current clock of components while they are called.
  const base::Clock& clock() const;

  const std::shared_ptr<corba::MemberTimeout> member_timeout = std::make_shared<corba::MemberTimeout>();
  rt::ExecutionContext context;
  base::Guarded<Data, base::Rank::component> shared;
  Clocks clocks{};                // written before anybody else knows the context
  RTC::RTCList component_list{};  // what getComponentList() has answered
};

}  // namespace RTC
