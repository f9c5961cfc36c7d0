#include "core/execution_context.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <system_error>

#include "base/clock.h"
#include "base/log.h"
#include "base/waiting.h"
#include "core/workers.h"

namespace rt {

using namespace std::chrono_literals;

// The threads on which members of other places are called. Whoever says that a member is elsewhere costs a thread, up to a limit.
class ParallelCalls {
 public:
  static constexpr std::size_t max_threads = 64;

  explicit ParallelCalls(std::size_t most) : threads_(std::min(most, max_threads)) {
    pool_.start(threads_ - 1, [this](std::size_t number, int) { work(number); });
  }
  // Calls work(0) here and work(1) ... work(count - 1) on the others, several on each if there are more than threads, and returns when all
  // have returned.
  void run(std::size_t count, const std::function<void(std::size_t)>& work) {
    count_ = count;
    work_ = &work;
    clock_ = &base::current_clock();
    pool_.run(0, [&] { this->work(0); });
  }

 private:
  void work(std::size_t number) {
    const base::ScopedClock clock(*clock_);
    for (; number < count_; number += threads_) (*work_)(number);
  }
  const std::size_t threads_;  // the caller's included
  // Written while the pool rests, which hands them over with its job.
  std::size_t count_ = 0;
  const std::function<void(std::size_t)>* work_ = nullptr;
  const base::Clock* clock_ = nullptr;
  ThreadPool pool_;
};

ExecutionContext::ExecutionContext(std::string name, double rate) : name_(std::move(name)) { shared_.lock()->rate = rate; }

bool ExecutionContext::is_running() const { return shared_.lock()->running; }

bool ExecutionContext::is_halted() const { return shared_.lock()->halted; }

double ExecutionContext::rate() const { return shared_.lock()->rate; }

std::chrono::nanoseconds ExecutionContext::period() const { return std::chrono::nanoseconds(std::llround(1e9 / rate())); }

ReturnCode ExecutionContext::call(const Participant& participant, Action action) const {
  try {
    return const_cast<Participant&>(participant).call(action);
  } catch (const std::exception& e) {
    base::log(base::Level::error, name_, "{} of {} threw: {}", to_text(action), participant.name(), e.what());
  } catch (...) {
    base::log(base::Level::error, name_, "{} of {} threw something that is no std::exception", to_text(action), participant.name());
  }
  return ReturnCode::error;
}

void ExecutionContext::call_all(Action action) {
  std::vector<std::shared_ptr<Participant>> participants;
  {
    auto data = shared_.lock();
    for (const auto& member : data->members) participants.push_back(member->participant);
  }
  for (const auto& participant : participants) call(*participant, action);
}

ReturnCode ExecutionContext::start() {
  {
    auto data = shared_.lock();
    if (data->running) return ReturnCode::precondition_not_met;
    data->running = true;
  }
  call_all(Action::startup);
  if (wake_) wake_();
  return ReturnCode::ok;
}

ReturnCode ExecutionContext::stop(std::chrono::nanoseconds timeout) {
  {
    auto data = shared_.lock();
    if (!data->running) return ReturnCode::precondition_not_met;
    data->halted = true;
  }
  if (!wait_until_quiet(timeout)) {
    resume();
    return ReturnCode::error;
  }
  {
    auto data = shared_.lock();
    data->running = false;
    data->halted = false;
  }
  changed_.notify_all();
  call_all(Action::shutdown);
  return ReturnCode::ok;
}

void ExecutionContext::halt() { shared_.lock()->halted = true; }

void ExecutionContext::resume() {
  shared_.lock()->halted = false;
  if (wake_) wake_();
}

bool ExecutionContext::wait_until_quiet(std::chrono::nanoseconds timeout) {
  auto data = shared_.lock();
  data.wait_for(changed_, timeout,
                [&] { return std::ranges::all_of(data->calls, [](const Call& call) { return call.is_own() || call.is_written_off; }); });
  return std::ranges::all_of(data->calls, [](const Call& call) { return call.is_own(); });
}

void ExecutionContext::write_off_call() {
  auto data = shared_.lock();
  for (Call& call : data->calls) call.is_written_off = call.is_written_off || !call.is_own();
  changed_.notify_all();
}

std::optional<std::string> ExecutionContext::stuck_call() const {
  auto data = shared_.lock();
  std::optional<std::string> text;
  for (const Call& call : data->calls) {
    if (!call.is_written_off) continue;
    text = (text ? *text + ", " : "") + call.callee->name() + " in " + std::string(callback_of(call.action));
  }
  return text;
}

ReturnCode ExecutionContext::set_rate(double rate) {
  if (!(rate >= min_rate && rate <= max_rate)) return ReturnCode::bad_parameter;  // also not a number
  shared_.lock()->rate = rate;
  call_all(Action::rate_changed);
  if (wake_) wake_();
  return ReturnCode::ok;
}

void ExecutionContext::set_lanes(std::size_t count) { shared_.lock()->lanes.resize(std::max<std::size_t>(count, 1)); }

MemberId ExecutionContext::add(std::shared_ptr<Participant> participant, std::size_t lane) {
  const MemberId id = ++shared_.lock()->last_id;
  participant->joined(id);
  auto data = shared_.lock();
  data->members.push_back(
      std::make_shared<Member>(Member{.id = id, .participant = std::move(participant), .lane = lane < data->lanes.size() ? lane : 0}));
  ++data->version;
  return id;
}

ExecutionContext::Removal ExecutionContext::remove(MemberId id, std::chrono::nanoseconds timeout) {
  std::shared_ptr<Member> removed;  // a participant is destroyed without the lock
  std::shared_ptr<Participant> participant;
  auto data = shared_.lock();
  const auto it = std::find_if(data->members.begin(), data->members.end(), [&](const auto& member) { return member->id == id; });
  if (it == data->members.end()) return Removal::no_member;
  removed = *it;
  removed->removed = true;
  removed->pending.reset();
  data->members.erase(it);
  ++data->version;
  changed_.notify_all();
  const auto is_left_alone = [&](bool forget_written_off) {
    return std::ranges::none_of(
        data->calls, [&](const Call& call) { return call.member == id && !call.is_own() && !(forget_written_off && call.is_written_off); });
  };
  data.wait_for(changed_, timeout, [&] { return is_left_alone(true); });
  const bool is_quiet = is_left_alone(false);
  // The stepping thread, which may be stuck in a call to somebody else, still has this entry.
  if (std::ranges::none_of(data->calls, [&](const Call& call) { return call.member == id; })) participant = std::move(removed->participant);
  return is_quiet ? Removal::left_alone : Removal::still_called;
}

ExecutionContext::Member* ExecutionContext::find(Data& data, MemberId id) {
  return const_cast<Member*>(find(static_cast<const Data&>(data), id));
}

const ExecutionContext::Member* ExecutionContext::find(const Data& data, MemberId id) {
  for (const auto& member : data.members)
    if (member->id == id) return member.get();
  return nullptr;
}

State ExecutionContext::next(const Member& member) {
  const Transition* transition = member.pending ? find_transition(member.state, *member.pending) : nullptr;
  return transition ? transition->to : member.state;
}

std::vector<std::shared_ptr<Participant>> ExecutionContext::participants() const {
  std::vector<std::shared_ptr<Participant>> all;
  const auto data = shared_.lock();
  for (const auto& member : data->members) all.push_back(member->participant);
  return all;
}

std::vector<ExecutionContext::MemberState> ExecutionContext::members() const {
  std::vector<MemberState> states;
  const auto data = shared_.lock();
  for (const auto& member : data->members) states.push_back({member->id, member->state, next(*member)});
  return states;
}

State ExecutionContext::state(MemberId id) const {
  const auto data = shared_.lock();
  const Member* member = find(*data, id);
  return member ? member->state : State::created;
}

State ExecutionContext::next_state(MemberId id) const {
  const auto data = shared_.lock();
  const Member* member = find(*data, id);
  return member ? next(*member) : State::created;
}

bool ExecutionContext::is_next(State state) const {
  const auto data = shared_.lock();
  return std::all_of(data->members.begin(), data->members.end(), [&](const auto& member) { return next(*member) == state; });
}

bool ExecutionContext::is_idle() const {
  const auto data = shared_.lock();
  if (!may_call(*data)) return true;
  return std::all_of(data->members.begin(), data->members.end(),
                     [](const auto& member) { return member->state == State::inactive && !member->pending; });
}

ReturnCode ExecutionContext::request(MemberId id, Event event) {
  {
    auto data = shared_.lock();
    Member* member = find(*data, id);
    if (!member) return ReturnCode::bad_parameter;
    if (!find_transition(member->state, event)) return ReturnCode::precondition_not_met;
    if (member->pending && *member->pending != event) return ReturnCode::precondition_not_met;
    member->pending = event;
  }
  if (wake_) wake_();
  return ReturnCode::ok;
}

ReturnCode ExecutionContext::wait(MemberId id, Event event, std::chrono::nanoseconds timeout) {
  return wait_until_settled(id, event, timeout, false);
}

ReturnCode ExecutionContext::wait_while_running(MemberId id, Event event, std::chrono::nanoseconds timeout) {
  return wait_until_settled(id, event, timeout, true);
}

ReturnCode ExecutionContext::wait_until_settled(MemberId id, Event event, std::chrono::nanoseconds timeout, bool gives_up_when_stopped) {
  if (is_stepping_thread()) return ReturnCode::ok;
  const Transition* wanted = nullptr;
  for (const Transition& transition : transitions)
    if (transition.event == event) wanted = &transition;
  auto data = shared_.lock();
  const auto is_settled = [&] {
    const Member* member = find(*data, id);
    return !member || !member->pending;
  };
  data.wait_for(changed_, timeout, [&] { return is_settled() || (gives_up_when_stopped && !data->running); });
  const bool settled = is_settled();
  const Member* member = find(*data, id);
  if (!member) return ReturnCode::bad_parameter;
  if (!settled) return member->pending == Event::fail ? ReturnCode::precondition_not_met : ReturnCode::error;
  return member->state == wanted->to ? ReturnCode::ok : ReturnCode::precondition_not_met;
}

bool ExecutionContext::is_stepping_thread() const {
  const auto data = shared_.lock();
  return std::ranges::any_of(data->calls, [](const Call& call) { return call.is_own(); });
}

std::optional<ReturnCode> ExecutionContext::call_member(Member& member, Action action) {
  {
    auto data = shared_.lock();
    if (member.removed || !may_call(*data)) return std::nullopt;
    data->calls.push_back({member.id, member.participant.get(), action, std::this_thread::get_id(), false});
  }
  const ReturnCode code = call(*member.participant, action);
  {
    auto data = shared_.lock();
    const auto it = std::find_if(data->calls.rbegin(), data->calls.rend(), [](const Call& one) { return one.is_own(); });
    data->calls.erase(std::next(it).base());
  }
  changed_.notify_all();  // free when nobody waits
  return code;
}

ExecutionContext::Members ExecutionContext::begin_cycle(std::size_t number) {
  Group members;
  std::uint64_t version = 0;
  {
    auto data = shared_.lock();
    Lane& lane = data->lanes[number];
    lane.cycle_start = std::chrono::steady_clock::now();
    lane.waited_before = base::time_waited();
    if (lane.version == data->version) return lane.members;
    version = data->version;
    std::ranges::copy_if(data->members, std::back_inserter(members), [&](const auto& member) { return member->lane == number; });
  }
  Members made = plan(members);
  Members old;  // what has left is destroyed without the lock
  auto data = shared_.lock();
  Lane& lane = data->lanes[number];
  old = std::exchange(lane.members, made);
  lane.version = version;
  return made;
}

ExecutionContext::Members ExecutionContext::plan(const Group& members) const {
  auto made = std::make_shared<Plan>();
  std::size_t most = 1;
  std::vector<std::string> places;  // of the groups of the last stage
  for (const auto& member : members) {
    const std::string place = member->participant->place();
    const bool goes_on = !places.empty() && places.front().empty() == place.empty();
    if (!goes_on) {
      made->stages.emplace_back();
      places.clear();
    }
    Stage& stage = made->stages.back();
    const auto at = std::ranges::find(places, place) - places.begin();
    if (at == std::ssize(places)) {
      places.push_back(place);
      stage.emplace_back();
    }
    stage[static_cast<std::size_t>(at)].push_back(member);
    most = std::max(most, stage.size());
  }
  if (most > 1) {
    try {
      made->parallel_calls = std::make_shared<ParallelCalls>(most);
    } catch (const std::system_error& error) {
      base::log(base::Level::error, name_, "members of other processes are called one after another: no further thread: {}", error.what());
    }
  }
  return made;
}

void ExecutionContext::for_all(const Plan& plan, const std::function<void(Member&)>& call) {
  const auto call_group = [&](const Group& group) {
    for (const auto& member : group) call(*member);
  };
  for (const Stage& stage : plan.stages) {
    if (!plan.parallel_calls || stage.size() == 1)
      std::ranges::for_each(stage, call_group);
    else
      plan.parallel_calls->run(stage.size(), [&](std::size_t number) { call_group(stage[number]); });
  }
}

ExecutionContext::Members ExecutionContext::members_of(std::size_t lane) const { return shared_.lock()->lanes[lane].members; }

std::shared_ptr<ExecutionContext::Member> ExecutionContext::hold(MemberId id) const {
  const auto data = shared_.lock();
  const auto it = std::find_if(data->members.begin(), data->members.end(), [&](const auto& member) { return member->id == id; });
  return it == data->members.end() ? nullptr : *it;
}

void ExecutionContext::transit(std::size_t lane) {
  const Members members = begin_cycle(lane);
  const auto is_pending = [](const auto& member) { return member->pending.has_value(); };
  if (auto data = shared_.lock(); std::ranges::none_of(data->members, is_pending)) return;  // the rule, and nobody has to be woken for it
  for_all(*members, [this](Member& member) { transit(member); });
}

void ExecutionContext::transit_one(MemberId id) {
  if (const auto member = hold(id)) transit(*member);
}

void ExecutionContext::transit(Member& member) {
  const Transition* transition = nullptr;
  {
    auto data = shared_.lock();
    if (member.removed || !may_call(*data) || !member.pending) return;
    transition = find_transition(member.state, *member.pending);
    assert(transition && "only possible events are pending");
  }
  State to = transition->to;
  if (transition->leave) {
    const auto code = call_member(member, *transition->leave);
    if (!code) return;
    if (*code != ReturnCode::ok) to = transition->if_leave_fails;
  }
  bool failed = false;
  if (const auto enter = actions_of(to).enter; enter && to != transition->from) {
    const auto code = call_member(member, *enter);
    if (!code && !transition->leave) return;
    failed = code && *code != ReturnCode::ok;
  }
  {
    auto data = shared_.lock();
    member.state = to;
    member.pending.reset();
    if (failed && to == State::active) member.pending = Event::fail;
  }
  changed_.notify_all();
}

template <class Select>
void ExecutionContext::run_stage(Member& member, Select select) {
  std::optional<Action> action;
  {
    auto data = shared_.lock();
    if (!member.removed && may_call(*data) && !member.pending) action = select(actions_of(member.state));
  }
  if (!action || call_member(member, *action).value_or(ReturnCode::ok) == ReturnCode::ok) return;
  auto data = shared_.lock();
  if (!member.removed && member.state == State::active) member.pending = Event::fail;
}

namespace {
constexpr auto select_execute = [](const StateActions& actions) { return actions.execute; };
constexpr auto select_update = [](const StateActions& actions) { return actions.state_update; };
}  // namespace

void ExecutionContext::execute(std::size_t lane) {
  const Members members = members_of(lane);
  for_all(*members, [this](Member& member) { run_stage(member, select_execute); });
}

void ExecutionContext::execute_one(MemberId id) {
  if (const auto member = hold(id)) run_stage(*member, select_execute);
}

void ExecutionContext::update_one(MemberId id) {
  if (const auto member = hold(id)) run_stage(*member, select_update);
}

void ExecutionContext::update(std::size_t lane) {
  const Members members = members_of(lane);
  for_all(*members, [this](Member& member) { run_stage(member, select_update); });
  if (lane != 0) return;
  const auto now = std::chrono::steady_clock::now();
  std::chrono::nanoseconds took{0};
  std::chrono::nanoseconds waited{0};
  {
    auto data = shared_.lock();
    took = now - data->lanes[lane].cycle_start;
    // Somebody else's thread may have begun the cycle.
    waited = std::clamp(base::time_waited() - data->lanes[lane].waited_before, 0ns, took);
  }
  count_cycle(took - waited, waited);
}

void ExecutionContext::count_cycle(std::chrono::nanoseconds took, std::chrono::nanoseconds waited) {
  auto data = shared_.lock();
  if (!data->running) return;
  ContextStatistics& statistics = data->statistics;
  ++statistics.cycles;
  statistics.total_execution += took;
  statistics.total_waiting += waited;
  statistics.max_execution = std::max(statistics.max_execution, took);
}

ContextStatistics ExecutionContext::statistics() const { return shared_.lock()->statistics; }

void ExecutionContext::count_missed(std::uint64_t cycles) { shared_.lock()->statistics.missed_cycles += cycles; }

}  // namespace rt
