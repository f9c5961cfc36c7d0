// The callbacks of a component: called one and all through callInTurn, one at a time.
#include "component/component_impl.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "base/abnormal_exit.h"
#include "base/text.h"
#include "base/tick.h"
#include "base/waiting.h"
#include "corba/orb/call_context.h"
#include "corba/orb/orb.h"

namespace RTC {

namespace {

// A component whose callback this thread runs; several, one inside the other.
class InsideCallback {
 public:
  explicit InsideCallback(const RTObject_impl& component) : component_(component), outer_(std::exchange(innermost, this)) {}
  ~InsideCallback() { innermost = outer_; }
  InsideCallback(const InsideCallback&) = delete;
  InsideCallback& operator=(const InsideCallback&) = delete;
  static bool any() { return innermost != nullptr; }
  static bool any_of(const RTObject_impl* component) {
    for (const InsideCallback* one = innermost; one != nullptr; one = one->outer_)
      if (&one->component_ == component) return true;
    return false;
  }

 private:
  static thread_local const InsideCallback* innermost;
  const RTObject_impl& component_;
  const InsideCallback* const outer_;
};
thread_local const InsideCallback* InsideCallback::innermost = nullptr;

std::string in_seconds(std::chrono::nanoseconds time) {
  return base::format_number(std::round(std::chrono::duration<double>(time).count() * 100) / 100) + " s";
}

}  // namespace

bool isInsideCallback() { return InsideCallback::any(); }
bool isInsideCallbackOf(const RTObject_impl* component) { return InsideCallback::any_of(component); }

ReturnCode_t RTObject_impl::onInitialize() { return RTC_OK; }
ReturnCode_t RTObject_impl::onFinalize() { return RTC_OK; }
ReturnCode_t RTObject_impl::onStartup(RTC::UniqueId) { return RTC_OK; }
ReturnCode_t RTObject_impl::onShutdown(RTC::UniqueId) { return RTC_OK; }
ReturnCode_t RTObject_impl::onActivated(RTC::UniqueId) { return RTC_OK; }
ReturnCode_t RTObject_impl::onDeactivated(RTC::UniqueId) { return RTC_OK; }
ReturnCode_t RTObject_impl::onExecute(RTC::UniqueId) { return RTC_OK; }
ReturnCode_t RTObject_impl::onAborting(RTC::UniqueId) { return RTC_OK; }
ReturnCode_t RTObject_impl::onError(RTC::UniqueId) { return RTC_OK; }
ReturnCode_t RTObject_impl::onReset(RTC::UniqueId) { return RTC_OK; }
ReturnCode_t RTObject_impl::onStateUpdate(RTC::UniqueId) { return RTC_OK; }
ReturnCode_t RTObject_impl::onRateChanged(RTC::UniqueId) { return RTC_OK; }
ReturnCode_t RTObject_impl::onAction(RTC::UniqueId) { return RTC_OK; }

// --- the one way to an author's code

namespace {

// `action` is one of RTC::ComponentAction: its listeners stand in both lists at one place.
constexpr int listeners_of(rt::Action action) { return PRE_ON_STARTUP + static_cast<int>(action); }
static_assert(listeners_of(rt::Action::rate_changed) == PRE_ON_RATE_CHANGED && listeners_of(rt::Action::error) == PRE_ON_ERROR);
static_assert(int{PRE_ON_STARTUP} == int{POST_ON_STARTUP} && int{PRE_ON_RATE_CHANGED} == int{POST_ON_RATE_CHANGED});
static_assert(int{PRE_ON_INITIALIZE} == int{POST_ON_INITIALIZE} && int{PRE_ON_FINALIZE} == int{POST_ON_FINALIZE});

}  // namespace

// Calls the author's functions when their turn comes; what they throw is logged and RTC_ERROR.
class RTObject_impl::Callbacks {
 public:
  explicit Callbacks(RTObject_impl& component)
      : component_(component), rtclog(component.rtclog), is_outside_(OutsideCall::is_mine(component)) {}

  // `refusal` says why a caller from outside may not call now, `done` comes after a callback that such a caller has called.
  template <class Refusal, class Function, class Done>
  ReturnCode_t in_turn(const char* name, Refusal refusal, Function function, Done done);

  // For a context. `alone`: without the listeners, which the function notifies itself.
  template <class Function>
  ReturnCode_t call(rt::Action action, ExecutionContextHandle_t exec_handle, Function function) {
    return alone(action, exec_handle, [&] { return heard(listeners_of(action), exec_handle, function); });
  }
  template <class Function>
  ReturnCode_t alone(rt::Action action, ExecutionContextHandle_t exec_handle, Function function);

  // With the component action listeners before and after it.
  template <class Function>
  ReturnCode_t heard(int listeners, ExecutionContextHandle_t exec_handle, Function function) {
    component_.m_actionListeners.preaction_[static_cast<PreComponentActionListenerType>(listeners)].notify(exec_handle);
    const ReturnCode_t code = function();
    component_.m_actionListeners.postaction_[static_cast<PostComponentActionListenerType>(listeners)].notify(exec_handle, code);
    return code;
  }

