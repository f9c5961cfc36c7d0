#include "run/time_members.h"

#include <omnithread.h>

#include <algorithm>
#include <filesystem>
#include <future>

#include "base/text.h"
#include "rtm/idl/LogicalTimeTriggeredECStub.h"
#include "rtm/idl/OpenRTMStub.h"
#include "system/configuration.h"
#include "system/transitions.h"

namespace tools {
namespace {

const std::string proxy_type = "SimTimeProxy";

bool is_simulated(const ContextView& context) { return property(context.properties, "type") == "SimTimeContext"; }

int index_of(const ComponentView& component, const ContextView& context) { return static_cast<int>(&context - component.contexts.data()); }

// It may run in one context only. True when it was active.
Result<bool> rest_in_own_contexts(const Session& session, const ComponentView& component) {
  bool was_active = false;
  for (const auto& context : component.contexts) {
    if (!context.is_owned) continue;
    if (context.state == RTC::ERROR_STATE) return Error{"component " + component.path + ": is in the ERROR state (try: rtse reset)"};
    if (context.state != RTC::ACTIVE_STATE) continue;
    if (const auto rests = change_state(component, Transition::deactivate, index_of(component, context), session.transition_timeout());
        !rests)
      return rests.error();
    was_active = true;
  }
  return was_active;
}

Result<void> activate_in(const Session& session, const std::string& path, bool in_simulated_time) {
  const auto component = session.component(path, {.contexts = true});
  if (!component) return component.error();
  for (const auto& context : component->contexts) {
    if (in_simulated_time ? &context == simulated_context(*component) : context.is_owned)
      return change_state(*component, Transition::activate, index_of(*component, context), session.transition_timeout());
  }
  return {};  // without a context of its own it rests
}

// The proxy, active from now on, ticks the first context of the component's own.
Result<void> tick_own_context(const Session& session, const ComponentView& component, const ComponentView& proxy) {
  const auto own = std::ranges::find_if(component.contexts, [](const auto& context) { return context.is_owned; });
  if (own == component.contexts.end()) return Error{"component " + component.path + ": has no context of its own that could be ticked"};
  bool is_ticked = false;
  const auto asked = remote("component " + component.path, [&] {
    is_ticked = own->object->_is_a(OpenRTM::ExtTrigExecutionContextService::_PD_repoId) ||
                own->object->_is_a(OpenRTM::LogicalTimeTriggeredEC::_PD_repoId);
  });
  if (!asked) return asked;
  if (!is_ticked)
    return Error{"component " + component.path + ": its context (" + property(own->properties, "type", "of no type") +
                 ") is not ticked from outside; join it as a member"};
  const CORBA::String_var reference = session.orb()->object_to_string(own->object);
  if (const auto set = set_values(proxy, "default", {{"ticks", reference.in()}}); !set) return set;
  if (const auto used = use_set(proxy, "default"); !used) return used;
  return change_state(proxy, Transition::activate, 0, session.transition_timeout());
}

// Ends the owner of a context if that is a proxy of ours.
Result<void> end_proxy(const ContextView& context) {
  return remote("the owner of the context on simulated time", [&] {
    const RTC::ExecutionContextService_var service = RTC::ExecutionContextService::_narrow(context.object);
    if (CORBA::is_nil(service)) return;
    RTC::ExecutionContextProfile_var profile = service->get_profile();
    if (CORBA::is_nil(profile->owner)) return;
    RTC::ComponentProfile_var owner = profile->owner->get_component_profile();
    if (owner->type_name.in() == proxy_type) profile->owner->exit();
  });
}

// Of one whose own context is ticked.
bool leave_proxy(const Session& session, const std::string& instance) {
  const auto proxy = session.component(proxy_name(instance) + ".rtc", {});
  return proxy && proxy->type == proxy_type && remote("proxy of " + instance, [&] { proxy->object->exit(); });
}

}  // namespace

std::string proxy_name(const std::string& instance) { return instance + "_time"; }

bool has_proxy(const Session& session, const std::string& instance) {
  const auto proxy = session.component(proxy_name(instance) + ".rtc", {});
  return proxy && proxy->type == proxy_type;
}

std::string proxy_creation(const TimeMember& member, const std::string& server_id) {
  return proxy_type + "?instance_name=" + proxy_name(member.instance) +
         "&exec_cxt.periodic.type=SimTimeContext&exec_cxt.periodic.rate=" + member.rate +
         "&exec_cxt.sim_time.phase=" + std::to_string(member.phase) + "&" + turn_key + "=" + std::to_string(member.turn) +
         "&exec_cxt.sim_time.server_id=" + server_id + "&exec_cxt.sim_time.participant=" + member.instance;
}

std::string clock_creation(int phase, const std::string& server_id) {
  return "ClockGenerator?conf.default.phase=" + std::to_string(phase) + "&conf.default.server_id=" + server_id;
}

std::optional<TimeMember::How> parse_how(const std::string& text) {
  if (text == "member") return TimeMember::How::member;
  if (text == "tick") return TimeMember::How::tick;
  if (text == "clock") return TimeMember::How::clock;
  return std::nullopt;
}

std::vector<std::string> module_paths(const std::vector<std::string>& before) {
  const auto libraries = std::filesystem::path(base::own_program("rtcd")).parent_path().parent_path() / "lib";
  auto paths = before;
  paths.push_back(libraries.string());
  paths.push_back((libraries / "rtm-sim").string());
  return paths;
}

std::vector<std::string> host_words(const HostSettings& settings) {
  const auto paths = module_paths(settings.module_paths);
  // In lock step the wall-clock time of a call must not change the run. The watch of the run ends a tick that hangs (--hang-timeout).
  std::vector<std::string> options = {"corba.call_timeout:3600",
                                      "corba.nameservers:" + settings.naming,
                                      "manager.modules.load_path:" + base::join(paths, ","),
                                      "manager.modules.preload:SimTimeContext.so",
                                      "exec_cxt.periodic.type:SimTimeContext",
                                      "manager.instance_name:" + settings.name,
                                      "logger.log_level:INFO"};
  options.insert(options.end(), settings.options.begin(), settings.options.end());
  std::vector<std::string> words = {base::own_program("rtcd"), "-f", settings.empty_file};
  for (const auto& option : options) words.insert(words.end(), {"-o", option});
  words.insert(words.end(), settings.creations.begin(), settings.creations.end());
  return words;
}

const ContextView* simulated_context(const ComponentView& component) {
  const auto it = std::ranges::find_if(component.contexts, [](const auto& context) { return !context.is_owned && is_simulated(context); });
  return it == component.contexts.end() ? nullptr : &*it;
}

bool ticks_on_its_own(const ComponentView& component) {
  const auto own = std::ranges::find_if(component.contexts, [](const auto& context) { return context.is_owned; });
  return own != component.contexts.end() && property(own->properties, "type") == "ExtTrigExecutionContext";
}

Result<void> join_time(const Session& session, const std::string& path, const std::string& proxy, TimeMember::How how,
                       std::chrono::milliseconds timeout) {
  const auto component = session.component(path, {.contexts = true});
  if (!component) return component.error();
  if (simulated_context(*component))
    return Error{"component " + component->path + ": already participates in simulated time (rtse leave ends that)"};
  const auto host = session.component(proxy, {.contexts = true});
  if (!host) return host.error();
  if (host->contexts.empty() || !is_simulated(host->contexts.front()))
    return Error{"component " + host->path + ": is not a SimTimeProxy of this runtime"};
  if (how == TimeMember::How::tick) return tick_own_context(session, *component, *host);
  const auto was_active = rest_in_own_contexts(session, *component);
  if (!was_active) return was_active.error();
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  const auto what = "component " + component->path + ": joining simulated time";
  const CallLimit limited(timeout);  // the context asks the component in turn
  const auto called = remote(what, [&] { code = host->contexts.front().object->add_component(component->object); });
  if (!called) return called.error();
  if (const auto added = check(what, code, "it did not respond to attach_context, or rejected it; see the log of its process"); !added)
    return added;
  return *was_active ? activate_in(session, path, true) : Result<void>();
}

// One tick, of whichever kind the context takes.
void tick_once(RTC::ExecutionContext_ptr context) {
  static_cast<void>(remote("the context", [&] {
    const OpenRTM::ExtTrigExecutionContextService_var ticked = OpenRTM::ExtTrigExecutionContextService::_narrow(context);
    if (!CORBA::is_nil(ticked)) ticked->tick();
  }));
}

Result<void> rest_in_time(const Session& session, const std::string& path, TimeMember::How how) {
  constexpr std::chrono::milliseconds at_once{200};  // a context that needs no tick has done it within this time
  const auto component = session.component(path, {.contexts = true});
  if (!component) return component.error();
  const auto* context = how == TimeMember::How::member ? simulated_context(*component) : component->shown_context();
  if (context == nullptr || context->state != RTC::ACTIVE_STATE) return {};
  const int index = index_of(*component, *context);
  auto done = std::async(std::launch::async, [&] {
    const omni_thread::ensure_self known_to_the_orb;  // timeouts need it
    return change_state(*component, Transition::deactivate, index);
  });
  if (how != TimeMember::How::member && done.wait_for(at_once) != std::future_status::ready) tick_once(context->object);
  return done.get();
}

Result<void> leave_time(const Session& session, const std::string& path) {
  const auto component = session.component(path, {.contexts = true});
  if (!component) return component.error();
  bool is_active = false;
  int left = 0;
  for (const auto& context : component->contexts) {
    if (context.is_owned || !(is_simulated(context) || context.is_gone())) continue;
    ++left;
    if (context.is_gone()) {  // its host has died: only the component still knows of it
      const auto detached = remote("component " + component->path, [&] { component->object->detach_context(context.handle); });
      if (!detached) return detached;
      continue;
    }
    if (context.state == RTC::ACTIVE_STATE || context.state == RTC::ERROR_STATE) {
      is_active = is_active || context.state == RTC::ACTIVE_STATE;
      const auto step = context.state == RTC::ACTIVE_STATE ? Transition::deactivate : Transition::reset;
      if (const auto rests = change_state(*component, step, index_of(*component, context), session.transition_timeout()); !rests)
        return rests;
    }
    RTC::ReturnCode_t code = RTC::RTC_OK;
    const auto what = "component " + component->path + ": leaving simulated time";
    const auto called = remote(what, [&] { code = context.object->remove_component(component->object); });
    if (!called) return called;
    if (const auto removed = check(what, code); !removed) return removed;
    if (const auto ended = end_proxy(context); !ended) return ended;
  }
  if (left == 0 && leave_proxy(session, component->instance)) return {};
  if (left == 0) return Error{"component " + component->path + ": takes no part in simulated time"};
  return is_active ? activate_in(session, path, false) : Result<void>();
}

}  // namespace tools
