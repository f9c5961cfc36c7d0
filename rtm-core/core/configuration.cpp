#include "core/configuration.h"

#include <algorithm>
#include <unordered_map>

#include "base/nondeterminism.h"
#include "base/text.h"
#include "base/tick.h"
#include "core/key_limits.h"

namespace rt {

namespace {

const std::string* find_value(const Configuration::Set& set, std::string_view name) {
  for (const auto& [key, value] : set.values)
    if (key == name) return &value;
  return nullptr;
}

}  // namespace

bool Configuration::has_room(const State& state, const Set& further) {
  const auto octets_of = [](const Set& set) {
    constexpr std::size_t around_it = 64;  // each text takes some
    std::size_t sum = set.id.size() + around_it;
    for (const auto& [name, value] : set.values) sum += name.size() + value.size() + around_it;
    return sum;
  };
  std::size_t sum = octets_of(further);
  for (const Set& set : state.sets) sum += octets_of(set);
  const bool is_new = find(state, further.id) == nullptr;
  return sum <= entry_limits.configuration_octets && (!is_new || state.sets.size() < entry_limits.configuration_sets);
}

Configuration::Configuration() { shared_.lock()->state.sets.push_back({"default", {}}); }

Configuration::Set* Configuration::find(State& state, std::string_view id) {
  const auto it = std::find_if(state.sets.begin(), state.sets.end(), [&](const Set& set) { return set.id == id; });
  return it == state.sets.end() ? nullptr : &*it;
}

const Configuration::Set* Configuration::find(const State& state, std::string_view id) { return find(const_cast<State&>(state), id); }

std::optional<Configuration::EpochTime> Configuration::arrival_now() {
  if (base::tick_in_lock_step()) return std::nullopt;
  const auto clock = base::lock_step_clock();
  if (!clock || clock->phase_counter() == 0 || clock->stands_still()) return std::nullopt;
  return EpochTime{clock->epoch(), clock->now()};
}

std::optional<Configuration::EpochTime> Configuration::tick_now() {
  const base::Tick* tick = base::tick_in_lock_step();
  const auto clock = tick ? base::lock_step_clock() : nullptr;
  return clock ? std::optional(EpochTime{clock->epoch(), tick->time()}) : std::nullopt;
}

// What a tick sees, or the newest for who is in none.
Configuration::State& Configuration::state_at(const std::optional<EpochTime>& tick, Data& data) {
  if (data.arrival && tick && data.arrival->epoch == tick->epoch && data.arrival->time >= tick->time) return *data.before;
  data.arrival.reset();
  data.before.reset();
  return data.state;
}

template <class Change>
bool Configuration::change(Change change) {
  const auto arrival = arrival_now();
  auto data = shared_.lock();
  if (arrival && data->arrival != arrival) {
    data->before = data->state;
    data->arrival = arrival;
  } else if (!arrival && data->before) {
    change(*data->before);
  }
  return change(data->state);
}

void Configuration::merge(Set& to, const Set& from) {
  std::unordered_map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < to.values.size(); ++i) known.emplace(to.values[i].first, i);
  for (const auto& [name, value] : from.values) {
    const auto [at, is_new] = known.emplace(name, to.values.size());
    if (is_new)
      to.values.emplace_back(name, value);
    else
      to.values[at->second].second = value;
  }
}

bool Configuration::bind(const std::string& name, const std::string& default_value, Assign assign) {
  const auto shared_assign = std::make_shared<const Assign>(std::move(assign));
  std::vector<Assignment> initial;
  {
    auto data = shared_.lock();
    for (const Parameter& parameter : data->parameters)
      if (parameter.name == name) return false;
    data->parameters.push_back({name, default_value, shared_assign});
    const Set* active = find(data->state, data->state.active);
    initial = assignments(*data, active ? *active : Set{}, name, false);
  }
  run({}, initial);
  return true;
}

bool Configuration::unbind(std::string_view name) {
  std::vector<Parameter> removed;  // destroyed without the lock
  auto data = shared_.lock();
  const auto it = std::find_if(data->parameters.begin(), data->parameters.end(), [&](const Parameter& p) { return p.name == name; });
  if (it == data->parameters.end()) return false;
  removed.push_back(std::move(*it));
  data->parameters.erase(it);
  return true;
}

bool Configuration::is_bound(std::string_view name) const {
  const auto data = shared_.lock();
  return std::any_of(data->parameters.begin(), data->parameters.end(), [&](const Parameter& p) { return p.name == name; });
}

