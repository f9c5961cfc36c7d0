#include "sim_time_proxy.h"

#include <base/clock.h>
#include <base/text.h>

#include <algorithm>
#include <utility>

#include "served_objects.h"

namespace {

constexpr std::chrono::seconds start_limit{60};   // of who makes the proxy and then lets somebody join
constexpr std::chrono::seconds longest_pause{2};  // between two looks at who is served
constexpr std::chrono::seconds long_time{1};      // for a tick
constexpr std::chrono::milliseconds look_period = std::chrono::milliseconds(long_time) / 4;

}  // namespace

// clang-format off
static const char* const simtimeproxy_spec[] = {
    "implementation_id", "SimTimeProxy",
    "type_name", "SimTimeProxy",
    "description", "Participates in simulated time for a component of another process",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "simulation",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "conf.default.ticks", "",
    ""};
// clang-format on

RTC::ReturnCode_t SimTimeProxy::onInitialize() {
  bindParameter("ticks", ticks_, "");
  const std::string limit = getProperties().getProperty("sim_time_proxy.alone_limit");
  if (limit.empty()) return RTC::RTC_OK;
  const auto seconds = base::parse_number(limit);
  if (!seconds || !(*seconds > 0) || *seconds > 1e6) {
    RTC_ERROR(("sim_time_proxy.alone_limit must be a number of seconds above 0 and at most 1e6, got %s", base::in_quotes(limit).c_str()));
    return RTC::RTC_ERROR;
  }
  alone_limit_ = std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(*seconds));
  timeout_ = std::max<std::chrono::nanoseconds>(*alone_limit_, start_limit);
  served_at_ = Clock::now();
  watch_ = std::thread([this] { watch(); });
  return RTC::RTC_OK;
}

SimTimeProxy::~SimTimeProxy() {
  watched_.lock()->is_ending = true;
  ending_.notify_all();
  if (watch_.joinable()) watch_.join();
}

void SimTimeProxy::watch() {
  for (;;) {
    bool is_late = false;
    {
      auto watched = watched_.lock();
      if (watched.wait_for(ending_, look_period, [&] { return watched->is_ending; })) return;
      is_late = watched->tick_since && !watched->is_told && Clock::now() - *watched->tick_since >= long_time;
      watched->is_told = watched->is_told || is_late;
    }
    if (is_late)
      RTC_WARN(("the context that is ticked has not returned from tick() for %d s; still waiting", static_cast<int>(long_time.count())));
    if (!alone_limit_ || !is_alone()) continue;
    RTC_INFO(("the component of this proxy was deleted: exiting"));
    exit();
    return;
  }
}

// References of those who have joined, whether they are still there or not.
std::vector<std::string> SimTimeProxy::joined() {
  std::vector<std::string> all;
  const RTC::ExecutionContext_var context = get_context(0);
  if (!CORBA::is_nil(context)) all = iface::members_of(RTC::Manager::instance().getORB(), context);
  if (auto ticked = watched_.lock()->ticked; !ticked.empty()) all.push_back(std::move(ticked));
  return all;
}

// For longer than it may be.
bool SimTimeProxy::is_alone() {
  const auto now = Clock::now();
  if (now < next_look_) return false;
  next_look_ = now + std::min<std::chrono::nanoseconds>(*alone_limit_ / 4, longest_pause);
  const auto all = joined();
  if (!all.empty()) timeout_ = *alone_limit_;
  CORBA::ORB_ptr orb = RTC::Manager::instance().getORB();  // borrowed
  if (std::ranges::all_of(all, [&](const std::string& reference) { return iface::is_gone(orb, reference); }))
    return now - served_at_ > timeout_;
  served_at_ = now;
  return false;
}

RTC::ReturnCode_t SimTimeProxy::onActivated(RTC::UniqueId) {
  ticked_.reset();
  said_.clear();
  if (ticks_.empty()) return RTC::RTC_OK;
  auto found = iface::TickedContext::resolve(RTC::Manager::instance().getORB(), ticks_);
  if (!found) {
    RTC_ERROR(("%s", found.error().message.c_str()));
    return RTC::RTC_ERROR;
  }
  ticked_ = std::move(*found);
  watched_.lock()->ticked = ticks_;
  if (!watch_.joinable()) watch_ = std::thread([this] { watch(); });
  return RTC::RTC_OK;
}

RTC::ReturnCode_t SimTimeProxy::onDeactivated(RTC::UniqueId) {
  ticked_.reset();
  return RTC::RTC_OK;
}

iface::TickedContext::Answer SimTimeProxy::tick(std::string& why) {
  {
    auto watched = watched_.lock();
    watched->tick_since = Clock::now();
    watched->is_told = false;
  }
  const auto answer = ticked_->tick(base::current_clock().now(), why);
  watched_.lock()->tick_since.reset();
  return answer;
}

RTC::ReturnCode_t SimTimeProxy::onExecute(RTC::UniqueId) {
  if (!ticked_) return RTC::RTC_OK;
  std::string why;
  switch (tick(why)) {
    case iface::TickedContext::Answer::done:
      return RTC::RTC_OK;
    case iface::TickedContext::Answer::threw:
      if (std::exchange(said_, why) != why) RTC_WARN(("the context that is ticked throws: %s; it is still ticked", why.c_str()));
      return RTC::RTC_OK;
    case iface::TickedContext::Answer::gone:
      break;
  }
  // rtse run looks for this line.
  RTC_ERROR(("%s: the context that was ticked was lost at %s s (%s)", getProperties().getProperty("exec_cxt.sim_time.participant").c_str(),
             base::format_number(base::to_seconds(base::current_clock().now())).c_str(), why.c_str()));
  ticked_.reset();
  return RTC::RTC_ERROR;
}

extern "C" {
void SimTimeProxyInit(RTC::Manager* manager) {
  coil::Properties profile(simtimeproxy_spec);
  manager->registerFactory(profile, RTC::Create<SimTimeProxy>, RTC::Delete<SimTimeProxy>);
}
}
