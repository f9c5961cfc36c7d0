// Creates execution contexts by name. Plug-ins add their type with ExecutionContextFactory::instance().addFactory or, in 1.x spelling,
// Manager::registerECFactory. Any thread.
#pragma once

#include <coil/Factory.h>
#include <rtm/ExecutionContextBase.h>

#include <string>

namespace RTC {

class Manager;

using ExecutionContextFactory = coil::GlobalFactory<ExecutionContextBase>;

using ECNewFunc = ExecutionContextBase* (*)();
using ECDeleteFunc = void (*)(ExecutionContextBase* ec);

template <class Context>
ExecutionContextBase* ECCreate() {
  return new Context();
}
template <class Context>
void ECDelete(ExecutionContextBase* ec) {
  destroyExecutionContext(ec);
}

// Adds the contexts that we have ourselves: PeriodicExecutionContext, ExtTrigExecutionContext, OpenHRPExecutionContext,
// SimulatorExecutionContext and MultilayerCompositeEC. Calling it again changes nothing.
void registerBuiltinExecutionContexts(RTC::Manager* manager = nullptr);

}  // namespace RTC
