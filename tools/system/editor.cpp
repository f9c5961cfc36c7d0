#include "system/editor.h"

#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/text.h"

namespace editor {

Editor::Editor(CORBA::ORB_ptr orb, std::string server, bool json, std::chrono::milliseconds limit)
    : orb_(CORBA::ORB::_duplicate(orb)), server_(std::move(server)), json_(json), limit_(limit) {
  // "/HOST:PORT/" is how paths name it.
  while (server_.ends_with('/')) server_.pop_back();
  while (server_.starts_with('/')) server_.erase(0, 1);
}

Result<NamingTree> Editor::tree(const std::string& path, bool only) const {
  auto address = parse_address(path, working_path());
  if (!address) return address.error();
  const bool elsewhere = address->is_absolute && !address->segments.empty();
  return NamingTree::read(orb_, elsewhere ? address->segments.front() : server_, limit_, only ? &*address : nullptr);
}

Result<ComponentView> Editor::component(const std::string& path, Detail detail) const {
  auto address = parse_address(path, working_path());
  if (!address) return address.error();
  auto names = tree(path, true);
  if (!names) return names.error();
  auto entry = names->find_component(*address);
  if (!entry) return entry.error();
  const CallLimit limited(limit_);
  auto component = read_component(**entry, detail);
  if (!component.problem.empty()) return Error{"component " + component.path + " " + component.problem};
  return component;
}

Result<Editor::Port> Editor::port(const std::string& path, bool with_connectors) const {
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
                 (names.empty() ? ", it has none at all" : "; it has " + base::join(names, ", "))};
  }
  const auto copy = *port;
  return Port{std::move(*view), copy};
}

void Editor::fail(const Error& error) {
  if (!is_silent_) {
    std::cout.flush();
    std::cerr << "rtse: " + base::printable(error.message, "\n\t") + "\n";  // texts of others are in it
  }
  failed_ = true;
  if (problem_.empty()) problem_ = error.message;
}

void Editor::print(const nlohmann::ordered_json& value) const {
  std::cout << value.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';  // texts of others may be no UTF-8
}

}  // namespace editor
