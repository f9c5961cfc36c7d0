#include "corba/orb/call_watch.h"

// Each needs the one before it.
// clang-format off
#include <omniORB4/CORBA.h>
#include <omniORB4/omniInterceptors.h>
#include <omniORB4/internal/giopStream.h>
#include <omniORB4/internal/giopStrand.h>
#include <omniORB4/internal/GIOP_S.h>
// clang-format on

#include <algorithm>
#include <array>
#include <span>

#include "base/clock.h"
#include "base/nondeterminism.h"
#include "base/tick.h"
#include "corba/orb/call_context.h"
#include "corba/orb/object_names.h"

namespace corba {
namespace {

constexpr std::array changes_parameters = {std::string_view("activate_configuration_set"), std::string_view("add_configuration_set"),
                                           std::string_view("remove_configuration_set"), std::string_view("set_configuration_set_values")};
constexpr std::array changes_states = {std::string_view("activate_component"),
                                       std::string_view("add_component"),
                                       std::string_view("attach_context"),
                                       std::string_view("deactivate_component"),
                                       std::string_view("detach_context"),
                                       std::string_view("exit"),
                                       std::string_view("finalize"),
                                       std::string_view("remove_component"),
                                       std::string_view("reset_component"),
                                       std::string_view("set_rate"),
                                       std::string_view("start"),
                                       std::string_view("stop")};
constexpr std::array changes_connections = {std::string_view("connect"), std::string_view("disconnect"), std::string_view("disconnect_all"),
                                            std::string_view("notify_connect"), std::string_view("notify_disconnect")};
// Of the runtime itself, besides those that begin with get_, on_, is_ or an underscore.
constexpr std::array of_the_runtime = {std::string_view("put"),
                                       std::string_view("push"),
                                       std::string_view("pull"),
                                       std::string_view("initialize"),
                                       std::string_view("update_status"),
                                       std::string_view("publish"),
                                       std::string_view("tick"),
                                       std::string_view("subscribe"),
                                       std::string_view("unsubscribe"),
                                       std::string_view("shutdown"),
                                       std::string_view("restart"),
                                       std::string_view("create_component"),
                                       std::string_view("delete_component"),
                                       std::string_view("load_module"),
                                       std::string_view("unload_module"),
                                       std::string_view("send_stop"),
                                       std::string_view("open_memory"),
                                       std::string_view("create_memory"),
                                       std::string_view("close_memory"),
                                       std::string_view("setInterface"),
                                       std::string_view("setEndian"),
                                       std::string_view("add_service_profile"),
                                       std::string_view("remove_service_profile"),
                                       std::string_view("get")};

template <class Names>
bool has(const Names& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

bool is_of_the_runtime(std::string_view operation) {
  for (const std::string_view beginning : {"get_", "on_", "is_", "_", "add_master", "add_slave", "remove_master", "remove_slave"}) {
    if (operation.starts_with(beginning)) return true;
  }
  return has(of_the_runtime, operation);
}

_CORBA_Boolean say_moment(omni::omniInterceptors::clientSendRequest_T::info_T& request) {
  const base::Tick* tick = base::tick_in_lock_step();
  if (tick != nullptr && !is_of_the_runtime(request.operation()))
    add_to_call(request.service_contexts, CallContext::phase_counter, tick->phase_counter());
  return true;
}

_CORBA_Boolean look_at_call(omni::omniInterceptors::serverReceiveRequest_T::info_T& request) {
  const auto clock = base::lock_step_clock();
  const std::uint64_t phase_counter = clock ? clock->phase_counter() : 0;
  if (phase_counter == 0) return true;
  // 0: of no tick, or of one that did not say so.
  const std::uint64_t phase_counter_of_caller = said_by_call(request.giop_s.service_contexts(), CallContext::phase_counter).value_or(0);
  const auto what = nondeterminism_of_call(request.operation(), phase_counter, phase_counter_of_caller);
  if (what.empty() || clock->stands_still()) return true;
  const std::span key(request.giop_s.key(), static_cast<std::size_t>(request.giop_s.keysize()));
  base::report_nondeterminism(name_of_object(std::as_bytes(key)), what, clock->now());
  return true;
}

}  // namespace

std::string nondeterminism_of_call(std::string_view operation, std::uint64_t phase_counter, std::uint64_t phase_counter_of_caller) {
  if (phase_counter == 0) return "";
  const auto by = " by another process (" + std::string(operation) + ")";
  if (has(changes_parameters, operation)) return "had its parameters changed" + by;
  if (has(changes_states, operation)) return "had its state or a context changed" + by;
  if (has(changes_connections, operation)) return "had a connection made or ended" + by;
  if (base::is_in_phase(phase_counter) && phase_counter_of_caller != phase_counter && !is_of_the_runtime(operation))
    return "had a service called while a phase ran" + by;
  return "";
}

void watch_calls() {
  omniORB::getInterceptors()->clientSendRequest.add(&say_moment);
  omniORB::getInterceptors()->serverReceiveRequest.add(&look_at_call);
}

}  // namespace corba
