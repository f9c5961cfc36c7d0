#include "core/manager_arguments.h"

#include "base/text.h"

namespace rt {
namespace {

base::Result<void> apply(char option, const std::string& value, ManagerArguments& result) {
  if (option == 'f') {
    if (value.empty()) return base::Error{"option -f: expected the name of a file"};
    result.config_file = value;
  } else if (option == 'p') {
    const auto port = base::parse_integer(value);
    if (!port || *port < 0 || *port > 65535)
      return base::Error{"option -p: expected a port from 0 to 65535, got " + base::in_quotes(value)};
    result.port = static_cast<int>(*port);
  } else {
    const auto colon = value.find(':');
    const auto key = base::trim(std::string_view(value).substr(0, colon));
    if (colon == std::string::npos || key.empty()) return base::Error{"option -o: expected key:value, got " + base::in_quotes(value)};
    result.overrides.emplace_back(key, base::trim(std::string_view(value).substr(colon + 1)));
  }
  return {};
}

}  // namespace

base::Result<ManagerArguments> parse_manager_arguments(const std::vector<std::string>& arguments) {
  ManagerArguments result;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const auto& argument = arguments[i];
    if (argument == "--") {
      result.rest.insert(result.rest.end(), arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1, arguments.end());
      break;
    }
    if (argument.size() < 2 || argument[0] != '-') {
      result.rest.push_back(argument);
      continue;
    }
    if (argument.starts_with("-ORB")) {
      result.orb_arguments.push_back(argument);
      if (i + 1 < arguments.size()) result.orb_arguments.push_back(arguments[++i]);
      continue;
    }
    if (argument[1] == '-') {
      result.unknown.push_back(argument);
      continue;
    }
    // Letters may be joined, and a value may follow its letter at once: -adp2810.
    for (std::size_t at = 1; at < argument.size(); ++at) {
      const char option = argument[at];
      if (option == 'a') {
        result.without_servant = true;
      } else if (option == 'd') {
        result.is_master = true;
      } else if (option == 'i') {
        result.ignore_no_config = true;
      } else if (option == 'f' || option == 'o' || option == 'p') {
        std::string value = argument.substr(at + 1);
        if (value.empty()) {
          if (i + 1 == arguments.size()) return base::Error{std::string("option -") + option + ": expected a value"};
          value = arguments[++i];
        }
        if (auto applied = apply(option, value, result); !applied) return applied.error();
        break;
      } else {
        result.unknown.push_back(argument);
        break;
      }
    }
  }
  return result;
}

}  // namespace rt
