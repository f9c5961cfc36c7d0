#include "rtm/ExecutionContextBase.h"

#include <coil/stringutil.h>
#include <rtm/NVUtil.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "base/clock.h"
#include "base/text.h"
#include "component/context_clock.h"
#include "component/context_impl.h"
#include "component/runtime_access.h"
#include "corba/orb/call_context.h"
#include "corba/orb/orb.h"
#include "corba/orb/return_code.h"

namespace RTC {

namespace {

using namespace std::chrono_literals;

const base::SystemClock& system_clock() {
  static const base::SystemClock clock;
  return clock;
}

std::string seconds(std::chrono::nanoseconds time) { return base::format_number(std::chrono::duration<double>(time).count()); }

}  // namespace

ExecutionContextBase::ExecutionContextBase(const std::string& name)
    : rtclog(name.empty() ? "ec_base" : name), impl_(std::make_unique<Impl>(name.empty() ? "execution context" : name)) {
  impl_->context.on_wake([this] { onWakeUp(); });
}

ExecutionContextBase::~ExecutionContextBase() = default;

void ExecutionContextBase::init(coil::Properties& props) {
  if (const std::string rate = props.getProperty("rate"); !rate.empty()) {
    const auto number = base::parse_number(rate);
    // 0: as fast as possible.
    if (!number || setRate(*number == 0 ? rt::ExecutionContext::max_rate : *number) != RTC::RTC_OK)
      RTC_WARN(("rate must be a positive number of Hz, or 0 for as fast as possible, got %s", base::in_quotes(rate).c_str()));
  }
  const auto read_seconds = [&](const char* key, std::chrono::nanoseconds otherwise) {
    const std::string text = props.getProperty(key);
    if (text.empty()) return otherwise;
    const auto number = base::parse_number(text);
    if (number && *number >= 0 && *number < 1e6) return std::chrono::nanoseconds(static_cast<std::int64_t>(*number * 1e9));
    RTC_WARN(("%s must be a number of seconds, got %s", key, base::in_quotes(text).c_str()));
    return otherwise;
  };
  struct Wait {
    bool wait = true;
    std::chrono::nanoseconds timeout = Impl::default_timeout;
  };
  const auto read = [&](const char* sync, const char* timeout, const Wait& fallback) {
    Wait chosen = fallback;
    if (const std::string text = props.getProperty(sync); !text.empty()) chosen.wait = coil::toBool(text, "YES", "NO", chosen.wait);
    chosen.timeout = read_seconds(timeout, chosen.timeout);
    return chosen;
  };
  const Wait any = read("sync_transition", "transition_timeout", Wait{});
  const Wait activation = read("sync_activation", "activation_timeout", any);
  const Wait deactivation = read("sync_deactivation", "deactivation_timeout", any);
  const Wait reset = read("sync_reset", "reset_timeout", any);
  const auto callback_timeout = read_seconds("callback_timeout", default_callback_timeout);
  impl_->member_timeout->set(read_seconds("member_timeout", corba::MemberTimeout::usual));
  m_syncActivation = activation.wait;
  m_syncDeactivation = deactivation.wait;
  m_syncReset = reset.wait;
  auto data = impl_->shared.lock();
  data->callback_timeout = callback_timeout;
  data->properties = props;
  data->activation = activation.timeout;
  data->deactivation = deactivation.timeout;
  data->reset = reset.timeout;
}

CORBA::Boolean ExecutionContextBase::isRunning() const { return impl_->context.is_running() && !impl_->context.is_halted(); }

// Only one of start and stop at a time: what the hooks do (threads) must not be undone meanwhile.
class ExecutionContextBase::Changing {
 public:
  explicit Changing(Impl& impl) : impl_(impl), is_first_(!std::exchange(impl.shared.lock()->is_changing, true)) {}
  ~Changing() {
    if (is_first_) impl_.shared.lock()->is_changing = false;
  }
  Changing(const Changing&) = delete;
  Changing& operator=(const Changing&) = delete;
  explicit operator bool() const { return is_first_; }

