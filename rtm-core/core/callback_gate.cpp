#include "core/callback_gate.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/text.h"

namespace rt {

namespace {

bool is_own(const CallbackGate::Running& one) { return one.thread == std::this_thread::get_id(); }
bool is_other(const CallbackGate::Running& one) { return !is_own(one); }

}  // namespace

CallbackGate::Visit::Visit(CallbackGate& gate, const char* callback, Caller caller)
    : gate_(gate), callback_(callback), caller_(caller), answer_(gate.enter(callback, caller)) {}

CallbackGate::Visit::~Visit() {
  if (answer_ == Answer::inside) gate_.leave();
}

CallbackGate::Answer CallbackGate::Visit::wait(std::chrono::steady_clock::time_point deadline) {
  if (answer_ != Answer::inside) answer_ = gate_.wait(callback_, caller_, deadline);
  return answer_;
}

bool CallbackGate::is_free(const State& state) { return std::ranges::all_of(state.inside, is_own); }

bool CallbackGate::has_given_up(const State& state) {
  return std::ranges::any_of(state.inside, [](const Running& one) { return is_other(one) && one.is_given_up; });
}

void CallbackGate::push(State& state, const char* callback) {
  state.inside.push_back({callback, std::chrono::steady_clock::now(), std::this_thread::get_id(), false});
}

CallbackGate::Answer CallbackGate::enter(const char* callback, Caller caller) {
  auto state = state_.lock();
  if (caller == Caller::remote && state->is_closed_to_remote) return Answer::closed;
  const bool is_free_now = state->inside.empty() && state->waiting.empty();
  if (!is_free_now && std::ranges::none_of(state->inside, is_own)) return Answer::busy;
  push(*state, callback);
  return Answer::inside;
}

CallbackGate::Answer CallbackGate::wait(const char* callback, Caller caller, std::chrono::steady_clock::time_point deadline) {
  auto state = state_.lock();
  const bool is_remote = caller == Caller::remote;
  if (is_remote && state->remote_waiting >= max_waiting) return Answer::crowded;
  const std::uint64_t ticket = ++state->last_ticket;
  state->waiting.push_back(ticket);
  if (is_remote) ++state->remote_waiting;
  const auto is_closed = [&] { return is_remote && state->is_closed_to_remote; };
  const auto has_turn = [&] { return state->waiting.front() == ticket && is_free(*state); };
  state.wait_until(changed_, deadline, [&] { return is_closed() || has_given_up(*state) || has_turn(); });
  Answer answer = Answer::busy;
  if (is_closed()) {
    answer = Answer::closed;
  } else if (has_turn()) {
    answer = Answer::inside;
    push(*state, callback);
  }
  std::erase(state->waiting, ticket);
  if (is_remote) --state->remote_waiting;
  if (answer != Answer::inside) changed_.notify_all();  // the next one may be the first now
  return answer;
}

void CallbackGate::leave() {
  auto state = state_.lock();
  const auto it = std::find_if(state->inside.rbegin(), state->inside.rend(), is_own);
  state->inside.erase(std::next(it).base());
  // With the lock: a thread that waits for the end may destroy the gate.
  if (!state->waiting.empty()) changed_.notify_all();
}

bool CallbackGate::is_inside() const {
  const auto state = state_.lock();
  return std::ranges::any_of(state->inside, is_own);
}

void CallbackGate::close_to_remote() {
  state_.lock()->is_closed_to_remote = true;
  changed_.notify_all();
}

bool CallbackGate::wait_until_empty(std::chrono::steady_clock::time_point deadline) {
  if (is_inside()) return true;
  const Answer answer = wait("", Caller::local, deadline);
  if (answer == Answer::inside) {
    leave();
    return true;
  }
  auto state = state_.lock();
  bool has_others = false;
  for (Running& one : state->inside) {
    if (!is_other(one)) continue;
    one.is_given_up = true;
    has_others = true;
  }
  changed_.notify_all();
  return !has_others;
}

std::vector<CallbackGate::Running> CallbackGate::others_inside() const {
  std::vector<Running> others = inside();
  std::erase_if(others, is_own);
  return others;
}

std::string CallbackGate::describe() const {
  const auto others = others_inside();
  if (others.empty()) return "";
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - others.front().since;
  return std::string(others.front().callback) + " has run for " + base::format_number(std::round(time.count() * 100) / 100) + " s";
}

}  // namespace rt
