#include "campaign/run/action_runner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/fault_text.h"
#include "base/random.h"
#include "base/text.h"
#include "run/condition_words.h"
#include "system/remote.h"

namespace campaign {
namespace {

using Object = Fault::Object;
using Kind = Fault::Kind;

constexpr double look_period_s = 0.1;

std::string text_of(const Fault& fault, std::string_view kind, const std::string& last) {
  return base::fault_text(kind, fault.at_s, fault.for_s.value_or(0), fault.amount, last);
}

bool is_by_property(Kind kind) { return kind == Kind::error || kind == Kind::exception || kind == Kind::slow || kind == Kind::hang; }

std::map<std::string, std::string> texts_of(const std::vector<Fault>& faults, Object object, std::uint64_t seed) {
  std::map<std::string, std::string> texts;
  for (const auto& fault : faults) {
    if (fault.object != object || (object == Object::component && !is_by_property(fault.kind))) continue;
    auto& text = texts[fault.target];
    const auto own_seed = base::Random(seed, fault.text()).next() >> 2U;
    text += (text.empty() ? "" : " ") + text_of(fault, to_text(fault.kind), std::to_string(own_seed));
  }
  return texts;
}

}  // namespace

bool is_missing(const tools::RunScene& scene, const std::string& model) {
  const auto models = scene.simulator.models();
  return models && std::ranges::find(*models, model.substr(0, model.find("::"))) == models->end();
}

ActionRunner::ActionRunner(Actions actions, std::uint64_t seed, double duration_s)
    : actions_(std::move(actions)), seed_(seed), duration_s_(duration_s) {}

Result<void> ActionRunner::alter(tools::SavedSystem& system) const {
  for (const auto& [target, text] : texts_of(actions_.faults, Object::connector, seed_)) {
    const auto found = std::ranges::find_if(system.connectors, [&](const auto& one) { return one.id == target || one.name == target; });
    if (found == system.connectors.end()) return Error{"fault: the system has no connection " + base::in_quotes(target)};
    found->properties.emplace_back("dataport.fault", text);
  }
  return {};
}

std::vector<std::string> ActionRunner::properties() const {
  std::vector<std::string> properties;
  for (const auto& [target, text] : texts_of(actions_.faults, Object::component, seed_))
    properties.push_back(target + ":fault.on_execute=" + text);
  return properties;
}

std::string ActionRunner::written() const {
  std::string events, faults;
  for (const auto& event : actions_.events) events += "  - " + event.text + "\n";
  for (const auto& fault : actions_.faults) {
    const bool is_in_system = fault.object == Object::connector || (fault.object == Object::component && is_by_property(fault.kind));
    if (!is_in_system) faults += "  - " + fault.text() + "\n";
  }
  if (events.empty() && faults.empty()) return {};
  return "system: system.xml\nworld: world.sdf\nduration: " + base::format_number(duration_s_) + "\nseed: " + std::to_string(seed_) + "\n" +
         (events.empty() ? "" : "events:\n" + events) + (faults.empty() ? "" : "faults:\n" + faults);
}

std::vector<std::string> ActionRunner::simulator_options() const {
  std::vector<std::string> options;
  for (const auto& fault : actions_.faults) {
    if (fault.object != Object::sensor && fault.object != Object::actuator) continue;
    const bool is_halted = fault.object == Object::actuator && fault.kind == Kind::stuck;
    options.insert(options.end(), {"--fault", text_of(fault, is_halted ? "halted" : to_text(fault.kind), fault.target)});
  }
  return options;
}

std::vector<tools::Expectation> ActionRunner::watched() const {
  std::vector<tools::Expectation> watched;
  const auto add = [&](const Condition& condition) {
    for (const auto& value : condition.expression.values()) {
      if (value.kind != recorder::Expression::Value::Kind::port) continue;
      tools::Expectation expectation;
      expectation.kind = tools::Expectation::Kind::value;
      expectation.port = value.name;
      expectation.member = value.member;
      watched.push_back(std::move(expectation));
    }
  };
  for (const auto& condition : actions_.never) add(condition);
  for (const auto& condition : actions_.eventually) add(condition);
  for (const auto& event : actions_.events) {
    if (event.when) add(*event.when);
  }
  return watched;
}

bool ActionRunner::polls() const {
  const bool waits = std::ranges::any_of(actions_.events, [](const Event& event) { return event.when.has_value(); });
  return waits || !actions_.never.empty() || !actions_.eventually.empty();
}

Result<void> ActionRunner::begin(tools::RunScene& scene) {
  step_s_ = scene.simulator.step();
  look_every_ = std::max<std::int64_t>(1, std::llround(look_period_s / step_s_));
  const auto step_of = [&](double time) { return static_cast<std::int64_t>(std::llround(time / step_s_)); };
  for (std::size_t i = 0; i < actions_.events.size(); ++i) {
    if (actions_.events[i].at_s) timed_.push_back({step_of(*actions_.events[i].at_s), Timed::What::event, i});
  }
  for (std::size_t i = 0; i < actions_.faults.size(); ++i) {
    const auto& fault = actions_.faults[i];
    const bool is_ours = fault.object == Object::naming || (fault.object == Object::component && !is_by_property(fault.kind));
    if (!is_ours) continue;  // who has it times it
    timed_.push_back({step_of(fault.at_s), Timed::What::fault, i});
    auto end_s = fault.for_s ? std::optional(fault.at_s + *fault.for_s) : std::nullopt;
    // The naming service is back for the end, when the states of components are looked at.
    if (fault.object == Object::naming) end_s = std::min(end_s.value_or(duration_s_), duration_s_);
    if (end_s) timed_.push_back({step_of(*end_s), Timed::What::end_of_fault, i});
  }
  std::ranges::stable_sort(timed_, {}, &Timed::step);
  return act(scene, 0);
}

std::optional<std::int64_t> ActionRunner::next_stop(std::int64_t done) const {
  std::optional<std::int64_t> next;
  if (next_ < timed_.size()) next = std::max(timed_[next_].step, done + 1);
  if (polls()) {
    const auto look = (done / look_every_ + 1) * look_every_;
    next = next ? std::min(*next, look) : look;
  }
  return next;
}

Result<void> ActionRunner::act(tools::RunScene& scene, std::int64_t done) {
  while (next_ < timed_.size() && timed_[next_].step <= done) {
    if (const auto carried = carry_out(scene, timed_[next_++]); !carried) return carried;
  }
  if (done == 0 || !polls() || done % look_every_ != 0) return {};
  return look(scene, static_cast<double>(done) * step_s_);
}

void ActionRunner::note(const std::string& text) {
  if (std::ranges::find(notes_, text) == notes_.end()) notes_.push_back(text);
}

Result<void> ActionRunner::carry_out(tools::RunScene& scene, const Timed& timed) {
  if (timed.what == Timed::What::event) return happen(scene, actions_.events[timed.place]);
  const auto done = timed.what == Timed::What::fault ? start_fault(scene, timed.place) : end_fault(scene, timed.place);
  if (!done) return Error{"fault " + actions_.faults[timed.place].text() + ": " + done.error().message};
  return {};
}

Result<void> ActionRunner::happen(tools::RunScene& scene, const Event& event) {
  const auto done = carry_out_event(scene, event);
  if (!done) return Error{"event " + event.text + ": " + done.error().message};
  if (!done->empty()) note("event " + event.text + ": did nothing: " + *done);
  return {};
}

Result<void> ActionRunner::start_fault(tools::RunScene& scene, std::size_t place) {
  const auto& fault = actions_.faults[place];
  if (fault.object == Object::naming) {
    if (naming_gone_++ == 0) scene.set_naming(false);
    return {};
  }
  if (scene.is_away(fault.target)) {
    note("fault " + fault.text() + ": did nothing: component " + fault.target + " was killed and is not there again");
    return {};
  }
  if (const auto killed = scene.kill_host(fault.target); !killed) return killed;
  killed_.insert(place);
  for (const auto& component : scene.system.components) {
    if (scene.is_away(component.instance)) away_.insert(component.instance);
  }
  return {};
}

Result<void> ActionRunner::end_fault(tools::RunScene& scene, std::size_t place) {
  const auto& fault = actions_.faults[place];
  if (fault.object == Object::component) {
    if (killed_.erase(place) == 0) return {};
    if (naming_gone_ == 0) return restart(scene, fault.target);
    // Nobody would find it, nor it the others.
    note("fault " + fault.text() + ": its host restarts when the name server responds again");
    late_.push_back(fault.target);
    return {};
  }
  if (--naming_gone_ > 0) return {};
  scene.set_naming(true);
  for (const auto& instance : std::exchange(late_, {})) {
    if (const auto there = restart(scene, instance); !there) return there;
  }
  return {};
}

Result<void> ActionRunner::restart(tools::RunScene& scene, const std::string& instance) {
  const auto there = scene.restart_host(instance);
  std::erase_if(away_, [&](const std::string& one) { return !scene.is_away(one); });
  return there;
}

Result<void> ActionRunner::look(tools::RunScene& scene, double now_s) {
  for (std::size_t i = 0; i < actions_.events.size(); ++i) {
    const auto& event = actions_.events[i];
    if (!event.when || happened_.contains(i)) continue;
    const auto is_now = is_true(scene, *event.when, now_s);
    if (!is_now) return is_now.error();
    if (!*is_now) continue;
    happened_[i] = now_s;
    if (const auto done = happen(scene, event); !done) return done.error();
  }
  for (auto [conditions, moments] : {std::pair(&actions_.never, &broken_), std::pair(&actions_.eventually, &fulfilled_)}) {
    for (std::size_t i = 0; i < conditions->size(); ++i) {
      if (moments->contains(i)) continue;
      const auto is_now = is_true(scene, (*conditions)[i], now_s);
      if (!is_now) return is_now.error();
      if (*is_now) (*moments)[i] = now_s;
    }
  }
  return {};
}

namespace {

Result<std::optional<double>> look_up(tools::RunScene& scene, const recorder::Expression::Value& value,
                                      std::map<std::string, shm::Pose>& poses, double now_s) {
  using Number = std::optional<double>;
  // A model that does not exist, or does not exist yet, has no values.
  const auto none_if_missing = [&](const Error& error) { return is_missing(scene, value.name) ? Result<Number>(std::nullopt) : error; };
  switch (value.kind) {
    case recorder::Expression::Value::Kind::number:
      return Number(value.number);
    case recorder::Expression::Value::Kind::time:
      return Number(now_s);
    case recorder::Expression::Value::Kind::port: {
      const auto seen = scene.values.so_far(value.name, value.member);
      return seen && seen->mean() ? Number(seen->last) : std::nullopt;
    }
    case recorder::Expression::Value::Kind::state: {
      const auto view = scene.is_away(value.name) ? Error{"killed"} : scene.component(value.name, {.contexts = true});
      return view ? Number(view->state()) : std::nullopt;
    }
    case recorder::Expression::Value::Kind::touches: {
      const auto contacts = scene.simulator.contacts(value.name);
      return contacts ? Number(tools::is_touching(*contacts, value.member) ? 1 : 0) : none_if_missing(contacts.error());
    }
    case recorder::Expression::Value::Kind::pose:
      break;
  }
  if (!poses.contains(value.name)) {
    const auto pose = scene.simulator.pose(value.name);
    if (!pose) return none_if_missing(pose.error());
    poses.emplace(value.name, *pose);
  }
  return Number(tools::member_of(poses.at(value.name), value.member));
}

}  // namespace

Result<bool> ActionRunner::is_true(tools::RunScene& scene, const Condition& condition, double now_s) {
  if (now_s < condition.after_s) return false;
  std::map<std::string, shm::Pose> poses;  // one request for all members of a pose
  return condition.expression.holds([&](const auto& value) { return look_up(scene, value, poses, now_s); });
}

bool ActionRunner::excuses(const std::string& instance) const {
  return away_.contains(instance) || std::ranges::any_of(actions_.faults, [&](const Fault& fault) {
           return fault.object == Object::component && fault.target == instance && fault.kind != Kind::slow &&
                  !(fault.kind == Kind::kill && fault.for_s);
         });
}

std::vector<tools::Verdict> ActionRunner::verdicts() const {
  std::vector<tools::Verdict> verdicts;
  for (std::size_t i = 0; i < actions_.never.size(); ++i) {
    const auto broken = broken_.find(i);
    verdicts.push_back(
        {"never: " + actions_.never[i].text,
         broken == broken_.end() ? "" : "it was so at " + base::format_number(std::round(broken->second * 1e6) / 1e6) + " s"});
    if (broken != broken_.end()) verdicts.back().time = broken->second;
  }
  for (std::size_t i = 0; i < actions_.eventually.size(); ++i) {
    const auto& condition = actions_.eventually[i];
    const auto done = fulfilled_.find(i);
    const double limit = condition.within_s.value_or(duration_s_);
    std::string problem;
    if (done == fulfilled_.end()) problem = "never became true";
    if (done != fulfilled_.end() && done->second > limit + step_s_ / 2)
      problem = "became true at t = " + base::format_number(std::round(done->second * 1e6) / 1e6) + " s, too late";
    verdicts.push_back({"eventually: " + condition.text, problem});
    if (!problem.empty()) verdicts.back().time = limit;
  }
  return verdicts;
}

std::vector<tools::RunMark> ActionRunner::marks() const {
  std::vector<tools::RunMark> marks;
  for (const auto& fault : actions_.faults) {
    marks.push_back({fault.at_s, "fault", fault.text(), fault.target});
    if (fault.for_s) marks.push_back({fault.at_s + *fault.for_s, "restored", fault.text(), fault.target});
  }
  for (std::size_t i = 0; i < actions_.events.size(); ++i) {
    const auto& event = actions_.events[i];
    const auto on_condition = happened_.find(i);
    if (on_condition != happened_.end()) marks.push_back({on_condition->second, "event", event.text});
    if (event.at_s) marks.push_back({*event.at_s, "event", event.text});
  }
  return marks;
}

}  // namespace campaign
