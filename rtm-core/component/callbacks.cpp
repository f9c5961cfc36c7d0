// The callbacks of a component: called one and all through callUser, which knows who is in one.
#include "component/component_impl.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>

#include "base/text.h"
#include "base/tick.h"
#include "corba/orb/call_context.h"
#include "corba/orb/orb.h"

namespace RTC {

namespace {

// How many callbacks of components run on this thread, one inside the other.
thread_local int callback_depth = 0;

std::string in_seconds(std::chrono::nanoseconds time) {
  return base::format_number(std::round(std::chrono::duration<double>(time).count() * 100) / 100) + " s";
}

}  // namespace

bool isInsideCallback() { return callback_depth > 0; }

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

// Writes down that a thread is in a callback, for its life.
class RTObject_impl::Impl::Visit {
 public:
  Visit(Impl& impl, const char* callback) : impl_(impl), callback_(callback) {
    ++callback_depth;
    impl_.running.lock()->push_back({callback_, std::chrono::steady_clock::now(), std::this_thread::get_id(), false});
  }
  ~Visit() {
    {
      auto running = impl_.running.lock();
      const auto self = std::this_thread::get_id();
      const auto it = std::find_if(running->rbegin(), running->rend(), [&](const RunningCallback& one) { return one.thread == self; });
      running->erase(std::next(it).base());
    }
    impl_.callback_ended.notify_all();
    --callback_depth;
  }
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

