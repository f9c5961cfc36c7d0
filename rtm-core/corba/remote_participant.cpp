#include "corba/remote_participant.h"

#include <algorithm>
#include <utility>

#include "base/log.h"
#include "corba/action_call.h"
#include "corba/orb.h"
#include "corba/return_code.h"
#include "rtm/idl/SDOPackageStub.h"

namespace corba {

namespace {

std::string name_of(RTC::LightweightRTObject_ptr component) {
  try {
    SDOPackage::SDO_var sdo = SDOPackage::SDO::_narrow(component);
    if (!CORBA::is_nil(sdo)) {
      set_call_timeout(sdo, RemoteParticipant::call_timeout);
      CORBA::String_var id = sdo->get_sdo_id();
      return id.in();
    }
  } catch (const CORBA::Exception&) {
    return "a component that does not tell its name";
  }
  return "a component without a name";
}

}  // namespace

CORBA::Object_ptr impatient_copy(CORBA::Object_ptr object, std::chrono::milliseconds timeout) {
  if (CORBA::is_nil(object)) return CORBA::Object::_nil();
  int argc = 0;
  CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
  CORBA::String_var text = orb->object_to_string(object);
  CORBA::Object_var own = orb->string_to_object(text);
  set_call_timeout(own, timeout);
  return own._retn();
}

RTC::LightweightRTObject_ptr RemoteParticipant::impatient(RTC::LightweightRTObject_ptr component) {
  CORBA::Object_var own = impatient_copy(component, call_timeout);
  return RTC::LightweightRTObject::_unchecked_narrow(own);
}

void MemberPatience::set(std::chrono::nanoseconds limit) {
  const auto count = std::chrono::duration_cast<std::chrono::milliseconds>(limit).count();
  limit_ms_.store(std::clamp<std::int64_t>(count, 1, 3'600'000), std::memory_order_relaxed);
}

RemoteParticipant::RemoteParticipant(RTC::LightweightRTObject_ptr component, RTC::ExecutionContextHandle_t handle,
                                     std::shared_ptr<const MemberPatience> patience)
    : component_(impatient(component)), handle_(handle), name_(name_of(component_)), patience_(std::move(patience)) {
  try {
    data_flow_ = RTC::DataFlowComponentAction::_narrow(component_);
  } catch (const CORBA::Exception&) {
    state_.lock()->is_lost = true;
  }
}

bool RemoteParticipant::prepare(rt::Action action) {
  const auto limit = patience_->limit();
  bool is_new = false;
  {
    auto state = state_.lock();
    if (state->is_lost && action != rt::Action::reset && action != rt::Action::startup) return false;
    is_new = std::exchange(state->limit, limit) != limit;
  }
  if (is_new) {
    set_call_timeout(component_, limit);
    if (!CORBA::is_nil(data_flow_)) set_call_timeout(data_flow_, limit);
  }
  return true;
}

rt::ReturnCode RemoteParticipant::call(rt::Action action) {
  if (!prepare(action)) return rt::ReturnCode::error;
  try {
    const auto code = from_wire(call_action(action, *component_, CORBA::is_nil(data_flow_) ? nullptr : data_flow_.in(), handle_));
    state_.lock()->is_lost = false;
    return code;
  } catch (const CORBA::Exception& exception) {
    state_.lock()->is_lost = true;
    base::log(base::Level::error, name_, "component of another process does not answer {}: {}", to_text(action), to_text(exception));
  }
  return rt::ReturnCode::error;
}

}  // namespace corba
