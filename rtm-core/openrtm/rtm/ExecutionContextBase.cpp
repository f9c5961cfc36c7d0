#include <coil/stringutil.h>
#include <rtm/ExecutionContextBase.h>
#include <rtm/LocalComponent.h>
#include <rtm/NVUtil.h>
#include <rtm/RTObject.h>

#include <algorithm>
#include <optional>

#include "base/clock.h"
#include "base/guarded.h"
#include "base/text.h"
#include "corba/orb.h"
#include "corba/remote_participant.h"
#include "corba/return_code.h"

namespace RTC {

namespace {

using namespace std::chrono_literals;

class LocalParticipant final : public rt::Participant {
 public:
  LocalParticipant(std::shared_ptr<RTObject_impl> component, ExecutionContextHandle_t handle)
      : component_(std::move(component)), handle_(handle) {}

  std::string name() const override { return component_->getInstanceName(); }
  rt::ReturnCode call(rt::Action action) override { return corba::from_wire(forward(action)); }

 private:
  ReturnCode_t forward(rt::Action action) {
    switch (action) {
      case rt::Action::startup:
        return component_->on_startup(handle_);
      case rt::Action::shutdown:
        return component_->on_shutdown(handle_);
      case rt::Action::activated:
        return component_->on_activated(handle_);
      case rt::Action::deactivated:
        return component_->on_deactivated(handle_);
      case rt::Action::aborting:
        return component_->on_aborting(handle_);
      case rt::Action::error:
        return component_->on_error(handle_);
      case rt::Action::reset:
        return component_->on_reset(handle_);
      case rt::Action::execute:
        return component_->on_execute(handle_);
      case rt::Action::state_update:
        return component_->on_state_update(handle_);
      case rt::Action::rate_changed:
        return component_->on_rate_changed(handle_);
    }
    return RTC::RTC_ERROR;
  }

  const std::shared_ptr<RTObject_impl> component_;
  const ExecutionContextHandle_t handle_;
};

struct Member {
  RTC::LightweightRTObject_var reference;
  RTObject_impl* local = nullptr;  // for comparing only
  rt::MemberId id = 0;
  ExecutionContextHandle_t handle = 0;
  bool owner = false;
};

// Whether callers wait for a transition, and how long.
struct Patience {
  bool wait = true;
  std::chrono::nanoseconds timeout = 500ms;
};

const base::SystemClock& system_clock() {
  static const base::SystemClock clock;
  return clock;
}

std::string seconds(std::chrono::nanoseconds time) { return base::format_number(std::chrono::duration<double>(time).count()); }

}  // namespace

struct ExecutionContextBase::Impl {
  struct Data {
    std::vector<Member> members{};
    std::vector<RTC::LightweightRTObject_var> joining{};  // asked to attach, no members yet
    RTC::ExecutionContextService_var reference{};
    RTC::RTObject_var owner{};
    RTC::ExecutionKind kind = RTC::PERIODIC;
    coil::Properties properties{};
    Patience activation{}, deactivation{}, reset{};
  };

  explicit Impl(const std::string& name) : context(name) {}

  std::optional<Member> find(RTC::LightweightRTObject_ptr component) const {
    if (CORBA::is_nil(component)) return std::nullopt;
    const std::vector<Member> members = snapshot();
    for (const Member& member : members)
      if (member.reference->_is_equivalent(component)) return member;
    // The same component under another key (corbaloc).
    if (const auto local = findLocalComponent(component))
      for (const Member& member : members)
        if (member.local == local.get()) return member;
    return std::nullopt;
  }

  std::vector<Member> snapshot() const { return shared.lock()->members; }

