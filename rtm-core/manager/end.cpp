// The end of the manager: who asks for it, what it does, and how long it may last. The life thread does the work; a watch looks at its
// clock.
//
// With T = exec_cxt.callback_timeout, at most 2 s after a signal (containers are killed 10 s after it): callbacks that run in execution
// contexts are waited for until T after the end has begun, all together (and one second more where it takes that to find all that hang). A
// callback that the end itself calls (onFinalize, onShutdown) may last T. So a process with components that hang is gone after 2 T + 2 s at
// most, however many there are; it says which they are, takes its names out of the naming service, answers the calls it is in (1 s) and
// ends with _Exit. Any other step that gets nowhere for 30 s ends it, too. A callback that calls exit() ends the process at once with that
// exit code: names are removed, and the other components get no further callback.
#include <pthread.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "base/log.h"
#include "base/text.h"
#include "manager/manager_impl.h"
#include "rtm/LocalServiceAdmin.h"
#include "rtm/LogstreamBase.h"
#include "rtm/ManagerServant.h"
#include "rtm/ModuleManager.h"
#include "rtm/NamingManager.h"

namespace RTC {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr auto longest_step = 30s;
constexpr auto grace = 1s;
constexpr auto longest_in_a_hurry = 2s;
constexpr const char* after_naming = "what the manager owns";
constexpr const char* in_orb = "calls from other processes";

std::string in_seconds(std::chrono::nanoseconds time) {
  return base::format_number(static_cast<double>(std::chrono::duration_cast<std::chrono::milliseconds>(time).count()) / 1000.0) + " s";
}

}  // namespace

// While it lives somebody looks whether the end goes on.
class ManagerImpl::EndWatch {
 public:
  explicit EndWatch(ManagerImpl& manager) : manager_(manager), ender_(std::this_thread::get_id()), thread_([this] { watch(); }) {}
  ~EndWatch() {
    manager_.begin_step("");
    thread_.join();
  }
  EndWatch(const EndWatch&) = delete;
  EndWatch& operator=(const EndWatch&) = delete;

 private:
  // A callback that the end itself calls has lasted too long.
  bool is_caught(std::chrono::nanoseconds timeout) const {
    for (const auto& component : manager_.all_components())
      for (const auto& one : component->callbacks())
        if (one.thread == ender_ && steady_clock::now() - one.since >= timeout) return true;
    return false;
  }

  void watch() {
    const auto timeout = std::max<std::chrono::nanoseconds>(manager_.callback_timeout(), 1ms);
    auto look_at = steady_clock::time_point{};
    for (;;) {
      std::string step;
      steady_clock::time_point since;
      {
        auto locked = manager_.state.lock();
        since = locked->step_since;
        look_at = std::max(look_at, since + timeout);
        const auto has_moved = [&] { return locked->step.empty() || locked->step_since != since; };
        const bool moved = locked.wait_until(manager_.changed, look_at, has_moved);
        if (locked->step.empty()) return;
        if (moved) continue;
        step = locked->step;
      }
      if (is_caught(timeout) || steady_clock::now() - since >= longest_step) manager_.give_up(step);
      look_at = steady_clock::now() + std::min<std::chrono::nanoseconds>(timeout / 4, 1s);
    }
  }

  ManagerImpl& manager_;
  const std::thread::id ender_;
  std::thread thread_;
};

std::chrono::nanoseconds ManagerImpl::callback_timeout() const {
  const double seconds = std::clamp(number("exec_cxt.callback_timeout", 5.0), 0.0, 1e6);
  const std::chrono::nanoseconds timeout(static_cast<std::int64_t>(seconds * 1e9));
  return state.lock()->is_hurried ? std::min<std::chrono::nanoseconds>(timeout, longest_in_a_hurry) : timeout;
}

void ManagerImpl::begin_step(std::string step) {
  {
    auto locked = state.lock();
    locked->step = std::move(step);
    locked->step_since = steady_clock::now();
  }
  changed.notify_all();
}

std::vector<ManagerImpl::Held> ManagerImpl::all_components() const {
  std::vector<Held> components;
  const auto keep = [&](RTObject_impl* component) {
    if (auto held = manage(component)) components.push_back(std::move(held));
  };
  const auto locked = state.lock();
  for (const auto& [id, record] : locked->records) keep(record.component);
  for (const auto& record : locked->abandoned) keep(record.component);
  return components;
}

bool ManagerImpl::is_callback_running(std::chrono::nanoseconds at_least) const {
  for (const auto& component : all_components())
    for (const auto& one : component->callbacks())
      if (steady_clock::now() - one.since >= at_least) return true;
  return false;
}

void ManagerImpl::complain_about_callbacks() const {
  for (const auto& component : all_components())
    for (const auto& one : component->callbacks())
      RTC_ERROR(("%s: %s has not returned for %s", component->instance_name().c_str(), one.name,
                 in_seconds(steady_clock::now() - one.since).c_str()));
}

// Before the process ends without shutting the ORB down.
void ManagerImpl::remove_files() const {
  std::error_code ignored;
  if (!socket_folder.empty()) std::filesystem::remove_all(socket_folder, ignored);
}

// Somebody may have called us to get here.
void ManagerImpl::answer_last_calls() {
  auto done = std::make_shared<std::promise<void>>();
  const auto is_done = done->get_future();
  try {
    std::thread([done, orb = CORBA::ORB::_duplicate(orb->orb())] {
      try {
        orb->shutdown(true);
      } catch (const CORBA::Exception&) {
        base::log(base::Level::debug, "manager", "the ORB is down already");
      }
      done->set_value();
    }).detach();
  } catch (const std::system_error&) {  // no thread: they get no answer
    return;
  }
  is_done.wait_for(grace);
}

