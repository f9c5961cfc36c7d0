// The members of an execution context: how they come, change their state and leave.
#include <rtm/RTObject.h>
#include "component/component_impl.h"
#include "component/context_impl.h"
#include "component/local_component.h"

#include <algorithm>

#include "corba/members/action_call.h"
#include "corba/members/remote_participant.h"
#include "corba/orb/object_names.h"
#include "corba/orb/orb.h"
#include "corba/orb/principal.h"
#include "corba/orb/return_code.h"
#include "core/key_limits.h"
#include "core/log_rate_limiter.h"

namespace RTC {

namespace {

using namespace std::chrono_literals;

class LocalParticipant final : public rt::Participant {
 public:
  LocalParticipant(std::shared_ptr<RTObject_impl> component, ExecutionContextHandle_t handle)
      : component_(std::move(component)), handle_(handle) {}

  std::string name() const override { return component_->getInstanceName(); }
  rt::ReturnCode call(rt::Action action) override {
    return corba::from_wire(corba::call_action(action, *component_, component_.get(), handle_));
  }

 private:
  const std::shared_ptr<RTObject_impl> component_;
  const ExecutionContextHandle_t handle_;
};

}  // namespace

void ExecutionContextBase::Impl::Entry::joined(rt::MemberId id) {
  member_.id = id;
  member_.machine = std::make_shared<RTC_impl::RTObjectStateMachine>(member_.reference, member_.handle, context_, id);
}

std::vector<ExecutionContextBase::Impl::Member> ExecutionContextBase::Impl::members() const {
  std::vector<Member> all;
  for (const auto& participant : context.participants()) all.push_back(member_of(*participant));
  return all;
}

bool ExecutionContextBase::Impl::remove(const Member& member, std::chrono::nanoseconds timeout, bool* is_left_alone) {
  {
    auto data = shared.lock();
    data->retired.push_back(member.machine);
    if (data->retired.size() > max_retired) data->retired.pop_front();
  }
  const auto removal = context.remove(member.id, timeout);
  if (is_left_alone) *is_left_alone = removal == rt::ExecutionContext::Removal::left_alone;
  return removal != rt::ExecutionContext::Removal::no_member;
}

std::optional<ExecutionContextBase::Impl::Member> ExecutionContextBase::Impl::find(RTC::LightweightRTObject_ptr component) const {
  if (CORBA::is_nil(component)) return std::nullopt;
  const auto all = context.participants();
  // Most often it is the very reference that somebody got from here.
  for (const auto& participant : all)
    if (const Member& member = member_of(*participant); member.reference.in() == component) return member;
  for (const auto& participant : all)
    if (const Member& member = member_of(*participant); member.reference->_is_equivalent(component)) return member;
  // The same component under another key (corbaloc).
  if (const auto local = findLocalComponent(component))
    for (const auto& participant : all)
      if (const Member& member = member_of(*participant); member.local == local.get()) return member;
  return std::nullopt;
}

bool ExecutionContextBase::Impl::is_waited_for_by_callback(const Member& member) const {
  return context.is_stepping_thread() || isInsideCallbackOf(member.local);
}

std::vector<RTC::LightweightRTObject_var> ExecutionContextBase::getComponents() const {
  std::vector<RTC::LightweightRTObject_var> components;
  for (const auto& participant : impl_->context.participants()) components.push_back(Impl::member_of(*participant).reference);
  return components;
}

std::vector<RTC::LifeCycleState> ExecutionContextBase::getComponentStates() const {
  std::vector<RTC::LifeCycleState> states;
  for (const auto& member : impl_->context.members()) states.push_back(onGetComponentState(static_cast<RTC::LifeCycleState>(member.state)));
  return states;
}

const RTC::RTCList& ExecutionContextBase::getComponentList() const {
  RTC::RTCList& list = impl_->component_list;
  list.length(0);
  for (const Impl::Member& member : impl_->members()) {
    const CORBA::ULong n = list.length();
    list.length(n + 1);
    list[n] = RTC::RTObject::_unchecked_narrow(member.reference);
  }
  return list;
}

RTC::ReturnCode_t ExecutionContextBase::bindComponent(RTC::RTObject_impl* rtc) {
  if (rtc == nullptr) return RTC::BAD_PARAMETER;
  RTC::ExecutionContextService_var reference = getObjRef();
  RTC::RTObject_var owner = rtc->getObjRef();
  const ExecutionContextHandle_t handle = rtc->bindContext(reference);
  if (handle < 0) return RTC::RTC_ERROR;
  rtc->_add_ref();
  const std::shared_ptr<RTObject_impl> counted(rtc, [](RTObject_impl* component) { component->_remove_ref(); });
  Impl::Member member;
  member.reference = RTC::LightweightRTObject::_duplicate(owner);
  member.local = rtc;
  member.handle = handle;
  member.owner = true;
  impl_->context.add(std::make_shared<Impl::Entry>(*this, std::move(member), std::make_shared<LocalParticipant>(counted, handle)));
  auto data = impl_->shared.lock();
  if (CORBA::is_nil(data->owner)) {
    data->owner = owner;
    corba::name_object_as(reference, owner);
  }
  return RTC::RTC_OK;
}

std::size_t ExecutionContextBase::unbindComponent(RTC::RTObject_impl* rtc, std::chrono::nanoseconds timeout) {
  std::optional<Impl::Member> leaving;
  std::size_t owners = 0;
  RTC::RTObject_var first;
  for (const Impl::Member& member : impl_->members()) {
    if (!member.owner) continue;
    if (member.local == rtc)
      leaving = member;
    else if (owners++ == 0)
      first = RTC::RTObject::_unchecked_narrow(member.reference);
  }
  impl_->shared.lock()->owner = first;
  if (leaving) impl_->remove(*leaving, timeout);
  return owners;
}

void ExecutionContextBase::dismissMembers() {
  for (const Impl::Member& member : impl_->members())
    if (impl_->remove(member, 0ns) && !member.owner) Impl::detach(member, rtclog);
}

std::shared_ptr<corba::MemberWatch> ExecutionContextBase::Impl::member_watch() {
  if (const auto watch = shared.lock()->watch) return watch;
  const auto made = std::make_shared<corba::MemberWatch>();
  auto data = shared.lock();
  if (!data->watch) data->watch = made;
  return data->watch;
}

void ExecutionContextBase::Impl::detach(const Member& member, Logger& rtclog) {
  try {
    RTC::LightweightRTObject_var(member.reference)->detach_context(member.handle);
  } catch (const CORBA::Exception& exception) {
    RTC_DEBUG(("a component that leaves does not answer detach_context: %s", corba::to_text(exception).c_str()));
  }
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
  if (impl_->context.members().size() >= rt::entry_limits.members) {
    rt::log_rejection(rtclog, RTC::Logger::RTL_ERROR,
                      "a further component is rejected: the context has " + std::to_string(rt::entry_limits.members) + ", the maximum");
    return RTC::RTC_ERROR;
  }
  if (const auto code = onAddingComponent(comp); code != RTC::RTC_OK) return code;
  RTC::ExecutionContextService_var self = getObjRef();
  Impl::Member member;
  member.handle = -1;
  std::shared_ptr<rt::Participant> participant;
  try {
    if (const auto local = findLocalComponent(comp)) {
      member.reference = RTC::LightweightRTObject::_duplicate(comp);
      member.local = local.get();
      member.handle = local->attach_context(self);
      participant = std::make_shared<LocalParticipant>(local, member.handle);
    } else {
      if (!corba::may_keep(comp)) return RTC::RTC_ERROR;
      const bool has_time = impl_->member_timeout->is_without_end();
      const RTC::LightweightRTObject_var asked = corba::RemoteParticipant::with_timeout(
          comp, has_time ? corba::RemoteParticipant::long_call_timeout : corba::RemoteParticipant::call_timeout);
      member.reference = corba::RemoteParticipant::with_timeout(comp);
      member.handle = asked->attach_context(self);
      if (member.handle >= 0)
        participant = std::make_shared<corba::RemoteParticipant>(comp, member.handle, impl_->member_timeout, impl_->member_watch());
    }
  } catch (const CORBA::Exception& exception) {
    rt::log_rejection(rtclog, RTC::Logger::RTL_ERROR, "a component that is to join does not answer: " + corba::to_text(exception));
    if (member.handle >= 0) Impl::detach(member, rtclog);
    return RTC::RTC_ERROR;
  }
  if (member.handle < 0) return RTC::RTC_ERROR;
  const std::size_t lane = laneOf(participant->name());
  impl_->context.add(std::make_shared<Impl::Entry>(*this, std::move(member), std::move(participant)), lane);
  return onAddedComponent(comp);
}

RTC::ReturnCode_t ExecutionContextBase::removeComponent(RTC::LightweightRTObject_ptr comp) {
  return removeComponent(comp, std::chrono::steady_clock::now() + callbackTimeout());
}

RTC::ReturnCode_t ExecutionContextBase::removeComponent(RTC::LightweightRTObject_ptr comp, std::chrono::steady_clock::time_point deadline) {
  const auto member = impl_->find(comp);
  if (!member || member->owner) return RTC::BAD_PARAMETER;
  if (const auto code = onRemovingComponent(comp); code != RTC::RTC_OK) return code;
  const auto timeout = std::max<std::chrono::nanoseconds>(deadline - std::chrono::steady_clock::now(), 0ns);
  bool is_left_alone = true;
  if (!impl_->remove(*member, timeout, &is_left_alone)) return RTC::BAD_PARAMETER;
  if (!is_left_alone) complainAboutCallback("it leaves the context anyway");
  Impl::detach(*member, rtclog);
  return onRemovedComponent(comp);
}

// One that callers ask for, with the hooks of contexts that derive from this one.
struct ExecutionContextBase::Transition {
  using Machine = RTC_impl::RTObjectStateMachine;
  rt::Event event;
  RTC::ReturnCode_t (ExecutionContextBase::*before)(RTC::LightweightRTObject_ptr);
  RTC::ReturnCode_t (ExecutionContextBase::*waiting)(Machine*, long int);
  RTC::ReturnCode_t (ExecutionContextBase::*after)(Machine*, long int);
  std::atomic<bool> ExecutionContextBase::*is_waited_for;
  std::chrono::nanoseconds Impl::Data::*timeout;
};

RTC::ReturnCode_t ExecutionContextBase::make(const Transition& transition, RTC::LightweightRTObject_ptr comp) {
  const auto member = impl_->find(comp);
  if (!member) return RTC::BAD_PARAMETER;
  if (const auto code = (this->*transition.before)(comp); code != RTC::RTC_OK) return code;
  if (const auto code = impl_->context.request(member->id, transition.event); code != rt::ReturnCode::ok) return corba::to_wire(code);
  const auto timeout = (*impl_->shared.lock()).*transition.timeout;
  RTC_impl::RTObjectStateMachine* machine = member->machine.get();
  if (!(this->*transition.is_waited_for)) return (this->*transition.after)(machine, 0);
  if (impl_->is_waited_for_by_callback(*member)) return RTC::RTC_OK;
  if (const auto code = (this->*transition.waiting)(machine, 0); code != RTC::RTC_OK) return code;
  const auto code = impl_->context.wait(member->id, transition.event, timeout);
  return code == rt::ReturnCode::ok ? (this->*transition.after)(machine, 1) : corba::to_wire(code);
}

RTC::ReturnCode_t ExecutionContextBase::activateComponent(RTC::LightweightRTObject_ptr comp) {
  using Context = ExecutionContextBase;
  return make({rt::Event::activate, &Context::onActivating, &Context::onWaitingActivated, &Context::onActivated, &Context::m_syncActivation,
               &Impl::Data::activation},
              comp);
}

RTC::ReturnCode_t ExecutionContextBase::deactivateComponent(RTC::LightweightRTObject_ptr comp) {
  using Context = ExecutionContextBase;
  return make({rt::Event::deactivate, &Context::onDeactivating, &Context::onWaitingDeactivated, &Context::onDeactivated,
               &Context::m_syncDeactivation, &Impl::Data::deactivation},
              comp);
}

RTC::ReturnCode_t ExecutionContextBase::resetComponent(RTC::LightweightRTObject_ptr comp) {
  using Context = ExecutionContextBase;
  return make(
      {rt::Event::reset, &Context::onResetting, &Context::onWaitingReset, &Context::onReset, &Context::m_syncReset, &Impl::Data::reset},
      comp);
}

RTC::LifeCycleState ExecutionContextBase::getComponentState(RTC::LightweightRTObject_ptr comp) const {
  const auto member = impl_->find(comp);
  const auto state = member ? static_cast<RTC::LifeCycleState>(impl_->context.state(member->id)) : RTC::CREATED_STATE;
  return onGetComponentState(state);
}

void ExecutionContextBase::askToRest(RTC::LightweightRTObject_ptr comp) {
  const auto member = impl_->find(comp);
  if (!member || !isRunning()) return;
  const rt::State state = impl_->context.state(member->id);
  if (state == rt::State::active) impl_->context.request(member->id, rt::Event::deactivate);
  if (state == rt::State::error) impl_->context.request(member->id, rt::Event::reset);
}

void ExecutionContextBase::calmComponent(RTC::LightweightRTObject_ptr comp, std::chrono::steady_clock::time_point deadline) {
  const auto member = impl_->find(comp);
  if (!member || !isRunning()) return;
  const auto left = [&] { return std::max<std::chrono::nanoseconds>(deadline - std::chrono::steady_clock::now(), 0ns); };
  RTC_impl::RTObjectStateMachine* machine = member->machine.get();
  // A transition that is under way ends first; a deactivation that fails leads to the error state, and a reset out of it.
  for (int attempt = 0; attempt < 3 && !impl_->context.stuck_call(); ++attempt) {
    const rt::State state = impl_->context.state(member->id);
    const rt::State next = impl_->context.next_state(member->id);
    if (state == next && state != rt::State::active && state != rt::State::error) return;
    const rt::Event event = state == rt::State::error ? rt::Event::reset : rt::Event::deactivate;
    if (state == next && impl_->context.request(member->id, event) != rt::ReturnCode::ok) return;
    if (event == rt::Event::reset)
      onWaitingReset(machine, 0);
    else
      onWaitingDeactivated(machine, 0);
    const rt::ReturnCode code = impl_->context.wait_while_running(member->id, event, left());
    if (!isRunning()) return;
    if (left() == 0ns) {
      impl_->context.write_off_call();
      return;
    }
    if (state == rt::State::error && code != rt::ReturnCode::ok) return;
  }
}

void destroyExecutionContext(ExecutionContextBase* context) {
  auto* servant = dynamic_cast<PortableServer::ServantBase*>(context);
  if (servant == nullptr) {
    delete context;
    return;
  }
  RTC::ExecutionContextService_var reference = context->getObjRef();
  context->setObjRef(RTC::ExecutionContextService::_nil());
  corba::forget_object(reference);
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
