#include "corba/call_timeout.h"

#include <omniORB4/omniORB.h>

#include <algorithm>
#include <atomic>

namespace corba {
namespace {

std::atomic<std::int64_t> timeout_ms{10000};  // relaxed everywhere: a setting, it orders nothing

}  // namespace

void set_port_call_timeout(std::chrono::milliseconds timeout) {
  timeout_ms.store(std::clamp<std::int64_t>(timeout.count(), 1, 3'600'000), std::memory_order_relaxed);
}

std::chrono::milliseconds port_call_timeout() { return std::chrono::milliseconds(timeout_ms.load(std::memory_order_relaxed)); }

void limit_calls(CORBA::Object_ptr object, std::chrono::milliseconds timeout) {
  if (CORBA::is_nil(object)) return;
  omniORB::setClientCallTimeout(object, static_cast<CORBA::ULong>(std::clamp<std::int64_t>(timeout.count(), 1, 3'600'000)));
}

}  // namespace corba
