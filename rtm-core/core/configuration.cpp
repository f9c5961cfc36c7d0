#include "core/configuration.h"

#include <algorithm>
#include <unordered_map>

#include "base/text.h"

namespace rt {

namespace {

const std::string* find_value(const Configuration::Set& set, std::string_view name) {
  for (const auto& [key, value] : set.values)
    if (key == name) return &value;
  return nullptr;
}

}  // namespace

Configuration::Configuration() { shared_.lock()->sets.push_back({"default", {}}); }

Configuration::Set* Configuration::find(Data& data, std::string_view id) {
  const auto it = std::find_if(data.sets.begin(), data.sets.end(), [&](const Set& set) { return set.id == id; });
  return it == data.sets.end() ? nullptr : &*it;
}

const Configuration::Set* Configuration::find(const Data& data, std::string_view id) { return find(const_cast<Data&>(data), id); }

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
    const Set* active = find(*data, data->active);
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
  std::string id;
  std::vector<Assignment> list;
  {
    auto data = shared_.lock();
    if (!data->changed || !data->is_active) return std::nullopt;
    data->changed = false;
    const Set* set = find(*data, data->active);
    if (!set) return std::nullopt;
    id = set->id;
    list = assignments(*data, *set, std::nullopt, true);
  }
  return run(id, list);
}

std::optional<Configuration::Update> Configuration::update_from(const std::string& id, const std::optional<std::string>& parameter) {
  std::vector<Assignment> list;
  {
    auto data = shared_.lock();
    const Set* set = find(*data, id);
    if (!set) return std::nullopt;
    list = assignments(*data, *set, parameter, false);
    if (parameter && list.empty()) return std::nullopt;
  }
  return run(id, list);
}

std::string Configuration::active_id() const { return shared_.lock()->active; }
bool Configuration::is_active() const { return shared_.lock()->is_active; }
bool Configuration::has_changed() const { return shared_.lock()->changed; }
bool Configuration::has(std::string_view id) const { return find(*shared_.lock(), id) != nullptr; }
std::vector<Configuration::Set> Configuration::sets() const { return shared_.lock()->sets; }

std::optional<Configuration::Set> Configuration::set(std::string_view id) const {
  const auto data = shared_.lock();
  const Set* set = find(*data, id);
  return set ? std::optional(*set) : std::nullopt;
}

void Configuration::load(const Set& set) {
  auto data = shared_.lock();
  Set* known = find(*data, set.id);
  if (!known) known = &data->sets.emplace_back(Set{set.id, {}});
  merge(*known, set);
  data->changed = true;
}

bool Configuration::set_values(const Set& set) {
  auto data = shared_.lock();
  Set* known = find(*data, set.id);
  if (!known) {
    if (set.id.empty()) return false;
    known = &data->sets.emplace_back(Set{set.id, {}});
    data->added.push_back(set.id);
  }
  merge(*known, set);
  data->changed = true;
  data->is_active = false;
  return true;
}

bool Configuration::add(const Set& set) {
  if (set.id.empty()) return false;
  auto data = shared_.lock();
  if (find(*data, set.id)) return false;
  data->sets.push_back(set);
  data->added.push_back(set.id);
  return true;
}

bool Configuration::remove(std::string_view id) {
  auto data = shared_.lock();
  if (id == data->active || std::erase(data->added, id) == 0) return false;
  std::erase_if(data->sets, [&](const Set& set) { return set.id == id; });
  return true;
}

bool Configuration::activate(std::string_view id) {
  if (id.empty() || id.front() == '_') return false;
  auto data = shared_.lock();
  if (!find(*data, id)) return false;
  data->active = id;
  data->is_active = true;
  data->changed = true;
  return true;
}

}  // namespace rt
