#include <rtm/StaticFSM.h>

#include <algorithm>

#include "component/fsm_service.h"

namespace RTC::fsm {

namespace {

std::vector<const StateType*> with_ancestors(const StateType& type) {
  std::vector<const StateType*> chain;
  for (const StateType* state = &type; state; state = state->parent) chain.push_back(state);
  return chain;
}

}  // namespace

Engine::Engine(RTObject_impl* component, const StateType& top) : component_(component), top_(top), current_(&top), requested_(&top) {
  structure_.name = top.name;
  current_name_ = top.name;
  if (component_)
    service_ = ExtendedFsmServiceProvider::offer(
        *component_, [this] { return current_name(); }, structure_);
  state(top).onEntry();
}

Engine::~Engine() {
  if (service_ && component_) component_->removeSdoServiceProvider(ExtendedFsmServiceProvider::interface_id);
}

StateBase& Engine::state(const StateType& type) {
  std::unique_ptr<StateBase>& state = states_[&type];
  if (!state) {
    state = type.create();
    state->engine_ = this;
  }
  return *state;
}

StateBase& Engine::current() { return state(*current_); }

std::string Engine::current_name() const {
  std::lock_guard lock(mutex_);
  return current_name_;
}

void Engine::set_current(const StateType& type) {
  current_ = &type;
  std::lock_guard lock(mutex_);
  current_name_ = type.name;
}

void Engine::enter(const StateType& type) {
  if (component_) component_->preOnFsmEntry(type.name);
  const ReturnCode_t code = state(type).onEntry();
  if (component_) component_->postOnFsmEntry(type.name, code);
}

void Engine::leave(const StateType& type) {
  if (component_) component_->preOnFsmExit(type.name);
  const ReturnCode_t code = state(type).onExit();
  if (component_) component_->postOnFsmExit(type.name, code);
  if (!type.keeps_box) boxes_.erase(&type);
}

void Engine::request(const StateType& target, std::function<void(StateBase&)> init) {
  requested_ = &target;
  requested_init_ = std::move(init);
}

void Engine::settle() {
  while (true) {
    if (requested_) {
      transit(*std::exchange(requested_, nullptr), std::exchange(requested_init_, nullptr));
    } else if (!dispatched_.empty()) {
      const auto event = std::move(dispatched_.front());
      dispatched_.pop_front();
      event(current());
    } else {
      return;
    }
  }
}

void Engine::transit(const StateType& target, const std::function<void(StateBase&)>& init) {
  const StateType& source = *current_;
  const std::vector<const StateType*> from = with_ancestors(source);
  const std::vector<const StateType*> to = with_ancestors(target);
  const auto is_in = [](const std::vector<const StateType*>& chain, const StateType* type) {
    return std::find(chain.begin(), chain.end(), type) != chain.end();
  };
  if (component_) component_->preOnFsmStateChange(source.name);
  // To itself: out and in again, but for the top, which is never left.
  const bool again = &source == &target && target.parent;
  history_.erase(&source);
  for (const StateType* state : from) {
    if (is_in(to, state) && !(again && state == &target)) continue;
    leave(*state);
    if (state->parent && state->parent->history != History::none)
      history_[state->parent] = state->parent->history == History::deep ? &source : state;
  }
  set_current(target);
  if (given_.first) boxes_[given_.first] = std::move(given_.second);
  given_ = {};
  for (auto it = to.rbegin(); it != to.rend(); ++it)
    if (!is_in(from, *it) || (again && *it == &target)) enter(**it);
  if (component_) component_->preOnFsmInit(target.name);
  ReturnCode_t code = RTC_OK;
  if (init)
    init(state(target));
  else
    code = state(target).onInit();
  if (component_) {
    component_->postOnFsmInit(target.name, code);
    component_->postOnFsmStateChange(target.name, code);
  }
}

void Engine::restart() {
  for (const StateType* state : with_ancestors(*current_))
    if (state->parent) leave(*state);
  set_current(top_);
  history_.clear();
  request(top_);
  settle();
}

const StateType& Engine::history_of(const StateType& state) const {
  const auto it = history_.find(&state);
  return it == history_.end() ? state : *it->second;
}

void Engine::push(std::function<void()> event) {
  std::lock_guard lock(mutex_);
  events_.push_back(std::move(event));
}

void Engine::run_events() {
  std::deque<std::function<void()>> events;
  {
    std::lock_guard lock(mutex_);
    events.swap(events_);
  }
  for (const auto& event : events) event();
}

void Engine::add_event_profile(const std::string& name, const std::string& data_type) {
  const CORBA::ULong n = structure_.event_profiles.length();
  structure_.event_profiles.length(n + 1);
  structure_.event_profiles[n].name = name.c_str();
  structure_.event_profiles[n].data_type = data_type.c_str();
  if (service_) service_->set_fsm_structure(structure_);
  if (component_) component_->notifyObservers(RTObject_impl::Status::fsm_profile, name);
}

}  // namespace RTC::fsm