 private:
  RTObject_impl& component_;
  Logger& rtclog;
  const bool is_outside_;
};

template <class Refusal, class Function, class Done>
ReturnCode_t RTObject_impl::Callbacks::in_turn(const char* name, Refusal refusal, Function function, Done done) {
  using Gate = rt::CallbackGate;
  base::expect_no_data_held();
  if (is_outside_ && !component_.mayBeChangedByCaller(name)) return RTC_ERROR;
  Gate::Visit visit(component_.impl_->gate, name, is_outside_ ? Gate::Caller::remote : Gate::Caller::local);
  if (visit.answer() != Gate::Answer::inside) {
    if (is_outside_)
      if (const auto why = refusal()) return component_.refuse(name, *why, PRECONDITION_NOT_MET);
    const bool is_simulated = is_outside_ ? corba::clock_of_caller() != nullptr : base::tick_in_lock_step() != nullptr;
    const std::chrono::nanoseconds timeout = is_simulated ? std::chrono::nanoseconds(simulated_timeout)
                                             : is_outside_
                                                 ? std::chrono::nanoseconds(remote_timeout)
                                                 : std::max<std::chrono::nanoseconds>(component_.callbackTimeout(), local_timeout);
    {
      const base::ScopedWait waiting;
      visit.wait(std::chrono::steady_clock::now() + timeout);
    }
    if (visit.answer() != Gate::Answer::inside) {
      const std::string running = component_.impl_->gate.describe();
      const std::string why = visit.answer() == Gate::Answer::crowded  ? "too many callers wait for its callbacks"
                              : visit.answer() == Gate::Answer::closed ? "the component ends"
                              : running.empty()                        ? "other callbacks took too long"
                                                                       : running;
      if (is_outside_) return component_.refuse(name, why, PRECONDITION_NOT_MET);
      RTC_ERROR(("%s was not called: %s", name, why.c_str()));
      return RTC_ERROR;
    }
  }
  if (is_outside_)
    if (const auto why = refusal()) return component_.refuse(name, *why, PRECONDITION_NOT_MET);
  const InsideCallback inside(component_);
  const base::CallbackOnStack on_stack(component_.m_profile.instance_name, name);
  // Called by a context of another process: its time is ours.
  std::optional<base::ScopedClock> clock;
  if (const auto* of_caller = corba::clock_of_caller()) clock.emplace(base::current_clock_or(*of_caller));
  ReturnCode_t code = RTC_ERROR;
  std::string thrown;
  try {
    code = function();
  } catch (const CORBA::Exception& exception) {
    thrown = std::string(name) + " threw " + corba::to_text(exception);
  } catch (const std::exception& exception) {
    thrown = std::string(name) + " threw: " + exception.what();
  } catch (...) {
    thrown = std::string(name) + " threw something that is no std::exception";
  }
  // An equal exception is logged once, not in each cycle of the error state.
  if (thrown != component_.impl_->last_thrown && !thrown.empty()) RTC_ERROR(("%s", thrown.c_str()));
  component_.impl_->last_thrown = std::move(thrown);
  if (is_outside_) done();
  return code;
}

template <class Function>
ReturnCode_t RTObject_impl::Callbacks::alone(rt::Action action, ExecutionContextHandle_t exec_handle, Function function) {
  Impl& impl = *component_.impl_;
  const auto refusal = [&]() -> std::optional<std::string> {
    auto data = impl.shared.lock();
    if (data->phase != Impl::Phase::initializing && data->phase != Impl::Phase::alive && data->phase != Impl::Phase::exiting)
      return "the component is not alive";
    const auto context = data->elsewhere.find(exec_handle);
    return why_not(action, context == data->elsewhere.end() ? std::nullopt : std::optional(context->second));
  };
  const auto done = [&] {
    auto data = impl.shared.lock();
    const auto context = data->elsewhere.find(exec_handle);
    if (context != data->elsewhere.end()) context->second = is_active_after(action, context->second);
  };
  return in_turn(rt::callback_of(action).data(), refusal, function, done);
}

ReturnCode_t RTObject_impl::on_initialize() {
  const auto refusal = [this]() -> std::optional<std::string> {
    if (m_pManager != nullptr) return "its manager initializes the component";
    auto data = impl_->shared.lock();
    if (data->phase != Impl::Phase::created) return "the component is not in its CREATED state";
    if (data->was_initialized_from_outside) return "it has been called already";
    return std::nullopt;
  };
  const auto done = [this] { impl_->shared.lock()->was_initialized_from_outside = true; };
  Callbacks callbacks(*this);
  const auto initialize = [&] {
    if (auto faults = rt::ExecuteFaults::parse(property("fault.on_execute", ""))) {
      impl_->faults = std::move(*faults);
    } else {
      RTC_WARN(("%s", faults.error().message.c_str()));
    }
    return callbacks.heard(PRE_ON_INITIALIZE, 0, [this] {
      const ReturnCode_t code = onInitialize();
      const std::string active = property("configuration.active_config", "default");
      if (!m_configsets.activateConfigurationSet(active.c_str())) m_configsets.activateConfigurationSet("default");
      m_configsets.update();
      return code;
    });
  };
  return callbacks.in_turn("onInitialize", refusal, initialize, done);
}

ReturnCode_t RTObject_impl::on_finalize() {
  Callbacks callbacks(*this);
  const auto refusal = [] { return std::optional<std::string>("the runtime calls it when the component ends; exit ends one"); };
  const auto finalize = [&] { return callbacks.heard(PRE_ON_FINALIZE, 0, [this] { return onFinalize(); }); };
  return callbacks.in_turn("onFinalize", refusal, finalize, [] {});
}

ReturnCode_t RTObject_impl::on_startup(ExecutionContextHandle_t exec_handle) {
  return Callbacks(*this).call(rt::Action::startup, exec_handle, [&] { return onStartup(exec_handle); });
}

ReturnCode_t RTObject_impl::on_shutdown(ExecutionContextHandle_t exec_handle) {
  return Callbacks(*this).call(rt::Action::shutdown, exec_handle, [&] { return onShutdown(exec_handle); });
}

ReturnCode_t RTObject_impl::on_activated(ExecutionContextHandle_t exec_handle) {
  return Callbacks(*this).call(rt::Action::activated, exec_handle, [&] {
    m_configsets.update();
    const ReturnCode_t code = onActivated(exec_handle);
    activatePorts(exec_handle);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_deactivated(ExecutionContextHandle_t exec_handle) {
  return Callbacks(*this).call(rt::Action::deactivated, exec_handle, [&] {
    deactivatePorts(exec_handle);
    return onDeactivated(exec_handle);
  });
}

ReturnCode_t RTObject_impl::on_aborting(ExecutionContextHandle_t exec_handle) {
  return Callbacks(*this).call(rt::Action::aborting, exec_handle, [&] { return onAborting(exec_handle); });
}

ReturnCode_t RTObject_impl::on_error(ExecutionContextHandle_t exec_handle) {
  return Callbacks(*this).call(rt::Action::error, exec_handle, [&] {
    const ReturnCode_t code = onError(exec_handle);
    m_configsets.update();
    return code;
  });
}

ReturnCode_t RTObject_impl::on_reset(ExecutionContextHandle_t exec_handle) {
  return Callbacks(*this).call(rt::Action::reset, exec_handle, [&] { return onReset(exec_handle); });
}

ReturnCode_t RTObject_impl::on_execute(ExecutionContextHandle_t exec_handle) {
  Callbacks callbacks(*this);
  const auto execute = [&] {
    bool reads = false, writes = false;
    {
      auto data = impl_->shared.lock();
      reads = data->reads_all;
      writes = data->writes_all;
    }
    if (reads) readAll();
    const ReturnCode_t code = impl_->faults && impl_->faults->strike() ? RTC_ERROR : onExecute(exec_handle);
    if (writes) writeAll();
    return code;
  };
  return callbacks.alone(rt::Action::execute, exec_handle, [&] {
    if (base::tick_in_lock_step()) m_configsets.update();  // at the edge that all ticks of one time have in common
    return callbacks.heard(PRE_ON_EXECUTE, exec_handle, execute);
  });
}

ReturnCode_t RTObject_impl::on_state_update(ExecutionContextHandle_t exec_handle) {
  return Callbacks(*this).call(rt::Action::state_update, exec_handle, [&] {
    const ReturnCode_t code = onStateUpdate(exec_handle);
    if (!base::tick_in_lock_step()) m_configsets.update();
    return code;
  });
}

ReturnCode_t RTObject_impl::on_rate_changed(ExecutionContextHandle_t exec_handle) {
  return Callbacks(*this).call(rt::Action::rate_changed, exec_handle, [&] { return onRateChanged(exec_handle); });
}

std::vector<RTObject_impl::RunningCallback> RTObject_impl::runningCallbacks() const {
  std::vector<RunningCallback> others;
  for (const rt::CallbackGate::Running& one : impl_->gate.others_inside())
    others.push_back({one.callback, one.since, one.thread, one.is_given_up});
  return others;
}

bool RTObject_impl::isHeldByCallback() const { return !runningCallbacks().empty(); }

bool RTObject_impl::waitForCallbacks(std::chrono::steady_clock::time_point deadline) { return impl_->gate.wait_until_empty(deadline); }

void RTObject_impl::complainAboutCallbacks(const char* consequence) const {
  for (const RunningCallback& one : runningCallbacks())
    RTC_ERROR(
        ("%s has not returned for %s: %s", one.callback, in_seconds(std::chrono::steady_clock::now() - one.since).c_str(), consequence));
}

}  // namespace RTC
