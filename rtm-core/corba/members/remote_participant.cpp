#include "corba/members/remote_participant.h"

#include <algorithm>
#include <utility>

#include "base/clock.h"
#include "base/log.h"
#include "base/text.h"
#include "corba/members/action_call.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/return_code.h"
#include "corba/ports/peer_watch.h"
#include "rtm/idl/SDOPackageStub.h"

namespace corba {

namespace {

std::string name_of(RTC::LightweightRTObject_ptr component, std::chrono::milliseconds timeout) {
  try {
    SDOPackage::SDO_var sdo = SDOPackage::SDO::_narrow(component);
    if (!CORBA::is_nil(sdo)) {
      set_call_timeout(sdo, timeout);
      CORBA::String_var id = sdo->get_sdo_id();
      return id.in();
    }
  } catch (const CORBA::Exception&) {
    return "a component that does not report its name";
  }
  return "a component without a name";
}

// " at 0.2 s", where that says more than the time of the log line.
std::string simulated_time_text() {
  const base::Clock& clock = base::current_clock();
  return clock.is_simulated() ? " at " + base::format_number(base::to_seconds(clock.now())) + " s" : "";
}

}  // namespace

CORBA::Object_ptr copy_with_timeout(CORBA::Object_ptr object, std::chrono::milliseconds timeout) {
  if (CORBA::is_nil(object)) return CORBA::Object::_nil();
  int argc = 0;
  CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr);
  CORBA::String_var text = orb->object_to_string(object);
  CORBA::Object_var own = orb->string_to_object(text);
  set_call_timeout(own, timeout);
  return own._retn();
}

RTC::LightweightRTObject_ptr RemoteParticipant::with_timeout(RTC::LightweightRTObject_ptr component, std::chrono::milliseconds timeout) {
  return copy_as<RTC::LightweightRTObject>(component, timeout);
}

void MemberTimeout::set(std::chrono::nanoseconds limit) {
  const auto count = std::chrono::duration_cast<std::chrono::milliseconds>(limit).count();
  constexpr auto without_end = std::chrono::milliseconds(longest).count();
  limit_ms_.store(limit > std::chrono::hours(24) ? without_end : std::max<std::int64_t>(count, 1), std::memory_order_relaxed);
}

RemoteParticipant::RemoteParticipant(RTC::LightweightRTObject_ptr component, RTC::ExecutionContextHandle_t handle,
                                     std::shared_ptr<const MemberTimeout> timeout, std::shared_ptr<MemberWatch> watch)
    : component_(with_timeout(component, timeout->is_without_end() ? long_call_timeout : call_timeout)),
      data_flow_(RTC::DataFlowComponentAction::_narrow(component_)),
      handle_(handle),
      name_(name_of(component_, timeout->is_without_end() ? long_call_timeout : call_timeout)),
      place_(process_address(component_)),
      timeout_(std::move(timeout)),
      watch_(std::move(watch)) {}

bool RemoteParticipant::prepare(rt::Action action) {
  const auto limit = timeout_->limit();
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
  const MemberWatch::Call watched(*watch_, name_, rt::callback_of(action));
  try {
    const auto code = from_wire(call_action(action, *component_, CORBA::is_nil(data_flow_) ? nullptr : data_flow_.in(), handle_));
    state_.lock()->is_lost = false;
    return code;
  } catch (const CORBA::Exception& exception) {
    tell(action, exception);
  }
  return rt::ReturnCode::error;
}

void RemoteParticipant::tell(rt::Action action, const CORBA::Exception& exception) {
  const bool is_late = is_time_out(exception);
  const bool is_gone =
      !is_late && (dynamic_cast<const CORBA::COMM_FAILURE*>(&exception) || dynamic_cast<const CORBA::TRANSIENT*>(&exception) ||
                   dynamic_cast<const CORBA::OBJECT_NOT_EXIST*>(&exception));
  const auto callback = rt::callback_of(action);
  if (is_late || is_gone) state_.lock()->is_lost = true;
  if (is_late) {
    base::log(base::Level::error, name_, "component of another process has not answered {} within {} s; it is left alone until it is reset",
              callback, base::format_number(static_cast<double>(timeout_->limit().count()) / 1000));
  } else if (is_gone) {
    base::log(base::Level::error, name_, "{} in {}{} ({}); it is left alone until it is reset", gone_mark.substr(2), callback,
              simulated_time_text(), to_text(exception));
  } else {
    base::log(base::Level::error, name_, "{}{}{}: {}", threw_mark.substr(2), callback, simulated_time_text(), to_text(exception));
  }
}

}  // namespace corba