 private:
  Impl& impl_;
  const bool is_first_;
};

RTC::ReturnCode_t ExecutionContextBase::start() {
  const Changing turn(*impl_);
  if (!turn || isRunning()) return RTC::PRECONDITION_NOT_MET;
  if (const auto code = onStarting(); code != RTC::RTC_OK) return code;
  const base::ScopedClock clock(impl_->clock());
  if (const auto code = impl_->context.start(); code != rt::ReturnCode::ok) return corba::to_wire(code);
  try {
    return onStarted();
  } catch (const std::exception& exception) {  // above all: the system gives no further thread
    RTC_ERROR(("the context does not start: %s", exception.what()));
  } catch (...) {
    RTC_ERROR(("the context does not start: an unknown exception"));
  }
  impl_->context.stop(callbackTimeLeft());
  return RTC::RTC_ERROR;
}

RTC::ReturnCode_t ExecutionContextBase::stop() {
  const Changing turn(*impl_);
  if (!turn || !isRunning()) return RTC::PRECONDITION_NOT_MET;
  // A callback that begins while the hook waits for the thread might never return.
  impl_->context.halt();
  if (const auto code = onStopping(); code != RTC::RTC_OK) {
    impl_->context.resume();
    return code;
  }
  const base::ScopedClock clock(impl_->clock());
  if (const auto code = impl_->context.stop(callbackTimeLeft()); code != rt::ReturnCode::ok) {
    complainAboutCallback("the context cannot stop");
    return corba::to_wire(code);
  }
  return onStopped();
}

RTC::ReturnCode_t ExecutionContextBase::stopBy(std::chrono::steady_clock::time_point deadline) {
  impl_->shared.lock()->stop_by = deadline;
  const RTC::ReturnCode_t code = stop();
  impl_->shared.lock()->stop_by.reset();
  return code;
}

void ExecutionContextBase::setMemberTimeout(std::chrono::nanoseconds timeout) { impl_->member_timeout->set(timeout); }

std::chrono::nanoseconds ExecutionContextBase::callbackTimeout() const { return impl_->shared.lock()->callback_timeout; }

std::chrono::nanoseconds ExecutionContextBase::callbackTimeLeft() const {
  auto data = impl_->shared.lock();
  if (!data->stop_by) return data->callback_timeout;
  return std::max<std::chrono::nanoseconds>(*data->stop_by - std::chrono::steady_clock::now(), 0ns);
}

bool ExecutionContextBase::waitForQuiet(std::chrono::nanoseconds timeout) { return impl_->context.wait_until_quiet(timeout); }

bool ExecutionContextBase::waitForCallbacks() {
  if (waitForQuiet(callbackTimeLeft())) return true;
  complainAboutCallback("the context cannot stop");
  return false;
}

void ExecutionContextBase::complainAboutCallback(const char* consequence) {
  impl_->context.write_off_call();
  const std::string call = impl_->context.stuck_call().value_or("a component in a callback");
  RTC_ERROR(("%s, and does not return: %s", call.c_str(), consequence));
}

CORBA::Double ExecutionContextBase::getRate() const { return onGetRate(impl_->context.rate()); }

std::chrono::nanoseconds ExecutionContextBase::getPeriod() const { return impl_->context.period(); }

RTC::ReturnCode_t ExecutionContextBase::setRate(CORBA::Double rate) {
  const double wanted = onSettingRate(rate);
  if (const auto code = impl_->context.set_rate(wanted); code != rt::ReturnCode::ok) return corba::to_wire(code);
  return onSetRate(wanted);
}

const char* ExecutionContextBase::getStateString(RTC::LifeCycleState state) {
  switch (state) {
    case RTC::CREATED_STATE:
      return "CREATED_STATE";
    case RTC::INACTIVE_STATE:
      return "INACTIVE_STATE";
    case RTC::ACTIVE_STATE:
      return "ACTIVE_STATE";
    case RTC::ERROR_STATE:
      return "ERROR_STATE";
  }
  return "";
}

bool ExecutionContextBase::isAllCurrentState(RTC::LifeCycleState state) const {
  const auto members = impl_->context.members();
  return std::all_of(members.begin(), members.end(), [&](const auto& member) { return static_cast<int>(member.state) == state; });
}

bool ExecutionContextBase::isAllNextState(RTC::LifeCycleState state) const {
  const auto members = impl_->context.members();
  return std::all_of(members.begin(), members.end(), [&](const auto& member) { return static_cast<int>(member.next) == state; });
}

bool ExecutionContextBase::isOneOfCurrentState(RTC::LifeCycleState state) const {
  const auto members = impl_->context.members();
  return std::any_of(members.begin(), members.end(), [&](const auto& member) { return static_cast<int>(member.state) == state; });
}

bool ExecutionContextBase::isOneOfNextState(RTC::LifeCycleState state) const {
  const auto members = impl_->context.members();
  return std::any_of(members.begin(), members.end(), [&](const auto& member) { return static_cast<int>(member.next) == state; });
}

RTC::ExecutionKind ExecutionContextBase::getKind() const {
  const RTC::ExecutionKind kind = impl_->shared.lock()->kind;
  return onGetKind(kind);
}

const char* ExecutionContextBase::getKindString() const { return getKindString(getKind()); }

const char* ExecutionContextBase::getKindString(RTC::ExecutionKind kind) {
  switch (kind) {
    case RTC::PERIODIC:
      return "PERIODIC";
    case RTC::EVENT_DRIVEN:
      return "EVENT_DRIVEN";
    case RTC::OTHER:
      return "OTHER";
  }
  return "";
}

RTC::ExecutionContextProfile* ExecutionContextBase::getProfile() {
  RTC::ExecutionContextProfile_var profile = new RTC::ExecutionContextProfile();
  profile->kind = getKind();
  profile->rate = getRate();
  coil::Properties properties;
  {
    auto data = impl_->shared.lock();
    properties = data->properties;
    profile->owner = RTC::RTObject::_duplicate(data->owner);
  }
  for (const Impl::Member& member : impl_->members()) {
    if (member.owner) continue;
    const CORBA::ULong n = profile->participants.length();
    profile->participants.length(n + 1);
    profile->participants[n] = RTC::RTObject::_unchecked_narrow(member.reference);
  }
  const rt::ContextStatistics statistics = impl_->context.statistics();
  properties["rate"] = base::format_number(profile->rate);
  properties["statistics.cycles"] = std::to_string(statistics.cycles);
  properties["statistics.missed_cycles"] = std::to_string(statistics.missed_cycles);
  properties["statistics.mean_execution_time"] = seconds(statistics.mean_execution());
  properties["statistics.max_execution_time"] = seconds(statistics.max_execution);
  properties["statistics.mean_waiting_time"] = seconds(statistics.mean_waiting());
  NVUtil::copyFromProperties(profile->properties, properties);
  RTC::ExecutionContextProfile* answer = profile._retn();
  return onGetProfile(answer);
}

void ExecutionContextBase::setObjRef(RTC::ExecutionContextService_ptr ref) {
  impl_->shared.lock()->reference = RTC::ExecutionContextService::_duplicate(ref);
}

RTC::ExecutionContextService_ptr ExecutionContextBase::getObjRef() const {
  return RTC::ExecutionContextService::_duplicate(impl_->shared.lock()->reference);
}

RTC::ReturnCode_t ExecutionContextBase::setKind(RTC::ExecutionKind kind) {
  if (kind != RTC::PERIODIC && kind != RTC::EVENT_DRIVEN && kind != RTC::OTHER) return RTC::BAD_PARAMETER;
  impl_->shared.lock()->kind = kind;
  return RTC::RTC_OK;
}

RTC::RTObject_ptr ExecutionContextBase::getOwner() const { return RTC::RTObject::_duplicate(impl_->shared.lock()->owner); }

RTC::ReturnCode_t ExecutionContextBase::setOwner(RTC::LightweightRTObject_ptr comp) {
  if (CORBA::is_nil(comp)) return RTC::BAD_PARAMETER;
  RTC::RTObject_var owner;
  try {
    owner = RTC::RTObject::_narrow(comp);
  } catch (const CORBA::Exception& exception) {
    RTC_ERROR(("the new owner does not answer: %s", corba::to_text(exception).c_str()));
  }
  if (CORBA::is_nil(owner)) return RTC::BAD_PARAMETER;
  impl_->shared.lock()->owner = owner;
  return RTC::RTC_OK;
}

void ExecutionContextBase::setProperties(const coil::Properties& props) { impl_->shared.lock()->properties << props; }
coil::Properties ExecutionContextBase::getProperties() const { return impl_->shared.lock()->properties; }
std::string ExecutionContextBase::getName() const { return getProperties().getProperty("name"); }
std::string ExecutionContextBase::getTypeName() const { return getProperties().getProperty("type"); }

void set_clock(ExecutionContextBase& context, std::shared_ptr<const base::Clock> of_ticks, std::shared_ptr<const base::Clock> of_others) {
  RuntimeAccess::impl(context).clocks = {std::move(of_ticks), std::move(of_others)};
}

// Inside a tick that a context of another process gives, its time.
const base::Clock& ExecutionContextBase::Impl::clock() const {
  if (clocks.of_ticks) return *clocks.of_ticks;
  const auto* of_caller = corba::clock_of_caller();
  return of_caller ? *of_caller : system_clock();
}

void ExecutionContextBase::invokeWorker() {
  const base::ScopedClock clock(impl_->clock());
  impl_->context.step();
}

void ExecutionContextBase::invokeWorkerPreDo(std::size_t lane) {
  const base::ScopedClock clock(impl_->clock());
  impl_->context.transit(lane);
}

void ExecutionContextBase::invokeWorkerDo(std::size_t lane) {
  const base::ScopedClock clock(impl_->clock());
  impl_->context.execute(lane);
}

void ExecutionContextBase::invokeWorkerPostDo(std::size_t lane) {
  const base::ScopedClock clock(impl_->clock());
  impl_->context.update(lane);
}

void ExecutionContextBase::countMissedCycles(std::uint64_t cycles) { impl_->context.count_missed(cycles); }

bool ExecutionContextBase::isSteppingThread() const { return impl_->context.is_stepping_thread(); }

}  // namespace RTC
