#include "corba/orb/call_timeout.h"

// Each needs the one before it.
// clang-format off
#include <omniORB4/minorCode.h>
#include <omniORB4/omniORB.h>
#include <omniORB4/omniInterceptors.h>
// clang-format on

#include <algorithm>
#include <atomic>

#include "base/guarded.h"

namespace corba {
namespace {

std::atomic<std::int64_t> timeout_ms{10000};  // relaxed everywhere: a setting, it orders nothing

}  // namespace

void set_port_call_timeout(std::chrono::milliseconds timeout) {
  timeout_ms.store(std::clamp<std::int64_t>(timeout.count(), 1, 3'600'000), std::memory_order_relaxed);
}

std::chrono::milliseconds port_call_timeout() { return std::chrono::milliseconds(timeout_ms.load(std::memory_order_relaxed)); }

void expect_no_data_held_at_calls() {
#ifndef NDEBUG
  omniORB::getInterceptors()->clientSendRequest.add([](omni::omniInterceptors::clientSendRequest_T::info_T&) -> _CORBA_Boolean {
    base::expect_no_data_held();
    return true;
  });
#endif
}

void limit_calls(CORBA::Object_ptr object, std::chrono::milliseconds timeout) {
  base::expect_no_data_held();
  if (CORBA::is_nil(object)) return;
  omniORB::setClientCallTimeout(object, static_cast<CORBA::ULong>(std::clamp<std::int64_t>(timeout.count(), 1, 3'600'000)));
}

bool is_time_out(const CORBA::Exception& problem) {
  if (dynamic_cast<const CORBA::TIMEOUT*>(&problem)) return true;
  const auto* transient = dynamic_cast<const CORBA::TRANSIENT*>(&problem);
  return transient && transient->minor() == omni::TRANSIENT_CallTimedout;
}

namespace {

constexpr int max_timeouts = 3;

}  // namespace

ChainDeadline::ChainDeadline(std::chrono::milliseconds timeout_of_one)
    : timeout_of_one_(timeout_of_one), end_(std::chrono::steady_clock::now() + max_timeouts * timeout_of_one) {}

std::chrono::milliseconds ChainDeadline::left() const {
  return std::chrono::ceil<std::chrono::milliseconds>(end_ - std::chrono::steady_clock::now());
}

void ChainDeadline::limit(CORBA::Object_ptr object) const { limit_calls(object, std::min(left(), timeout_of_one_)); }

std::chrono::milliseconds chain_timeout(std::chrono::milliseconds timeout_of_one, std::size_t left, std::size_t all) {
  return timeout_of_one * static_cast<int>(left) / static_cast<int>(all);
}

}  // namespace corba
