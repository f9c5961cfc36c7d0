#include "system/profile/system_template.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "base/text.h"

namespace tools {
namespace {

constexpr std::size_t max_entries = 1'000'000;  // components, or connections

// ---- all texts of an entry that a name can stand in ----

template <class F>
void each_text(NamedValues& values, const F& visit) {
  for (auto& [key, value] : values) visit(key), visit(value);
}

template <class F>
void each_text(SavedComponent& component, const F& visit) {
  for (auto* text : {&component.id, &component.path_uri, &component.active_set, &component.instance}) visit(*text);
  for (auto* ports : {&component.data_ports, &component.service_ports}) {
    for (auto& port : *ports) visit(port.name);
  }
  for (auto& set : component.configuration_sets) visit(set.id), each_text(set.values, visit);
  for (auto& context : component.contexts) visit(context.rate), visit(context.state);
  for (auto& participant : component.participants) visit(participant);
  each_text(component.properties, visit);
}

template <class F>
void each_text(SavedTarget& target, const F& visit) {
  for (auto* text : {&target.component_id, &target.instance, &target.port_name, &target.path_uri}) visit(*text);
}

template <class F>
void each_text(SavedConnector& connector, const F& visit) {
  for (auto* text : {&connector.id, &connector.name, &connector.data_type, &connector.interface_type, &connector.subscription_type})
    visit(*text);
  each_text(connector.source, visit);
  each_text(connector.target, visit);
  each_text(connector.properties, visit);
}

template <class F>
void each_text(SavedTurn& turn, const F& visit) {
  for (auto* text : {&turn.instance, &turn.path_uri, &turn.component_id}) visit(*text);
}

template <class F>
void each_text(std::string& text, const F& visit) {
  visit(text);
}

template <class T>
bool has_name(const T& entry, const base::NameList& list) {
  bool found = false;
  auto copy = entry;
  each_text(copy, [&](const std::string& text) { found = found || list.is_in(text); });
  return found;
}

// The connections of a saved system have unique ids, and so must those of a template that says nothing in them.
void make_unique(SavedConnector& connector, const SavedConnector& of, const std::string& value) {
  if (!connector.id.empty() && connector.id == of.id) connector.id += "-" + value;
}
template <class T>
void make_unique(T&, const T&, const std::string&) {}

// Neighbours are repeated together: all of the first robot, all of the second. False: too many.
template <class T>
bool repeat(std::vector<T>& entries, const base::NameList& list, bool& is_used) {
  std::vector<T> all;
  for (auto at = entries.begin(); at != entries.end();) {
    const auto end = std::find_if_not(at, entries.end(), [&](const T& entry) { return has_name(entry, list); });
    if (at == end) {
      all.push_back(std::move(*at++));
      continue;
    }
    is_used = true;
    if (all.size() + static_cast<std::size_t>(end - at) * list.values.size() > max_entries) return false;
    for (std::size_t i = 0; i < list.values.size(); ++i) {
      for (auto of = at; of != end; ++of) {
        all.push_back(*of);
        each_text(all.back(), [&](std::string& text) { text = list.filled(std::move(text), i); });
        make_unique(all.back(), *of, list.values[i]);
      }
    }
    at = end;
  }
  entries = std::move(all);
  return true;
}

bool is_name(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

// The first name in braces, without them; empty: none.
std::string open_name(const std::string& text) {
  for (auto begin = text.find('{'); begin != std::string::npos; begin = text.find('{', begin + 1)) {
    const auto end = text.find('}', begin);
    if (end == std::string::npos) break;
    auto name = text.substr(begin + 1, end - begin - 1);
    if (name.ends_with('#')) name.pop_back();
    if (is_name(name)) return name;
  }
  return "";
}

base::Result<void> check_names(const SavedSystem& system, const std::string& file) {
  std::set<std::string> instances;
  for (const auto& component : system.components) {
    if (const auto name = open_name(component.instance); !name.empty())
      return base::Error{"system " + base::in_quotes(file) + ": component " + component.instance + " is a template; expected --for " +
                         name + "=LIST, for example --for " + name + "=r0..r9"};
    if (!instances.insert(component.instance).second)
      return base::Error{"system " + base::in_quotes(file) + ": two components are called " + base::in_quotes(component.instance) +
                         "; expected the name in braces in each instance name"};
  }
  return {};
}

}  // namespace

base::Result<SavedSystem> filled_in(SavedSystem system, const std::vector<std::string>& lists, const std::string& file) {
  std::set<std::string> names;
  for (auto text = lists.rbegin(); text != lists.rend(); ++text) {  // the first list is the outer one
    const auto list = base::NameList::parse(*text);
    if (!list) return list.error();
    if (!names.insert(list->name).second) return base::Error{"--for " + base::in_quotes(*text) + ": " + list->name + " has a list already"};
    bool is_used = false;
    const bool fits = repeat(system.components, *list, is_used) && repeat(system.connectors, *list, is_used) &&
                      repeat(system.start_up, *list, is_used) && repeat(system.shut_down, *list, is_used);
    if (!fits) return base::Error{"--for " + base::in_quotes(*text) + ": makes more than 1000000 components or connections"};
    if (!is_used)
      return base::Error{"--for " + base::in_quotes(*text) + ": system " + base::in_quotes(file) + " does not contain {" + list->name +
                         "}"};
  }
  if (const auto good = check_names(system, file); !good) return good.error();
  return system;
}

base::Result<std::vector<std::string>> filled_in(std::vector<std::string> texts, const std::vector<std::string>& lists) {
  for (auto text = lists.rbegin(); text != lists.rend(); ++text) {  // the first list is the outer one
    const auto list = base::NameList::parse(*text);
    if (!list) return list.error();
    bool is_used = false;  // need not be: the names of the system count
    if (!repeat(texts, *list, is_used)) return base::Error{"--for " + base::in_quotes(*text) + ": makes more than 1000000 texts"};
  }
  return texts;
}

base::Result<SavedSystem> read_system(const std::string& file, const std::vector<std::string>& lists) {
  auto system = read_system(file);
  if (!system) return system.error();
  return filled_in(std::move(*system), lists, file);
}

}  // namespace tools