// A thread that reads has its stream for as long as it waits, and whoever flushes all streams waits for it.
void ManagerImpl::flush_streams() {
  auto done = std::make_shared<std::promise<void>>();
  const auto is_done = done->get_future();
  try {
    std::thread([done] {
      std::fflush(nullptr);
      done->set_value();
    }).detach();
  } catch (const std::system_error&) {  // no thread: what is not written yet is lost
    return;
  }
  is_done.wait_for(grace);
}

// Anything more would be taken away under the hands of whoever does not return.
void ManagerImpl::give_up(const std::string& step) {
  complain_about_callbacks();
  const bool has_names = step != after_naming && step != "naming" && step != in_orb;
  if (has_names && naming) naming->unbindAll();
  RTC_ERROR(("the process ends as it is; it got as far as: %s", step.c_str()));
  if (step != after_naming && step != in_orb) answer_last_calls();
  remove_files();
  flush_streams();
  std::_Exit(EXIT_FAILURE);
}

// The thread that has called exit() in a callback never returns from it, so there is nothing to wait for.
void ManagerImpl::end_in_callback(int status) {
  if (naming) naming->unbindAll();
  remove_files();
  flush_streams();
  std::_Exit(status);
}

// Waits for the request and does the work of ending: on a thread of its own because anybody may ask, also a component or the ORB.
void ManagerImpl::live() {
  pthread_setname_np(pthread_self(), "rtm-life");
  for (bool ready = false; !ready;) {
    auto locked = state.lock();
    ready = locked.wait_for(changed, std::chrono::hours(1), [&] { return locked->end_requested; });
  }
  // Nothing is taken away under the hands of activate, unless it makes a component that does not return.
  const auto is_activated = [&](std::chrono::nanoseconds timeout) {
    auto locked = state.lock();
    return locked.wait_for(changed, timeout, [&] { return !locked->activating; });
  };
  const auto timeout = std::max<std::chrono::nanoseconds>(callback_timeout(), 10ms);
  while (!is_activated(timeout))
    if (is_callback_running(timeout)) give_up("activation");
  try {
    end();
  } catch (const std::exception& e) {
    RTC_ERROR(("ending failed: %s", e.what()));
  } catch (...) {
    RTC_ERROR(("ending failed with an unknown exception"));
  }
  auto locked = state.lock();
  locked->phase = Phase::ended;
  locked->life_is_over = true;
  changed.notify_all();
}

void ManagerImpl::exit_all_components() {
  const auto deadline = steady_clock::now() + callback_timeout();
  auto all = records();
  std::erase_if(all, [](const Record& record) { return !record.listed || record.finalized; });
  std::vector<Held> components;
  for (const auto& component : all_components())
    if (std::any_of(all.begin(), all.end(), [&](const Record& record) { return record.component == component->object(); }))
      components.push_back(component);
  std::reverse(components.begin(), components.end());
  bool is_late = false;
  for (std::size_t i = 0; i < components.size(); ++i) {
    begin_step(components[i]->instance_name());
    if (!is_late && steady_clock::now() >= deadline) {
      // Somebody hangs. The others get one moment together, after which it is known who else does and need not be waited for.
      is_late = true;
      const auto until = steady_clock::now() + grace;
      for (std::size_t k = i; k < components.size(); ++k) components[k]->ask_to_rest();
      for (std::size_t k = i; k < components.size(); ++k) components[k]->come_to_rest(until);
    }
    try {
      components[i]->exit_by(is_late ? steady_clock::now() + grace : deadline);
    } catch (...) {
      RTC_ERROR(("%s: exit failed with an exception", components[i]->instance_name().c_str()));
    }
  }
  components.clear();
  begin_step("deletion of components");
  std::reverse(all.begin(), all.end());
  for (const auto& record : all) cleaner->post([this, id = record.id] { destroy(id); });
  cleaner->drain();
}

void ManagerImpl::end() {
  begin_step("listeners");
  const EndWatch watch(*this);
  listeners.manager_.call(&RTM::ManagerActionListener::preShutdown);
  state.lock()->phase = Phase::ending;
  begin_step("other managers");
  if (peers) peers->stop();
  if (servant != nullptr) servant->leave_masters();
  exit_all_components();
  begin_step("naming");
  naming->unbindAll();
  for (const auto& component : all_components()) component->come_to_rest(steady_clock::now() + grace);  // also those that are being made
  delete_abandoned();
  if (is_callback_running(0s) || !destroy_left_contexts()) give_up("naming");
  begin_step(after_naming);
  RTM::LocalServiceAdmin::instance().finalize();
  if (servant != nullptr) servant->deactivate();
  timer->stop();
  cleaner->drain();
  cleaner->stop();
  naming.reset();
  {
    // A policy that does not return stays in memory.
    const auto mine = numbering_turn.take(grace);
    if (mine) RTM::NumberingPolicyFactory::instance().deleteObject(numbering);
  }
  begin_step(in_orb);
  orb.reset();
  facade.m_mgrservant = nullptr;
  if (servant != nullptr) servant->_remove_ref();
  servant = nullptr;
  begin_step(after_naming);
  listeners.manager_.call(&RTM::ManagerActionListener::postShutdown);
  for (auto* plugin : log_plugins) {
    if (plugin->getStreamBuffer() != nullptr) removeLogStreamBuffer(plugin->getStreamBuffer());
    plugin->shutdown();
    LogstreamFactory::instance().deleteObject(plugin);
  }
  log_plugins.clear();
}

}  // namespace RTC
