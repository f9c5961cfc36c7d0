#include "system/session.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <unordered_map>

#include "base/text.h"

namespace tools {

Session::Session(CORBA::ORB_ptr orb, std::string server, std::chrono::milliseconds call_timeout,
                 std::chrono::milliseconds transition_timeout)
    : orb_(CORBA::ORB::_duplicate(orb)), server_(std::move(server)), call_timeout_(call_timeout), transition_timeout_(transition_timeout) {
  // "/HOST:PORT/" is how paths name it.
  while (server_.ends_with('/')) server_.pop_back();
  while (server_.starts_with('/')) server_.erase(0, 1);
}

Result<NamingTree> Session::tree(const std::string& path, bool only) const {
  auto address = parse_address(path, working_path());
  if (!address) return address.error();
  const bool elsewhere = address->is_absolute && !address->segments.empty();
  return NamingTree::read(orb_, elsewhere ? address->segments.front() : server_, call_timeout_,
                          {.address = only ? &*address : nullptr, .ids = nullptr});
}

Result<std::vector<ComponentView>> Session::peers_of(const ComponentView& component, const std::string& path) const {
  std::vector<RTC::PortService_var> ports;
  for (const auto& port : component.ports) {
    for (const auto& connector : port.connectors) {
      for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) ports.push_back(RTC::PortService::_duplicate(connector.ports[i]));
    }
  }
  if (ports.empty()) return std::vector<ComponentView>();
  // "INSTANCE.PORT"; empty when the port does not answer.
  std::vector<std::string> names(ports.size());
  in_parallel(ports.size(), call_timeout_, [&](std::size_t i) {
    try {
      const RTC::PortProfile_var profile = ports[i]->get_port_profile();
      names[i] = profile->name.in();
    } catch (const CORBA::Exception&) {  // whoever prints it says so
    }
  });
  std::set<std::string> instances;
  for (const auto& name : names) instances.insert(name.substr(0, name.rfind('.')));
  const auto address = parse_address(path, working_path());
  const bool elsewhere = address && address->is_absolute && !address->segments.empty();
  const auto found =
      NamingTree::read(orb_, elsewhere ? address->segments.front() : server_, call_timeout_, {.address = nullptr, .ids = &instances});
  if (!found) return found.error();
  auto components = read_components(*found, {}, call_timeout_);
  bool has_all = true;
  for (std::size_t i = 0; i < ports.size() && has_all; ++i)
    has_all = names[i].empty() || owner_of(ports[i], components).component != nullptr;
  if (has_all) return components;
  // Some are registered under other names than their own.
  const auto all = tree(path);
  if (!all) return all.error();
  return read_components(*all, {}, call_timeout_);
}

Result<ComponentView> Session::component(const std::string& path, Detail detail) const {
  auto address = parse_address(path, working_path());
  if (!address) return address.error();
  auto names = tree(path, true);
  if (!names) return names.error();
  auto entry = names->find_component(*address);
  if (!entry) return entry.error();
  const CallLimit limited(call_timeout_);
  auto component = read_component(**entry, detail);
  if (!component.problem.empty()) return Error{"component " + component.path + " " + component.problem};
  return component;
}

namespace {

// The ids that the last segment of an address can mean.
std::array<std::string, 3> ids_of(const Address& address) {
  const auto& last = address.segments.back();
  return {split_kind(last).first, last, last.substr(0, last.rfind('.'))};
}

using EntriesById = std::unordered_multimap<std::string, const Entry*>;

// For addresses of one segment, as NAME or NAME.rtc: the one thing of that name. Nullptr: none or several, or another form.
const Entry* only_entry(const EntriesById& entries, const Address& address) {
  if (address.is_absolute || address.segments.size() != 1) return nullptr;
  const Entry* only = nullptr;
  for (const auto& id : ids_of(address)) {
    for (auto [at, end] = entries.equal_range(id); at != end; ++at) {
      if (at->second == only || !matches(address.segments.back(), at->second->id, at->second->kind_text)) continue;
      if (only) return nullptr;
      only = at->second;
    }
  }
  return only && only->kind == EntryKind::component && only->health == Health::alive ? only : nullptr;
}

}  // namespace

std::vector<Result<ComponentView>> Session::components(const std::vector<std::string>& paths, Detail detail) const {
  std::set<std::string> ids;
  for (const auto& path : paths) {
    const auto address = parse_address(path, working_path());
    if (!address || address->segments.empty()) continue;
    for (const auto& id : ids_of(*address)) ids.insert(id);
  }
  const auto names = NamingTree::read(orb_, server_, call_timeout_, {.address = nullptr, .ids = &ids});
  std::vector<std::optional<ComponentView>> views(paths.size());
  if (names && paths.size() > 1) {
    EntriesById entries;
    for (const auto* entry : names->objects()) entries.emplace(entry->id, entry);
    in_parallel(paths.size(), call_timeout_, [&](std::size_t i) {
      const auto address = parse_address(paths[i], working_path());
      if (!address) return;
      const Entry* entry = only_entry(entries, *address);
      if (!entry) {
        const auto found = names->find_component(*address);
        if (!found) return;
        entry = *found;
      }
      auto view = read_component(*entry, detail);
      if (view.problem.empty()) views[i] = std::move(view);
    });
  }
  std::optional<NamingTree> listed;  // all names, so that errors say what there is instead
  std::vector<Result<ComponentView>> results;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (views[i]) {
      results.emplace_back(std::move(*views[i]));
      continue;
    }
    const auto address = parse_address(paths[i], working_path());
    const bool is_here = names && address && !address->is_absolute && !address->segments.empty();
    if (is_here && !listed) {
      auto all = NamingTree::read(orb_, server_, call_timeout_, {.address = &*address, .ids = nullptr});
      if (all) listed = std::move(*all);
    }
    const auto found = is_here && listed ? listed->candidates(*address) : Result<std::vector<const Entry*>>(Error{""});
    if (found && found->empty()) {
      results.emplace_back(listed->find_component(*address).error());
    } else {
      results.push_back(component(paths[i], detail));  // on another name server, ambiguous, or with a reason of its own
    }
  }
  return results;
}

Result<Session::Port> Session::port(const std::string& path, bool with_connectors) const {
  auto address = parse_address(path, working_path());
  if (!address) return address.error();
  if (address->port.empty()) return Error{"path " + base::in_quotes(path) + ": names no port, expected COMPONENT:PORT"};
  auto view = component(path, {.connectors = with_connectors});
  if (!view) return view.error();
  const auto* port = view->port(address->port);
  if (!port) {
    std::vector<std::string> names;
    for (const auto& candidate : view->ports) names.push_back(candidate.name);
    return Error{"component " + view->path + ": has no port " + base::in_quotes(address->port) +
                 (names.empty() ? ", it has none" : "; it has " + base::join(names, ", "))};
  }
  const auto copy = *port;
  return Port{std::move(*view), copy};
}

}  // namespace tools
