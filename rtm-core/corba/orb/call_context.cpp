#include "corba/orb/call_context.h"

// Each needs the one before it.
// clang-format off
#include <omniORB4/CORBA.h>
#include <omniORB4/omniInterceptors.h>
#include <omniORB4/internal/giopStream.h>
#include <omniORB4/internal/giopStrand.h>
#include <omniORB4/internal/GIOP_S.h>
// clang-format on

#include <string_view>

namespace corba {
namespace {

constexpr CORBA::ULong encapsulation_size = 16;  // octet order, padding, unsigned long long

// The ORB's thread carries out one call at a time, and its clock is used in no other thread.
class CallersClock final : public base::Clock {
 public:
  std::chrono::nanoseconds now() const override { return now_.value_or(std::chrono::nanoseconds(0)); }
  bool is_simulated() const override { return true; }
  void set(std::optional<std::uint64_t> now) {
    now_.reset();
    if (now) now_ = std::chrono::nanoseconds(static_cast<std::int64_t>(*now));
  }
  bool is_known() const { return now_.has_value(); }

 private:
  std::optional<std::chrono::nanoseconds> now_;
};

CallersClock& callers_clock() {
  thread_local CallersClock clock;
  return clock;
}

bool is_of_a_context(std::string_view operation) { return operation.starts_with("on_") || operation == "tick"; }

_CORBA_Boolean say_time(omni::omniInterceptors::clientSendRequest_T::info_T& request) {
  const base::Clock& clock = base::current_clock();
  if (clock.is_simulated() && is_of_a_context(request.operation()))
    add_to_call(request.service_contexts, CallContext::time, static_cast<std::uint64_t>(clock.now().count()));
  return true;
}

_CORBA_Boolean remember_time(omni::omniInterceptors::serverReceiveRequest_T::info_T& request) {
  callers_clock().set(is_of_a_context(request.operation()) ? said_by_call(request.giop_s.service_contexts(), CallContext::time)
                                                           : std::nullopt);
  return true;
}

}  // namespace

void add_to_call(IOP::ServiceContextList& contexts, CallContext which, std::uint64_t number) {
  IOP::ServiceContext context;
  context.context_id = static_cast<CORBA::ULong>(which);
  context.context_data.length(encapsulation_size);
  for (CORBA::ULong i = 0; i < encapsulation_size; ++i)
    context.context_data[i] = i < 8 ? 0 : static_cast<CORBA::Octet>(number >> (8 * (encapsulation_size - 1 - i)));
  contexts.length(contexts.length() + 1);
  contexts[contexts.length() - 1] = context;
}

std::optional<std::uint64_t> said_by_call(const IOP::ServiceContextList& contexts, CallContext which) {
  for (CORBA::ULong at = 0; at < contexts.length(); ++at) {
    if (contexts[at].context_id != static_cast<CORBA::ULong>(which) || contexts[at].context_data.length() != encapsulation_size) continue;
    std::uint64_t number = 0;
    for (CORBA::ULong i = 8; i < encapsulation_size; ++i) number = number << 8 | contexts[at].context_data[i];
    return number;
  }
  return std::nullopt;
}

void pass_on_time() {
  omniORB::getInterceptors()->clientSendRequest.add(&say_time);
  omniORB::getInterceptors()->serverReceiveRequest.add(&remember_time);
}

const base::Clock* clock_of_caller() { return callers_clock().is_known() ? &callers_clock() : nullptr; }

}  // namespace corba
