#include "core/remote_rights.h"

#include "base/text.h"

namespace rt {

RemoteRights parse_remote_rights(std::string_view text) {
  if (base::equal_ignoring_case(text, "read")) return RemoteRights::read;
  if (base::equal_ignoring_case(text, "everything")) return RemoteRights::everything;
  return RemoteRights::components;
}

bool is_protected_key(std::string_view key) {
  constexpr std::string_view groups[] = {"corba",          "logger",      "manager.modules", "manager.local_service", "manager.preload",
                                         "manager.remote", "manager.pid", "manager.command", "manager.refstring_path"};
  for (const auto group : groups) {
    const bool is_inside = key.starts_with(group) && (key.size() == group.size() || key[group.size()] == '.' || key[group.size()] == '_');
    if (is_inside) return true;
  }
  return key == "config_file" || key.ends_with(".config_file") || key.ends_with(".hash_log");
}

bool shows_environment(std::string_view key, std::string_view value) {
  const bool is_format = key.ends_with("naming.formats") || key.ends_with("naming_formats");
  return is_format && (value.find("${") != std::string_view::npos || value.find("$(") != std::string_view::npos);
}

bool is_secret_key(std::string_view key) { return key == "corba.args" || key == "corba.tls.password"; }

bool is_init_function(std::string_view module, std::string_view function, std::string_view prefix, std::string_view suffix) {
  module = base::trim(module);
  const auto open = module.find('(');
  if (open != std::string_view::npos && module.ends_with(')')) function = module.substr(open + 1, module.size() - open - 2);
  function = base::trim(function);
  return function.empty() || (function.front() != '_' && function.starts_with(prefix) && function.ends_with(suffix));
}

}  // namespace rt
