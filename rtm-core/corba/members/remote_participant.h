// A component of another process, of any maker, as a member of an execution context of this runtime. Any thread.
//
// Rights: it is called by the operations of RTC::ComponentAction and RTC::DataFlowComponentAction, with the handle that its attach_context
// has given; nothing else of it is touched. Its own contexts stay as they are.
//
// States, beside those of every member (core/lifecycle.h): it answers, or it is lost. Failures:
//   answers with another code than RTC_OK, or throws   an error, as of a component of this process
//   takes long                            named in the log after a second (corba/members/member_watch.h), and waited for
//   takes longer than the timeout         an error; it is lost
//   its process has exited, or the object was deleted   noticed at the call, or at once during one; named; an error; it is lost
// A lost member is not called, so that no tick waits for it again, until it is reset.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "base/guarded.h"
#include "base/result.h"
#include "corba/members/member_watch.h"
#include "corba/orb/orb.h"
#include "core/execution_context.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

// What the log says of a member whose process has ended, or whose object has gone; its name stands before it.
inline constexpr std::string_view gone_mark = ": component of another process was lost";

// What the log says of a member that threw; its name stands before it, "onExecute at 0.2 s: UNKNOWN" behind it.
inline constexpr std::string_view threw_mark = ": component of another process throws in ";

// A reference of its own to the same object, whose calls end after `timeout` and throw CORBA system exceptions; nil for nil.
CORBA::Object_ptr copy_with_timeout(CORBA::Object_ptr object, std::chrono::milliseconds timeout);
// The same as a reference to an `Interface`, unchecked. If the object's reference names another type, the ORB narrows to a further
// reference, which has no timeout of its own.
template <class Interface>
typename Interface::_ptr_type copy_as(CORBA::Object_ptr object, std::chrono::milliseconds timeout) {
  const CORBA::Object_var own = copy_with_timeout(object, timeout);
  typename Interface::_var_type narrowed = Interface::_unchecked_narrow(own);
  if (!CORBA::is_nil(narrowed)) set_call_timeout(narrowed, timeout);
  return narrowed._retn();
}

// How long members of other processes may take for one callback. Any thread, at any time.
class MemberTimeout {
 public:
  static constexpr std::chrono::milliseconds usual{1000};
  static constexpr std::chrono::hours longest{24 * 20};  // what omniORB's clock can hold, in milliseconds
  // At least 1 ms; more than a day is without end.
  void set(std::chrono::nanoseconds limit);
  bool is_without_end() const { return limit() == longest; }
  std::chrono::milliseconds limit() const { return std::chrono::milliseconds(limit_ms_.load(std::memory_order_relaxed)); }

 private:
  std::atomic<std::int64_t> limit_ms_{usual.count()};  // relaxed everywhere: a setting, it orders nothing
};

class RemoteParticipant final : public rt::Participant {
 public:
  // What else is asked than callbacks.
  static constexpr std::chrono::milliseconds call_timeout = MemberTimeout::usual;
  // The same where the other answer would be part of a repeatable run: when members are waited for without end.
  static constexpr std::chrono::minutes long_call_timeout{1};

  // A copy_with_timeout of the component.
  static RTC::LightweightRTObject_ptr with_timeout(RTC::LightweightRTObject_ptr component,
                                                   std::chrono::milliseconds timeout = call_timeout);

  // Asks whether it has on_execute and the like; throws CORBA::SystemException when it does not answer that.
  RemoteParticipant(RTC::LightweightRTObject_ptr component, RTC::ExecutionContextHandle_t handle,
                    std::shared_ptr<const MemberTimeout> timeout, std::shared_ptr<MemberWatch> watch);

  std::string name() const override { return name_; }
  std::string place() const override { return place_; }
  rt::ReturnCode call(rt::Action action) override;

 private:
  struct State {
    bool is_lost = false;
    std::chrono::milliseconds limit{0};  // of calls, as last set
  };
  // False when it is left alone.
  bool prepare(rt::Action action);
  void tell(rt::Action action, const CORBA::Exception& exception);

  RTC::LightweightRTObject_var component_;      // nobody else's reference
  RTC::DataFlowComponentAction_var data_flow_;  // nil when it has no such operations
  const RTC::ExecutionContextHandle_t handle_;
  const std::string name_;
  const std::string place_;  // its process
  const std::shared_ptr<const MemberTimeout> timeout_;
  const std::shared_ptr<MemberWatch> watch_;
  base::Guarded<State, base::Rank::connector> state_;
};

}  // namespace corba
