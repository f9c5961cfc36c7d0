// The operation of RTC::ComponentAction and RTC::DataFlowComponentAction behind each rt::Action. Throws what the operation throws.
#pragma once

#include "core/lifecycle.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

// `data_flow` may be null: then what only data-flow components have is answered RTC_OK. Both may be the same object.
template <class Component, class DataFlow>
RTC::ReturnCode_t call_action(rt::Action action, Component& component, DataFlow* data_flow, RTC::ExecutionContextHandle_t handle) {
  switch (action) {
    case rt::Action::startup:
      return component.on_startup(handle);
    case rt::Action::shutdown:
      return component.on_shutdown(handle);
    case rt::Action::activated:
      return component.on_activated(handle);
    case rt::Action::deactivated:
      return component.on_deactivated(handle);
    case rt::Action::aborting:
      return component.on_aborting(handle);
    case rt::Action::error:
      return component.on_error(handle);
    case rt::Action::reset:
      return component.on_reset(handle);
    case rt::Action::execute:
      return data_flow ? data_flow->on_execute(handle) : RTC::RTC_OK;
    case rt::Action::state_update:
      return data_flow ? data_flow->on_state_update(handle) : RTC::RTC_OK;
    case rt::Action::rate_changed:
      return data_flow ? data_flow->on_rate_changed(handle) : RTC::RTC_OK;
  }
  return RTC::RTC_ERROR;
}

}  // namespace corba
