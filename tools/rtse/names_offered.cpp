#include "rtse/names_offered.h"

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>

#include "base/text.h"
#include "system/orb.h"
#include "system/session.h"

namespace tools {
namespace {

constexpr std::chrono::milliseconds offer_limit{500};
constexpr std::chrono::seconds modules_timeout{5};  // a manager looks into each file of its load path

// The value of an option that stands before.
std::string option_value(const std::vector<std::string>& words, const std::string& option, const std::string& otherwise) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == option && i + 1 < words.size()) return words[i + 1];
    if (words[i].starts_with(option + "=")) return words[i].substr(option.size() + 1);
  }
  return otherwise;
}

// The words of the command that are no options: "conf RTCLaser0 set".
std::vector<std::string> plain_words(const std::vector<std::string>& words) {
  std::vector<std::string> plain;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--ns" || words[i] == "--call-timeout" || words[i] == "-s" || words[i] == "--set" || words[i] == "-m" ||
        words[i] == "--manager") {
      ++i;
    } else if (!words[i].starts_with('-')) {
      plain.push_back(words[i]);
    }
  }
  return plain;
}

using Kinds = std::vector<EntryKind>;

// By their short names; by the path where two have the same, or where the user has begun one.
std::vector<base::Offer> names(const Session& session, const std::string& current, const Kinds& kinds, const std::string& ending = "") {
  const auto tree = session.tree();
  if (!tree) return {};
  std::map<std::string, int> count;
  for (const auto* entry : tree->objects()) ++count[entry->id];
  std::vector<base::Offer> offers;
  for (const auto* entry : tree->objects()) {
    if (std::ranges::find(kinds, entry->kind) == kinds.end()) continue;
    const auto is_path = current.find('/') != std::string::npos || count[entry->id] > 1;
    const auto is_short = current.starts_with('/') ? entry->path() : base::join({entry->segments.begin() + 1, entry->segments.end()}, "/");
    const auto health = entry->health == Health::alive ? "" : entry->health == Health::hung ? "does not answer" : "does not exist";
    offers.push_back({(is_path                               ? is_short
                       : entry->kind == EntryKind::component ? escape_name(entry->id)
                                                             : entry->name()) +
                          ending,
                      health});
  }
  return offers;
}

// Where the port begins; a colon of the name server's address is none.
std::size_t port_colon(const std::string& path) {
  const auto slash = path.rfind('/');
  return path.find(':', slash == std::string::npos ? 0 : slash);
}

// "NAME:" first, then "NAME:PORT".
std::vector<base::Offer> ports(const Session& session, const std::string& current, const std::string& type) {
  const auto colon = port_colon(current);
  if (colon == std::string::npos) return names(session, current, {EntryKind::component}, ":");
  const auto component = session.component(current.substr(0, colon), {});
  if (!component) return {};
  std::vector<base::Offer> offers;
  for (const auto& port : component->ports) {
    if (type.empty() || port.port_type() == type) offers.push_back({current.substr(0, colon + 1) + port.name, port.data_type()});
  }
  return offers;
}

// For conf: the component, then what it has.
std::vector<base::Offer> configuration(const Session& session, const std::vector<std::string>& words, bool sets) {
  if (words.size() < 2) return {};
  const auto component = session.component(words[1], {.configuration = true});
  if (!component) return {};
  std::vector<base::Offer> offers;
  for (const auto& set : component->configuration_sets) {
    if (set.is_hidden()) continue;
    if (sets) offers.push_back({set.id, set.id == component->active_set ? "active" : ""});
    if (sets || (set.id != component->active_set && !component->active_set.empty())) continue;
    for (const auto& [key, value] : set.values) offers.push_back({key, value});
  }
  return offers;
}

std::vector<base::Offer> types(const Session& session, const std::vector<std::string>& words) {
  std::vector<base::Offer> offers;
  const auto tree = session.tree();
  const auto wanted = parse_address(option_value(words, "-m", option_value(words, "--manager", "")), "");
  if (!tree || !wanted) return offers;
  const CallLimit limited(modules_timeout);
  for (const auto* entry : tree->objects()) {
    if (entry->kind != EntryKind::manager || entry->health != Health::alive) continue;
    if (!wanted->segments.empty() && !matches(wanted->segments.back(), entry->id, entry->kind_text)) continue;
    const auto asked = remote("manager", [&] {
      const auto manager = RTM::Manager::_narrow(entry->object);
      if (CORBA::is_nil(manager)) return;
      RTM::ModuleProfileList_var factories = manager->get_factory_profiles();
      for (CORBA::ULong i = 0; i < factories->length(); ++i)
        offers.push_back({property(to_properties(factories[i].properties), "implementation_id")});
      RTM::ModuleProfileList_var modules = manager->get_loadable_modules();
      for (CORBA::ULong i = 0; i < modules->length(); ++i) {
        const auto properties = to_properties(modules[i].properties);
        offers.push_back({property(properties, "implementation_id", property(properties, "module_name"))});
      }
    });
    if (!asked) continue;  // another manager may answer
  }
  return offers;
}

std::optional<std::vector<base::Offer>> offered(const Session& session, const std::string& value, const std::vector<std::string>& before,
                                                const std::string& current) {
  const auto words = plain_words(before);
  const auto command = words.empty() ? std::string() : words.front();
  const auto action = words.size() > 2 ? words[2] : std::string();
  if (value == "--manager") return names(session, current, {EntryKind::manager});
  if (value == "--set") return configuration(session, words, true);
  if (value == "PORT") return ports(session, current, command == "print" ? "DataOutPort" : command == "inject" ? "DataInPort" : "");
  if (value == "PATH" && (command == "dis" || command == "cat") && port_colon(current) != std::string::npos)
    return ports(session, current, "");
  if (value == "PATH" && (command == "ls" || command == "tree" || command == "cat" || command == "del"))
    return names(session, current, {EntryKind::component, EntryKind::manager, EntryKind::other});
  if (value == "PATH" && command == "watch") return std::vector<base::Offer>();
  if (value == "PATH") return names(session, current, {EntryKind::component});
  if (value == "ARGUMENT" && command == "conf") {
    if (words.size() == 3 && (action == "use" || action == "act")) return configuration(session, words, true);
    return words.size() == 3 && (action == "get" || action == "set") ? configuration(session, words, false) : std::vector<base::Offer>();
  }
  const auto subcommand = words.size() > 1 ? words[1] : std::string();
  if (value == "ARGUMENT" && subcommand == "delete") return names(session, current, {EntryKind::component});
  if (value == "ARGUMENT" && subcommand == "create") return types(session, before);
  if (value == "ARGUMENT" && subcommand == "list") return std::vector<base::Offer>();
  return std::nullopt;
}

}  // namespace

std::optional<std::vector<base::Offer>> names_offered(const std::string& value, const std::vector<std::string>& before,
                                                      const std::string& current) {
  static constexpr std::array asked{"PATH", "PORT", "ARGUMENT", "--manager", "--set"};
  if (std::ranges::find(asked, value) == asked.end()) return std::nullopt;
  try {
    const Orb orb;
    const Session session(orb.get(), option_value(before, "--ns", default_server()), offer_limit);
    return offered(session, value, before, current);
  } catch (const std::runtime_error&) {
    return std::nullopt;  // no ORB can be had; the command itself will say why
  }
}

}  // namespace tools