 private:
  Impl& impl_;
  const char* callback_;
};

template <class Function>
ReturnCode_t RTObject_impl::callUser(const char* name, Function function) {
  base::expect_no_data_held();
  const Impl::Visit visit(*impl_, name);
  // Called by a context of another process: its time is ours.
  std::optional<base::ScopedClock> clock;
  if (const auto* of_caller = corba::clock_of_caller()) clock.emplace(base::current_clock_or(*of_caller));
  try {
    return function();
  } catch (const CORBA::Exception& exception) {
    RTC_ERROR(("%s threw %s", name, corba::to_text(exception).c_str()));
  } catch (const std::exception& exception) {
    RTC_ERROR(("%s threw: %s", name, exception.what()));
  } catch (...) {
    RTC_ERROR(("%s threw something that is no std::exception", name));
  }
  return RTC_ERROR;
}

ReturnCode_t RTObject_impl::on_initialize() {
  return callUser("onInitialize", [this] {
    if (auto faults = rt::ExecuteFaults::parse(property("fault.on_execute", ""))) {
      impl_->faults = std::move(*faults);
    } else {
      RTC_WARN(("%s", faults.error().message.c_str()));
    }
    m_actionListeners.preaction_[PRE_ON_INITIALIZE].notify(0);
    const ReturnCode_t code = onInitialize();
    const std::string active = property("configuration.active_config", "default");
    if (!m_configsets.activateConfigurationSet(active.c_str())) m_configsets.activateConfigurationSet("default");
    m_configsets.update();
    m_actionListeners.postaction_[POST_ON_INITIALIZE].notify(0, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_finalize() {
  return callUser("onFinalize", [this] {
    m_actionListeners.preaction_[PRE_ON_FINALIZE].notify(0);
    const ReturnCode_t code = onFinalize();
    m_actionListeners.postaction_[POST_ON_FINALIZE].notify(0, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_startup(ExecutionContextHandle_t exec_handle) {
  return callUser("onStartup", [&] {
    m_actionListeners.preaction_[PRE_ON_STARTUP].notify(exec_handle);
    const ReturnCode_t code = onStartup(exec_handle);
    m_actionListeners.postaction_[POST_ON_STARTUP].notify(exec_handle, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_shutdown(ExecutionContextHandle_t exec_handle) {
  return callUser("onShutdown", [&] {
    m_actionListeners.preaction_[PRE_ON_SHUTDOWN].notify(exec_handle);
    const ReturnCode_t code = onShutdown(exec_handle);
    m_actionListeners.postaction_[POST_ON_SHUTDOWN].notify(exec_handle, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_activated(ExecutionContextHandle_t exec_handle) {
  return callUser("onActivated", [&] {
    m_actionListeners.preaction_[PRE_ON_ACTIVATED].notify(exec_handle);
    m_configsets.update();
    const ReturnCode_t code = onActivated(exec_handle);
    activatePorts(exec_handle);
    m_actionListeners.postaction_[POST_ON_ACTIVATED].notify(exec_handle, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_deactivated(ExecutionContextHandle_t exec_handle) {
  return callUser("onDeactivated", [&] {
    m_actionListeners.preaction_[PRE_ON_DEACTIVATED].notify(exec_handle);
    deactivatePorts(exec_handle);
    const ReturnCode_t code = onDeactivated(exec_handle);
    m_actionListeners.postaction_[POST_ON_DEACTIVATED].notify(exec_handle, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_aborting(ExecutionContextHandle_t exec_handle) {
  return callUser("onAborting", [&] {
    m_actionListeners.preaction_[PRE_ON_ABORTING].notify(exec_handle);
    const ReturnCode_t code = onAborting(exec_handle);
    m_actionListeners.postaction_[POST_ON_ABORTING].notify(exec_handle, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_error(ExecutionContextHandle_t exec_handle) {
  return callUser("onError", [&] {
    m_actionListeners.preaction_[PRE_ON_ERROR].notify(exec_handle);
    const ReturnCode_t code = onError(exec_handle);
    m_configsets.update();
    m_actionListeners.postaction_[POST_ON_ERROR].notify(exec_handle, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_reset(ExecutionContextHandle_t exec_handle) {
  return callUser("onReset", [&] {
    m_actionListeners.preaction_[PRE_ON_RESET].notify(exec_handle);
    const ReturnCode_t code = onReset(exec_handle);
    m_actionListeners.postaction_[POST_ON_RESET].notify(exec_handle, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_execute(ExecutionContextHandle_t exec_handle) {
  return callUser("onExecute", [&] {
    if (base::tick_in_lock_step()) m_configsets.update();  // at the edge that all ticks of one time have in common
    m_actionListeners.preaction_[PRE_ON_EXECUTE].notify(exec_handle);
    bool reads = false, writes = false;
    {
      auto data = impl_->shared.lock();
      reads = data->reads_all;
      writes = data->writes_all;
    }
    if (reads) readAll();
    const ReturnCode_t code = impl_->faults && impl_->faults->strike() ? RTC_ERROR : onExecute(exec_handle);
    if (writes) writeAll();
    m_actionListeners.postaction_[POST_ON_EXECUTE].notify(exec_handle, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_state_update(ExecutionContextHandle_t exec_handle) {
  return callUser("onStateUpdate", [&] {
    m_actionListeners.preaction_[PRE_ON_STATE_UPDATE].notify(exec_handle);
    const ReturnCode_t code = onStateUpdate(exec_handle);
    if (!base::tick_in_lock_step()) m_configsets.update();
    m_actionListeners.postaction_[POST_ON_STATE_UPDATE].notify(exec_handle, code);
    return code;
  });
}

ReturnCode_t RTObject_impl::on_rate_changed(ExecutionContextHandle_t exec_handle) {
  return callUser("onRateChanged", [&] {
    m_actionListeners.preaction_[PRE_ON_RATE_CHANGED].notify(exec_handle);
    const ReturnCode_t code = onRateChanged(exec_handle);
    m_actionListeners.postaction_[POST_ON_RATE_CHANGED].notify(exec_handle, code);
    return code;
  });
}

std::vector<RTObject_impl::RunningCallback> RTObject_impl::runningCallbacks() const {
  std::vector<RunningCallback> others = impl_->running.snapshot();
  std::erase_if(others, [](const RunningCallback& one) { return one.thread == std::this_thread::get_id(); });
  return others;
}

bool RTObject_impl::isHeldByCallback() const { return !runningCallbacks().empty(); }

bool RTObject_impl::waitForCallbacks(std::chrono::steady_clock::time_point deadline) {
  const auto is_other = [](const RunningCallback& one) { return one.thread != std::this_thread::get_id(); };
  auto running = impl_->running.lock();
  running.wait_until(impl_->callback_ended, deadline, [&] {
    return std::none_of(running->begin(), running->end(), [&](const auto& one) { return is_other(one) && !one.is_written_off; });
  });
  bool has_others = false;
  for (RunningCallback& one : *running) {
    if (!is_other(one)) continue;
    one.is_written_off = true;
    has_others = true;
  }
  return !has_others;
}

void RTObject_impl::complainAboutCallbacks(const char* consequence) const {
  for (const RunningCallback& one : runningCallbacks())
    RTC_ERROR(
        ("%s has not returned for %s: %s", one.callback, in_seconds(std::chrono::steady_clock::now() - one.since).c_str(), consequence));
}

}  // namespace RTC