  rt::ExecutionContext context;
  base::Guarded<Data, base::Rank::component> shared;
};

ExecutionContextBase::ExecutionContextBase(const std::string& name)
    : rtclog(name.empty() ? "ec_base" : name), impl_(std::make_unique<Impl>(name.empty() ? "execution context" : name)) {
  impl_->context.on_wake([this] { onWakeUp(); });
}

ExecutionContextBase::~ExecutionContextBase() = default;

rt::ExecutionContext& ExecutionContextBase::context() { return impl_->context; }
const rt::ExecutionContext& ExecutionContextBase::context() const { return impl_->context; }

void ExecutionContextBase::init(coil::Properties& props) {
  if (const std::string rate = props.getProperty("rate"); !rate.empty()) {
    const auto number = base::parse_number(rate);
    if (!number || setRate(*number) != RTC::RTC_OK)
      RTC_WARN(("rate must be a positive number of Hz, got %s", base::in_quotes(rate).c_str()));
  }
  const auto read = [&](const char* sync, const char* timeout, const Patience& fallback) {
    Patience patience = fallback;
    if (const std::string text = props.getProperty(sync); !text.empty()) patience.wait = coil::toBool(text, "YES", "NO", patience.wait);
    if (const std::string text = props.getProperty(timeout); !text.empty()) {
      const auto number = base::parse_number(text);
      if (number && *number >= 0 && *number < 1e6)
        patience.timeout = std::chrono::nanoseconds(static_cast<std::int64_t>(*number * 1e9));
      else
        RTC_WARN(("%s must be a number of seconds, got %s", timeout, base::in_quotes(text).c_str()));
    }
    return patience;
  };
  const Patience any = read("sync_transition", "transition_timeout", Patience{});
  const Patience activation = read("sync_activation", "activation_timeout", any);
  const Patience deactivation = read("sync_deactivation", "deactivation_timeout", any);
  const Patience reset = read("sync_reset", "reset_timeout", any);
  auto data = impl_->shared.lock();
  data->properties = props;
  data->activation = activation;
  data->deactivation = deactivation;
  data->reset = reset;
}

RTC::ReturnCode_t ExecutionContextBase::bindComponent(RTC::RTObject_impl* rtc) {
  if (rtc == nullptr) return RTC::BAD_PARAMETER;
  RTC::ExecutionContextService_var reference = getObjRef();
  RTC::RTObject_var owner = rtc->getObjRef();
  const ExecutionContextHandle_t handle = rtc->bindContext(reference);
  if (handle < 0) return RTC::RTC_ERROR;
  rtc->_add_ref();
  const std::shared_ptr<RTObject_impl> counted(rtc, [](RTObject_impl* component) { component->_remove_ref(); });
  const rt::MemberId id = impl_->context.add(std::make_shared<LocalParticipant>(counted, handle));
  auto data = impl_->shared.lock();
  data->members.push_back(
      {.reference = RTC::LightweightRTObject::_duplicate(owner), .local = rtc, .id = id, .handle = handle, .owner = true});
  if (CORBA::is_nil(data->owner)) data->owner = owner;
  return RTC::RTC_OK;
}

std::size_t ExecutionContextBase::unbindComponent(RTC::RTObject_impl* rtc) {
  rt::MemberId id = 0;
  std::size_t owners = 0;
  {
    auto data = impl_->shared.lock();
    std::erase_if(data->members, [&](const Member& member) {
      if (member.local != rtc || !member.owner) return false;
      id = member.id;
      return true;
    });
    data->owner = RTC::RTObject::_nil();
    for (const Member& member : data->members)
      if (member.owner && owners++ == 0) data->owner = RTC::RTObject::_unchecked_narrow(member.reference);
  }
  if (id != 0) impl_->context.remove(id, 10s);
  return owners;
}

CORBA::Boolean ExecutionContextBase::isRunning() const { return impl_->context.is_running(); }

RTC::ReturnCode_t ExecutionContextBase::start() {
  if (isRunning()) return RTC::PRECONDITION_NOT_MET;
  if (const auto code = onStarting(); code != RTC::RTC_OK) return code;
  const base::ScopedClock clock(contextClock());
  if (const auto code = impl_->context.start(); code != rt::ReturnCode::ok) return corba::to_wire(code);
  return onStarted();
}

RTC::ReturnCode_t ExecutionContextBase::stop() {
  if (!isRunning()) return RTC::PRECONDITION_NOT_MET;
  if (const auto code = onStopping(); code != RTC::RTC_OK) return code;
  const base::ScopedClock clock(contextClock());
  if (const auto code = impl_->context.stop(); code != rt::ReturnCode::ok) return corba::to_wire(code);
  return onStopped();
}

CORBA::Double ExecutionContextBase::getRate() const { return onGetRate(impl_->context.rate()); }

std::chrono::nanoseconds ExecutionContextBase::getPeriod() const { return impl_->context.period(); }

RTC::ReturnCode_t ExecutionContextBase::setRate(CORBA::Double rate) {
  const double wanted = onSettingRate(rate);
  if (const auto code = impl_->context.set_rate(wanted); code != rt::ReturnCode::ok) return corba::to_wire(code);
  return onSetRate(wanted);
}

// One caller at a time brings a component in: it is no member until it has answered.
class ExecutionContextBase::Joining {
 public:
  Joining(base::Guarded<Impl::Data, base::Rank::component>& shared, RTC::LightweightRTObject_ptr component)
      : shared_(shared), component_(RTC::LightweightRTObject::_duplicate(component)) {
    auto data = shared_.lock();
    for (const auto& other : data->joining)
      if (RTC::LightweightRTObject_var(other)->_is_equivalent(component)) return;
    data->joining.push_back(component_);
    is_first_ = true;
  }
  ~Joining() {
    if (!is_first_) return;
    auto data = shared_.lock();
    const auto it =
        std::find_if(data->joining.begin(), data->joining.end(), [&](const auto& other) { return other.in() == component_.in(); });
    if (it != data->joining.end()) data->joining.erase(it);
  }
  Joining(const Joining&) = delete;
  Joining& operator=(const Joining&) = delete;
  explicit operator bool() const { return is_first_; }

