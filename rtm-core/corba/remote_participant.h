// A component of another process inside one of our execution contexts. Any thread. When the component does not answer it counts as an error
// and is left alone until it is reset, so that nobody else waits for it again and again.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "base/guarded.h"
#include "base/result.h"
#include "core/execution_context.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

// A reference of its own to the same object, whose calls end after `timeout` and throw CORBA system exceptions; nil for nil.
CORBA::Object_ptr impatient_copy(CORBA::Object_ptr object, std::chrono::milliseconds timeout);

class RemoteParticipant final : public rt::Participant {
 public:
  static constexpr std::chrono::milliseconds call_timeout{1000};

  // An impatient_copy with call_timeout.
  static RTC::LightweightRTObject_ptr impatient(RTC::LightweightRTObject_ptr component);

  // `component` is an impatient reference. Asks whether it has on_execute and the like.
  RemoteParticipant(RTC::LightweightRTObject_ptr component, RTC::ExecutionContextHandle_t handle);

  std::string name() const override { return name_; }
  rt::ReturnCode call(rt::Action action) override;

 private:
  RTC::LightweightRTObject_var component_;
  RTC::DataFlowComponentAction_var data_flow_;  // nil when it has no such operations
  const RTC::ExecutionContextHandle_t handle_;
  const std::string name_;
  base::Guarded<bool, base::Rank::connector> lost_{false};
};

}  // namespace corba
