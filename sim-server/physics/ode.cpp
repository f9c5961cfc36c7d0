#include "physics/ode.h"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include "base/log.h"

namespace sim::ode {
namespace {

std::string line_of(const char* format, va_list arguments) {
  char text[512];
  std::vsnprintf(text, sizeof text, format, arguments);
  return text;
}

void on_message(int, const char* format, va_list arguments) {
  base::log(base::Level::debug, "physics", "ode: {}", line_of(format, arguments));
}

// ODE must not be left by an exception, and does not go on when such a handler returns.
[[noreturn]] void on_fault(int, const char* format, va_list arguments) {
  base::log(base::Level::fatal, "physics", "ode: {}", line_of(format, arguments));
  std::abort();
}

}  // namespace

void prepare_thread() {
  static const bool is_initialised = [] {
    dInitODE2(dInitFlagManualThreadCleanup);
    dSetMessageHandler(on_message);
    dSetErrorHandler(on_fault);
    dSetDebugHandler(on_fault);
    return true;
  }();
  thread_local const bool is_prepared = dAllocateODEDataForThread(dAllocateMaskAll) != 0;
  (void)is_initialised;
  (void)is_prepared;
}

World::World() {
  prepare_thread();
  threading_ = Threading(dThreadingAllocateSelfThreadedImplementation());
  world_ = Handle<dWorldID, dWorldDestroy>(dWorldCreate());
  dWorldSetStepThreadingImplementation(world_.id(), dThreadingImplementationGetFunctions(threading_.id()), threading_.id());
  dWorldSetStepIslandsProcessingMaxThreadCount(world_.id(), 1);
}

}  // namespace sim::ode