 private:
  base::Guarded<Impl::Data, base::Rank::component>& shared_;
  RTC::LightweightRTObject_var component_;
  bool is_first_ = false;
};

RTC::ReturnCode_t ExecutionContextBase::addComponent(RTC::LightweightRTObject_ptr comp) {
  if (CORBA::is_nil(comp)) return RTC::BAD_PARAMETER;
  const Joining joining(impl_->shared, comp);
  if (!joining || impl_->find(comp)) return RTC::PRECONDITION_NOT_MET;
  if (const auto code = onAddingComponent(comp); code != RTC::RTC_OK) return code;
  RTC::ExecutionContextService_var self = getObjRef();
  Member member;
  std::shared_ptr<rt::Participant> participant;
  try {
    if (const auto local = findLocalComponent(comp)) {
      member.reference = RTC::LightweightRTObject::_duplicate(comp);
      member.local = local.get();
      member.handle = local->attach_context(self);
      participant = std::make_shared<LocalParticipant>(local, member.handle);
    } else {
      member.reference = corba::RemoteParticipant::impatient(comp);
      member.handle = member.reference->attach_context(self);
      if (member.handle >= 0) participant = std::make_shared<corba::RemoteParticipant>(member.reference, member.handle);
    }
  } catch (const CORBA::Exception& exception) {
    RTC_ERROR(("a component that is to join does not answer attach_context: %s", corba::to_text(exception).c_str()));
    return RTC::RTC_ERROR;
  }
  if (member.handle < 0) return RTC::RTC_ERROR;
  member.id = impl_->context.add(std::move(participant));
  impl_->shared.lock()->members.push_back(member);
  return onAddedComponent(comp);
}

RTC::ReturnCode_t ExecutionContextBase::removeComponent(RTC::LightweightRTObject_ptr comp) {
  const auto member = impl_->find(comp);
  if (!member || member->owner) return RTC::BAD_PARAMETER;
  if (const auto code = onRemovingComponent(comp); code != RTC::RTC_OK) return code;
  {
    auto data = impl_->shared.lock();
    if (std::erase_if(data->members, [&](const Member& other) { return other.id == member->id; }) == 0) return RTC::BAD_PARAMETER;
  }
  if (!impl_->context.remove(member->id, 10s)) RTC_WARN(("a component that leaves does not return from its callback"));
  try {
    member->reference->detach_context(member->handle);
  } catch (const CORBA::Exception& exception) {
    RTC_DEBUG(("a component that leaves does not answer detach_context: %s", corba::to_text(exception).c_str()));
  }
  return onRemovedComponent(comp);
}

RTC::ReturnCode_t ExecutionContextBase::activateComponent(RTC::LightweightRTObject_ptr comp) {
  const auto member = impl_->find(comp);
  if (!member) return RTC::BAD_PARAMETER;
  if (const auto code = onActivating(comp); code != RTC::RTC_OK) return code;
  if (const auto code = impl_->context.request(member->id, rt::Event::activate); code != rt::ReturnCode::ok) return corba::to_wire(code);
  const Patience patience = impl_->shared.lock()->activation;
  RTC_impl::RTObjectStateMachine machine(member->reference, member->handle, impl_->context, member->id, member->owner);
  if (!patience.wait) return onActivated(&machine, 0);
  if (impl_->context.is_stepping_thread()) return RTC::RTC_OK;
  if (const auto code = onWaitingActivated(&machine, 0); code != RTC::RTC_OK) return code;
  const auto code = impl_->context.wait(member->id, rt::Event::activate, patience.timeout);
  return code == rt::ReturnCode::ok ? onActivated(&machine, 1) : corba::to_wire(code);
}

RTC::ReturnCode_t ExecutionContextBase::deactivateComponent(RTC::LightweightRTObject_ptr comp) {
  const auto member = impl_->find(comp);
  if (!member) return RTC::BAD_PARAMETER;
  if (const auto code = onDeactivating(comp); code != RTC::RTC_OK) return code;
  if (const auto code = impl_->context.request(member->id, rt::Event::deactivate); code != rt::ReturnCode::ok) return corba::to_wire(code);
  const Patience patience = impl_->shared.lock()->deactivation;
  RTC_impl::RTObjectStateMachine machine(member->reference, member->handle, impl_->context, member->id, member->owner);
  if (!patience.wait) return onDeactivated(&machine, 0);
  if (impl_->context.is_stepping_thread()) return RTC::RTC_OK;
  if (const auto code = onWaitingDeactivated(&machine, 0); code != RTC::RTC_OK) return code;
  const auto code = impl_->context.wait(member->id, rt::Event::deactivate, patience.timeout);
  return code == rt::ReturnCode::ok ? onDeactivated(&machine, 1) : corba::to_wire(code);
}

RTC::ReturnCode_t ExecutionContextBase::resetComponent(RTC::LightweightRTObject_ptr comp) {
  const auto member = impl_->find(comp);
  if (!member) return RTC::BAD_PARAMETER;
  if (const auto code = onResetting(comp); code != RTC::RTC_OK) return code;
  if (const auto code = impl_->context.request(member->id, rt::Event::reset); code != rt::ReturnCode::ok) return corba::to_wire(code);
  const Patience patience = impl_->shared.lock()->reset;
  RTC_impl::RTObjectStateMachine machine(member->reference, member->handle, impl_->context, member->id, member->owner);
  if (!patience.wait) return onReset(&machine, 0);
  if (impl_->context.is_stepping_thread()) return RTC::RTC_OK;
  if (const auto code = onWaitingReset(&machine, 0); code != RTC::RTC_OK) return code;
  const auto code = impl_->context.wait(member->id, rt::Event::reset, patience.timeout);
  return code == rt::ReturnCode::ok ? onReset(&machine, 1) : corba::to_wire(code);
}

RTC::LifeCycleState ExecutionContextBase::getComponentState(RTC::LightweightRTObject_ptr comp) const {
  const auto member = impl_->find(comp);
  const auto state = member ? static_cast<RTC::LifeCycleState>(impl_->context.state(member->id)) : RTC::CREATED_STATE;
  return onGetComponentState(state);
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
    for (const Member& member : data->members) {
      if (member.owner) continue;
      const CORBA::ULong n = profile->participants.length();
      profile->participants.length(n + 1);
      profile->participants[n] = RTC::RTObject::_unchecked_narrow(member.reference);
    }
  }
  const rt::ContextStatistics statistics = impl_->context.statistics();
  properties["rate"] = base::format_number(profile->rate);
  properties["statistics.cycles"] = std::to_string(statistics.cycles);
  properties["statistics.missed_cycles"] = std::to_string(statistics.missed_cycles);
  properties["statistics.mean_execution_time"] = seconds(statistics.mean_execution());
  properties["statistics.max_execution_time"] = seconds(statistics.max_execution);
  NVUtil::copyFromProperties(profile->properties, properties);
  RTC::ExecutionContextProfile* answer = profile._retn();
  return onGetProfile(answer);
}

