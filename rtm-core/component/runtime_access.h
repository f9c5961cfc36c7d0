// The one friend of the classes that authors use and derive from: what the runtime alone does with them. Not installed. Each function is
// the member of the same name, with its thread rule.
#pragma once

#include <rtm/ConnectorBase.h>
#include <rtm/ExecutionContextBase.h>
#include <rtm/InPortBase.h>
#include <rtm/OutPortBase.h>
#include <rtm/RTObject.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "component/context_impl.h"
#include "corba/ports/data_port.h"
#include "corba/transport/transport.h"

namespace RTC {

class RuntimeAccess {
 public:
  using Deadline = std::chrono::steady_clock::time_point;
  using RunningCallback = RTObject_impl::RunningCallback;
  using StatusListener = RTObject_impl::StatusListener;

  // A component: its contexts, its end, and what tools see and change.
  static ReturnCode_t create_contexts(RTObject_impl& component) { return component.createContexts(); }
  static std::vector<ExecutionContextBase*> own_contexts(const RTObject_impl& component) { return component.getOwnContexts(); }
  static std::vector<PortBase*> local_ports(const RTObject_impl& component) { return component.getLocalPorts(); }
  static ReturnCode_t exit_by(RTObject_impl& component, Deadline deadline) { return component.exitBy(deadline); }
  static void discard(RTObject_impl& component) { component.discard(); }
  static void ask_to_rest(RTObject_impl& component) { component.askToRest(); }
  static void come_to_rest(RTObject_impl& component, Deadline deadline) { component.comeToRest(deadline); }
  static void leave_the_dead(RTObject_impl& component) { component.leaveTheDead(); }
  static bool destroy_left_contexts() { return RTObject_impl::destroyLeftContexts(); }
  static std::vector<RunningCallback> running_callbacks(const RTObject_impl& component) { return component.runningCallbacks(); }
  static bool is_held_by_callback(const RTObject_impl& component) { return component.isHeldByCallback(); }
  static std::chrono::nanoseconds callback_timeout(const RTObject_impl& component) { return component.callbackTimeout(); }
  static int add_status_listener(RTObject_impl& component, StatusListener listener) {
    return component.addStatusListener(std::move(listener));
  }
  static void remove_status_listener(RTObject_impl& component, int number) { component.removeStatusListener(number); }
  static bool add_organization(RTObject_impl& component, SDOPackage::Organization_ptr organization) {
    return component.addOrganization(organization);
  }
  static bool remove_organization(RTObject_impl& component, const char* id) { return component.removeOrganization(id); }

  // A context: what core knows of it, its members, its end.
  static rt::ExecutionContext& context(ExecutionContextBase& context) { return context.impl_->context; }
  static ExecutionContextBase::Impl& impl(ExecutionContextBase& context) { return *context.impl_; }
  static const base::Clock& clock(const ExecutionContextBase& context) { return context.impl_->clock(); }
  static std::shared_ptr<const base::Clock> shared_clock(const ExecutionContextBase& context) { return context.impl_->clocks.of_others; }
  static void ask_to_rest(ExecutionContextBase& context, LightweightRTObject_ptr component) { context.askToRest(component); }
  static void calm(ExecutionContextBase& context, LightweightRTObject_ptr component, Deadline deadline) {
    context.calmComponent(component, deadline);
  }
  static void remove(ExecutionContextBase& context, LightweightRTObject_ptr component, Deadline deadline) {
    context.removeComponent(component, deadline);
  }
  static void unbind(ExecutionContextBase& context, RTObject_impl* component, std::chrono::nanoseconds timeout) {
    context.unbindComponent(component, timeout);
  }
  static void dismiss_members(ExecutionContextBase& context) { context.dismissMembers(); }
  static ReturnCode_t stop_by(ExecutionContextBase& context, Deadline deadline) { return context.stopBy(deadline); }
  static bool wait_for_quiet(ExecutionContextBase& context, std::chrono::nanoseconds timeout) { return context.waitForQuiet(timeout); }
  static void transit(ExecutionContextBase& context) { context.invokeWorkerPreDo(); }
  static void execute(ExecutionContextBase& context) { context.invokeWorkerDo(); }
  static void update(ExecutionContextBase& context) { context.invokeWorkerPostDo(); }
  static void cycle(ExecutionContextBase& context) { context.invokeWorker(); }

  // A data port and its connections.
  // The time for stamps on threads that no context runs. For connections that are made later; the component sets it when it takes the port.
  static void set_clock(DataPortBase<InPortConnector>& port, std::shared_ptr<const base::Clock> clock);
  static void set_clock(DataPortBase<OutPortConnector>& port, std::shared_ptr<const base::Clock> clock);
  static const corba::TypeOps& ops(const detail::DataType& type);
  static ConnectorListeners& listeners(ConnectorBase& connector) { return connector.listeners(); }
  static std::shared_ptr<ConnectorInfo> info(const ConnectorBase& connector) { return connector.info(); }
  static void set_info(ConnectorBase& connector, ConnectorInfo info) { connector.setInfo(std::move(info)); }
  // What waits in a connection, for its buffer to show.
  static void show(CdrBufferBase& buffer, const std::weak_ptr<corba::Waiting>& waiting, std::size_t length);
  static std::shared_ptr<corba::Waiting> waiting(const CdrBufferBase& buffer);
  // The two ends of a transport of an author.
  static void serve(InPortConnector& connector, const std::weak_ptr<corba::Receiver>& receiver, bool is_little);
  static void serve(OutPortConnector& connector, const std::weak_ptr<corba::Source>& source, bool is_little);
};

}  // namespace RTC
