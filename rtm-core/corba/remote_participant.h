// A component of another process inside one of our execution contexts. Any thread. When the component does not answer it counts as an error
// and is left alone until it is reset, so that nobody else waits for it again and again.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "base/guarded.h"
#include "base/result.h"
#include "core/execution_context.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

// A reference of its own to the same object, whose calls end after `timeout` and throw CORBA system exceptions; nil for nil.
CORBA::Object_ptr impatient_copy(CORBA::Object_ptr object, std::chrono::milliseconds timeout);

// How long members of other processes may take for one callback. Any thread, at any time.
class MemberPatience {
 public:
  static constexpr std::chrono::milliseconds usual{1000};
  // At least 1 ms.
  void set(std::chrono::nanoseconds limit);
  std::chrono::milliseconds limit() const { return std::chrono::milliseconds(limit_ms_.load(std::memory_order_relaxed)); }

 private:
  std::atomic<std::int64_t> limit_ms_{usual.count()};  // relaxed everywhere: a setting, it orders nothing
};

class RemoteParticipant final : public rt::Participant {
 public:
  // What else is asked than callbacks.
  static constexpr std::chrono::milliseconds call_timeout = MemberPatience::usual;

  // An impatient_copy with call_timeout.
  static RTC::LightweightRTObject_ptr impatient(RTC::LightweightRTObject_ptr component);

  // Asks whether it has on_execute and the like.
  RemoteParticipant(RTC::LightweightRTObject_ptr component, RTC::ExecutionContextHandle_t handle,
                    std::shared_ptr<const MemberPatience> patience);

  std::string name() const override { return name_; }
  rt::ReturnCode call(rt::Action action) override;

 private:
  struct State {
    bool is_lost = false;
    std::chrono::milliseconds limit{0};  // of calls, as last set
  };
  // False when it is left alone.
  bool prepare(rt::Action action);

  RTC::LightweightRTObject_var component_;      // nobody else's reference
  RTC::DataFlowComponentAction_var data_flow_;  // nil when it has no such operations
  const RTC::ExecutionContextHandle_t handle_;
  const std::string name_;
  const std::shared_ptr<const MemberPatience> patience_;
  base::Guarded<State, base::Rank::connector> state_;
};

}  // namespace corba