std::vector<RTC::LightweightRTObject_var> ExecutionContextBase::getComponents() const {
  std::vector<RTC::LightweightRTObject_var> components;
  for (const Member& member : impl_->snapshot()) components.push_back(member.reference);
  return components;
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

void ExecutionContextBase::calmComponent(RTC::LightweightRTObject_ptr comp, std::chrono::nanoseconds timeout) {
  const auto member = impl_->find(comp);
  if (!member || !isRunning()) return;
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  const auto left = [&] { return deadline - std::chrono::steady_clock::now(); };
  RTC_impl::RTObjectStateMachine machine(member->reference, member->handle, impl_->context, member->id, member->owner);
  // A transition that is under way ends first; a deactivation that fails leads to the error state, and a reset out of it.
  for (int attempt = 0; attempt < 3 && left() > 0s; ++attempt) {
    const rt::State state = impl_->context.state(member->id);
    const rt::State next = impl_->context.next_state(member->id);
    if (state == next && state != rt::State::active && state != rt::State::error) return;
    const rt::Event event = state == rt::State::error ? rt::Event::reset : rt::Event::deactivate;
    if (state == next && impl_->context.request(member->id, event) != rt::ReturnCode::ok) return;
    if (event == rt::Event::reset)
      onWaitingReset(&machine, 0);
    else
      onWaitingDeactivated(&machine, 0);
    const rt::ReturnCode code = impl_->context.wait(member->id, event, left());
    if (state == rt::State::error && code != rt::ReturnCode::ok) return;
  }
}

bool ExecutionContextBase::waitForQuiet(std::chrono::nanoseconds timeout) { return impl_->context.wait_until_quiet(timeout); }

const base::Clock& ExecutionContextBase::contextClock() const { return system_clock(); }

void ExecutionContextBase::invokeWorker() {
  const base::ScopedClock clock(contextClock());
  impl_->context.step();
}

void ExecutionContextBase::invokeWorkerPreDo() {
  const base::ScopedClock clock(contextClock());
  impl_->context.transit();
}

void ExecutionContextBase::invokeWorkerDo() {
  const base::ScopedClock clock(contextClock());
  impl_->context.execute();
}

void ExecutionContextBase::invokeWorkerPostDo() {
  const base::ScopedClock clock(contextClock());
  impl_->context.update();
}

void ExecutionContextBase::countMissedCycles(std::uint64_t cycles) { impl_->context.count_missed(cycles); }

bool ExecutionContextBase::isSteppingThread() const { return impl_->context.is_stepping_thread(); }

void destroyExecutionContext(ExecutionContextBase* context) {
  auto* servant = dynamic_cast<PortableServer::ServantBase*>(context);
  if (servant == nullptr) {
    delete context;
    return;
  }
  RTC::ExecutionContextService_var reference = context->getObjRef();
  context->setObjRef(RTC::ExecutionContextService::_nil());
  try {
    PortableServer::POA_var poa = servant->_default_POA();
    PortableServer::ObjectId_var id = poa->reference_to_id(reference);
    poa->deactivate_object(id);
  } catch (const CORBA::Exception&) {
    // It was never activated, or the object adapter is gone: there is nothing left to take it out of.
  }
  servant->_remove_ref();
}

}  // namespace RTC