std::vector<std::string> Configuration::bound_names() const {
  std::vector<std::string> names;
  const auto data = shared_.lock();
  for (const Parameter& parameter : data->parameters) names.push_back(parameter.name);
  return names;
}

std::vector<Configuration::Assignment> Configuration::assignments(Data& data, const Set& set, const std::optional<std::string>& only,
                                                                  bool changed_only) {
  std::vector<Assignment> list;
  for (Parameter& parameter : data.parameters) {
    if (only && parameter.name != *only) continue;
    const std::string* value = find_value(set, parameter.name);
    if (!value && !parameter.assigned) value = &parameter.default_value;
    if (!value || (changed_only && parameter.assigned == *value)) continue;
    parameter.assigned = *value;
    list.push_back({parameter.name, parameter.assign, *value, parameter.default_value});
  }
  return list;
}

std::optional<Configuration::Update> Configuration::run(const std::string& set, const std::vector<Assignment>& assignments) {
  Update update{set, {}, {}};
  for (const Assignment& assignment : assignments) {
    if (!(*assignment.assign)(assignment.value.c_str())) {
      (*assignment.assign)(assignment.default_value.c_str());
      update.refused.push_back("configuration set " + set + ": parameter " + assignment.name + " cannot be " +
                               base::in_quotes(assignment.value) + "; it is " + base::in_quotes(assignment.default_value) + " instead");
    }
    update.parameters.push_back(assignment.name);
  }
  return update;
}

std::optional<Configuration::Update> Configuration::update() {
  if (!has_changed()) return std::nullopt;  // as nearly always
  const auto tick = tick_now();
  std::string id;
  std::vector<Assignment> list;
  {
    auto data = shared_.lock();
    State& state = state_at(tick, *data);
    if (!state.changed || !state.is_active) return std::nullopt;
    state.changed = false;
    const Set* set = find(state, state.active);
    if (!set) return std::nullopt;
    id = set->id;
    list = assignments(*data, *set, std::nullopt, true);
  }
  return run(id, list);
}

std::optional<Configuration::Update> Configuration::update_from(const std::string& id, const std::optional<std::string>& parameter) {
  const auto tick = tick_now();
  std::vector<Assignment> list;
  {
    auto data = shared_.lock();
    const Set* set = find(state_at(tick, *data), id);
    if (!set) return std::nullopt;
    list = assignments(*data, *set, parameter, false);
    if (parameter && list.empty()) return std::nullopt;
  }
  return run(id, list);
}

std::string Configuration::active_id() const { return shared_.lock()->state.active; }
bool Configuration::is_active() const { return shared_.lock()->state.is_active; }
bool Configuration::has_changed() const { return shared_.lock()->state.changed; }
bool Configuration::has(std::string_view id) const { return find(shared_.lock()->state, id) != nullptr; }
std::vector<Configuration::Set> Configuration::sets() const { return shared_.lock()->state.sets; }

std::optional<Configuration::Set> Configuration::set(std::string_view id) const {
  const auto data = shared_.lock();
  const Set* set = find(data->state, id);
  return set ? std::optional(*set) : std::nullopt;
}

void Configuration::load(const Set& set) {
  change([&](State& state) {
    Set* known = find(state, set.id);
    if (!known) known = &state.sets.emplace_back(Set{set.id, {}});
    merge(*known, set);
    return state.changed = true;
  });
}

bool Configuration::set_values(const Set& set) {
  return change([&](State& state) {
    if (!has_room(state, set)) return false;
    Set* known = find(state, set.id);
    if (!known) {
      if (set.id.empty()) return false;
      known = &state.sets.emplace_back(Set{set.id, {}});
      state.added.push_back(set.id);
    }
    merge(*known, set);
    state.changed = true;
    state.is_active = false;
    return true;
  });
}

bool Configuration::add(const Set& set) {
  if (set.id.empty()) return false;
  return change([&](State& state) {
    if (find(state, set.id) || !has_room(state, set)) return false;
    state.sets.push_back(set);
    state.added.push_back(set.id);
    return true;
  });
}

bool Configuration::remove(std::string_view id) {
  return change([&](State& state) {
    if (id == state.active || std::erase(state.added, id) == 0) return false;
    std::erase_if(state.sets, [&](const Set& set) { return set.id == id; });
    return true;
  });
}

bool Configuration::activate(std::string_view id) {
  if (id.empty() || id.front() == '_') return false;
  return change([&](State& state) {
    if (!find(state, id)) return false;
    state.active = id;
    state.is_active = true;
    state.changed = true;
    return true;
  });
}

}  // namespace rt
