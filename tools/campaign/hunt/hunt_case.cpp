#include "campaign/hunt/hunt_case.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>

#include "base/text.h"
#include "campaign/plan/grammar.h"
#include "run/flow_text.h"

namespace campaign {
namespace {

namespace fs = std::filesystem;

// A tenth of a second is exact enough to find things, and easy to read.
double rounded(double seconds) { return std::round(seconds * 10) / 10; }

// As often the utmost as anything between: most of what can break breaks there.
double amount(Fault::Kind kind, base::Random& random) {
  const bool is_utmost = random.below(2) == 0;
  switch (kind) {
    case Fault::Kind::bias:
      return is_utmost ? (random.below(2) == 0 ? -5 : 5) : std::round((random.uniform() * 2 - 1) * 100) / 100;
    case Fault::Kind::noise:
      return std::round(random.uniform() * 100) / 100;
    case Fault::Kind::latency:
    case Fault::Kind::delay:
      return static_cast<double>(1 + random.below(20));
    case Fault::Kind::slow:
      return 0.001;
    case Fault::Kind::missing:
    case Fault::Kind::dropout:
    case Fault::Kind::drop:
    case Fault::Kind::duplicate:
    case Fault::Kind::reorder:
      return is_utmost ? 1 : std::round(random.uniform() * 20) / 20;
    case Fault::Kind::weak:
      return is_utmost ? 0 : std::round(random.uniform() * 20) / 20;
    default:
      return usual_amount(kind).value_or(0);
  }
}

// Of the same component, at no time of its own; null without one.
const Event* activation_after(const Event& event, const std::vector<Event>& events) {
  const auto is_free = [](const Event& one) { return !one.at_s && !one.when; };
  if (event.kind != Event::Kind::deactivate || !is_free(event)) return nullptr;
  const auto found = std::ranges::find_if(
      events, [&](const Event& other) { return other.kind == Event::Kind::activate && other.target == event.target && is_free(other); });
  return found == events.end() ? nullptr : &*found;
}

}  // namespace

CaseMaker::CaseMaker(const Campaign& campaign, const std::vector<HuntTarget>& targets) : campaign_(campaign) {
  for (const auto& target : targets) {
    for (const auto kind : target.kinds) choices_.push_back({nullptr, nullptr, target.object, kind, target.name});
  }
  for (const auto& event : campaign.plan().hunt.events) {
    choices_.push_back({&event, nullptr, {}, {}, {}});
    if (const auto* again = activation_after(event, campaign.plan().hunt.events)) choices_.push_back({&event, again, {}, {}, {}});
  }
}

std::size_t HuntCase::actions() const {
  std::size_t count = events.size() + faults.size();
  std::set<std::string> inactive;
  for (const auto& event : events) {
    if (event.kind == Event::Kind::deactivate) inactive.insert(event.target);
    if (event.kind == Event::Kind::activate && inactive.erase(event.target) > 0) --count;
  }
  return count;
}

// The first moment is special: nothing has been measured, sent or remembered yet.
double CaseMaker::time(base::Random& random, double duration_s) const {
  return random.below(4) == 0 ? 0 : rounded(random.uniform() * std::max(0.1, duration_s - 0.1));
}

const CaseMaker::Choice& CaseMaker::draw(base::Random& random) {
  if (deck_.empty()) {
    deck_.resize(choices_.size());
    std::iota(deck_.begin(), deck_.end(), 0);
    for (std::size_t i = deck_.size(); i > 1; --i) std::swap(deck_[i - 1], deck_[random.below(i)]);
  }
  const auto& drawn = choices_[deck_.back()];
  deck_.pop_back();
  return drawn;
}

void CaseMaker::add_event(HuntCase& to, const Event& wanted, double from_s, base::Random& random) const {
  Event event = wanted;
  if (!event.at_s && !event.when) event.at_s = rounded(from_s + time(random, to.duration_s - from_s));
  to.events.push_back(std::move(event));
}

// What harms only after something else: an activation after the deactivation that a case has already.
void CaseMaker::add_consequence(HuntCase& to, base::Random& random) const {
  const auto& events = campaign_.plan().hunt.events;
  double last_s = 0;
  for (const auto& event : to.events) last_s = std::max(last_s, event.at_s.value_or(0));
  for (const auto& fault : to.faults) last_s = std::max(last_s, fault.at_s);
  add_event(to, events[random.below(events.size())], last_s, random);
}

// What a component keeps from one activation to the next may harm only in the third or fourth.
void CaseMaker::add_restarts(HuntCase& to, const Choice& choice, base::Random& random) const {
  const std::size_t most = campaign_.plan().hunt.most, room = most - std::min(most, to.actions());
  const std::size_t times = 1 + random.below(std::max<std::size_t>(room, 1));
  double now_s = time(random, to.duration_s / 2);
  for (std::size_t i = 0; i < times; ++i) {
    for (const Event* wanted : {choice.event, choice.again}) {
      to.events.push_back(*wanted);
      to.events.back().at_s = now_s;
      now_s = rounded(now_s + 0.1 + random.uniform() * to.duration_s / (4.0 * static_cast<double>(times)));
    }
  }
}

void CaseMaker::add_action(HuntCase& to, base::Random& random) {
  const auto& choice = draw(random);
  if (choice.again != nullptr) return add_restarts(to, choice, random);
  if (choice.event != nullptr) return add_event(to, *choice.event, 0, random);
  Fault fault;
  fault.object = choice.object;
  fault.target = choice.target;
  fault.kind = choice.kind;
  fault.at_s = time(random, to.duration_s);
  if (random.below(2) == 0) fault.for_s = std::max(0.1, rounded(random.uniform() * (to.duration_s - fault.at_s)));
  fault.amount = amount(fault.kind, random);
  to.faults.push_back(std::move(fault));
}

HuntCase CaseMaker::fresh(base::Random& random) {
  HuntCase made;
  made.duration_s = campaign_.plan().run.duration_s;
  const auto row = campaign_.row(1 + random.below(campaign_.rows()));
  if (row) made.row = *row;
  made.row.seed = 1 + random.below(1000);
  constexpr std::uint64_t quiet = 8;  // one in so many is left alone: its start and its parameters may be enough
  const auto actions = has_actions() && random.below(quiet) > 0 ? 1 + random.below(campaign_.plan().hunt.most) : 0;
  const bool is_story = actions > 1 && campaign_.plan().hunt.events.size() > 1 && random.below(3) == 0;  // events one after the other
  while (made.actions() < actions) is_story ? add_consequence(made, random) : add_action(made, random);
  return made;
}

HuntCase CaseMaker::changed(const HuntCase& from, base::Random& random) {
  HuntCase made = from;
  const auto way = random.below(4);
  if (way == 0 || made.actions() == 0) made.row.seed = 1 + random.below(1000);
  if (way == 1 && !made.faults.empty()) {
    auto& fault = made.faults[random.below(made.faults.size())];
    fault.at_s = time(random, made.duration_s);
    fault.amount = amount(fault.kind, random);
  }
  if (way == 2 && !made.faults.empty()) made.faults.erase(made.faults.begin() + static_cast<long>(random.below(made.faults.size())));
  if (!has_actions() || made.actions() >= campaign_.plan().hunt.most) return made;
  const bool is_event = !campaign_.plan().hunt.events.empty() && random.below(2) == 0;
  is_event ? add_consequence(made, random) : add_action(made, random);
  return made;
}

namespace {

// Of a shorter run than the plan's: what it does not get to cannot be meant.
void shorten(std::vector<Condition>& conditions, double duration_s) {
  std::erase_if(conditions, [&](const Condition& condition) { return condition.after_s > duration_s; });
  for (auto& condition : conditions) {
    if (condition.within_s.value_or(0) <= duration_s) continue;
    condition.within_s.reset();
    auto node = YAML::Load(condition.text);
    node.remove("within");
    condition.text = tools::flow_text(node);
  }
}

}  // namespace

Actions actions_of(const Campaign& campaign, const HuntCase& tried) {
  const auto& plan = campaign.plan();
  Actions actions{plan.events, plan.faults, plan.never, plan.eventually};
  actions.events.insert(actions.events.end(), tried.events.begin(), tried.events.end());
  actions.faults.insert(actions.faults.end(), tried.faults.begin(), tried.faults.end());
  const double end_s = tried.duration_s;
  std::erase_if(actions.events,
                [&](const Event& event) { return event.at_s.value_or(0) > end_s || (event.when && event.when->after_s > end_s); });
  std::erase_if(actions.faults, [&](const Fault& fault) { return fault.at_s >= end_s; });
  shorten(actions.never, end_s);
  shorten(actions.eventually, end_s);
  return actions;
}

namespace {

// An event as it stands in the plan, at a time.
std::string event_text(const Event& event) {
  auto node = YAML::Load(event.text);
  if (event.at_s) node["at"] = base::format_number(*event.at_s);
  return tools::flow_text(node);
}

}  // namespace

std::string plan_text(const Campaign& campaign, const HuntCase& tried) {
  const auto& plan = campaign.plan();
  const auto quoted = [](const std::string& text) {
    YAML::Emitter out;
    out << YAML::DoubleQuoted << text;
    return std::string(out.c_str());
  };
  const auto path = [&](const std::string& file) { return quoted(fs::absolute(file).lexically_normal().string()); };
  std::string text = "system: " + path(plan.run.system) + "\nworld: " + path(plan.run.world) +
                     "\nduration: " + base::format_number(tried.duration_s) + "\nseed: " + std::to_string(tried.row.seed) + "\n";
  if (!plan.run.expectations.empty()) text += "expect: " + path(plan.run.expectations) + "\n";
  if (!plan.expect_text.empty()) text += "expect:\n" + plan.expect_text + "\n";
  if (!tried.row.values.empty()) text += "vary:\n";
  for (const auto& [name, value] : tried.row.values) text += "  " + quoted(name) + ": [" + quoted(value) + "]\n";
  const auto add_list = [&](const char* key, const std::vector<std::string>& items, bool are_quoted) {
    if (!items.empty()) text += std::string(key) + ":\n";
    for (const auto& item : items) text += "  - " + (are_quoted ? quoted(item) : item) + "\n";
  };
  const auto actions = actions_of(campaign, tried);
  std::vector<std::string> events, faults, never, eventually;
  for (const auto& event : actions.events) events.push_back(event_text(event));
  for (const auto& fault : actions.faults) faults.push_back(fault.text());
  for (const auto& condition : actions.never) never.push_back(condition.text);
  for (const auto& condition : actions.eventually) eventually.push_back(condition.text);
  add_list("events", events, false);
  add_list("faults", faults, false);
  add_list("never", never, false);
  add_list("eventually", eventually, false);
  add_list("for", plan.run.lists, true);
  add_list("properties", plan.run.properties, true);
  std::vector<std::string> modules, resources;
  for (const auto& folder : plan.run.module_paths) modules.push_back(fs::absolute(folder).string());
  for (const auto& folder : plan.run.resource_paths) resources.push_back(fs::absolute(folder).string());
  add_list("module_path", modules, true);
  add_list("resource_path", resources, true);
  if (plan.run.one_process_each) text += "one_process_each: true\n";
  return text + "hang_timeout: " + base::format_number(plan.run.hang_timeout_s) + "\ninvariants: true\n";
}

std::string text_of(const HuntCase& tried) {
  std::vector<std::string> words{"seed " + std::to_string(tried.row.seed)};
  for (const auto& [name, value] : tried.row.values) words.push_back(name + " " + value);
  for (const auto& event : tried.events) words.push_back(event_text(event));
  for (const auto& fault : tried.faults) words.push_back(fault.text());
  return base::join(words, "; ");
}

}  // namespace campaign
