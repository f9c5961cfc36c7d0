#include "run/run_file.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "base/plain_file.h"
#include "base/text.h"
#include "base/yaml_keys.h"

namespace editor {
namespace {

using base::Error;
using base::Result;

constexpr double longest_wait_s = 3600;
constexpr std::size_t largest_run_file = std::size_t{1} << 20;

struct FailureAt {
  std::string what;
  YAML::Mark at;
};

void expect_map(const YAML::Node& node, const std::string& what, const std::set<std::string>& keys) {
  if (!node.IsMap()) throw FailureAt{what + " must be a map", node.Mark()};
  for (const auto& entry : node) {
    const auto key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    if (!keys.contains(key))
      throw FailureAt{what + " has no key " + base::in_quotes(key) + ", expected " + base::join({keys.begin(), keys.end()}, ", "),
                      entry.first.Mark()};
  }
}

std::string text_of(const YAML::Node& node, const std::string& what) {
  if (!node.IsScalar() || node.Scalar().empty()) throw FailureAt{what + " must be a text", node.Mark()};
  return node.Scalar();
}

double number_of(const YAML::Node& node, const std::string& what, double above, double highest) {
  const auto text = text_of(node, what);
  const auto number = base::parse_number(text);
  if (!number || *number <= above || *number > highest)
    throw FailureAt{what + " must be a number above " + base::format_number(above) + ", at most " + base::format_number(highest) +
                        ", got " + base::in_quotes(text),
                    node.Mark()};
  return *number;
}

ForeignComponent foreign_component_of(const YAML::Node& node) {
  ForeignComponent component;
  if (node.IsScalar()) {
    component.instance = text_of(node, "component");
    return component;
  }
  expect_map(node, "component", {"name", "phase", "rate", "join"});
  if (!node["name"]) throw FailureAt{"component needs a name", node.Mark()};
  component.instance = text_of(node["name"], "name");
  if (const auto phase = node["phase"]) {
    const auto value = base::parse_integer(text_of(phase, "phase"));
    if (!value || *value < 0 || *value > highest_phase)
      throw FailureAt{"phase must be a number from 0 to 15, got " + base::in_quotes(phase.Scalar()), phase.Mark()};
    component.phase = static_cast<int>(*value);
  }
  if (const auto rate = node["rate"]) component.rate = base::format_number(number_of(rate, "rate", 0, 1e6));
  if (const auto how = node["join"]) {
    const auto found = parse_how(text_of(how, "join"));
    if (!found) throw FailureAt{"join must be member, tick or clock, got " + base::in_quotes(how.Scalar()), how.Mark()};
    component.how = *found;
  }
  return component;
}

ForeignProcess process_of(const YAML::Node& node, const std::filesystem::path& beside) {
  expect_map(node, "process", {"command", "folder", "environment", "wait", "components"});
  ForeignProcess process;
  if (!node["command"]) throw FailureAt{"process needs a command", node.Mark()};
  process.command = text_of(node["command"], "command");
  const auto folder = node["folder"] ? beside / text_of(node["folder"], "folder") : beside;
  if (!std::filesystem::is_directory(folder))
    throw FailureAt{"folder " + base::in_quotes(folder.string()) + ": no such folder",
                    node["folder"] ? node["folder"].Mark() : node.Mark()};
  process.folder = folder.string();
  if (const auto environment = node["environment"]) {
    if (!environment.IsMap()) throw FailureAt{"environment must be a map", environment.Mark()};
    for (const auto& entry : environment) {
      const auto key = text_of(entry.first, "environment");
      if (key.find('=') != std::string::npos || !entry.second.IsScalar())
        throw FailureAt{"environment must have names without = and texts, got " + base::in_quotes(key), entry.first.Mark()};
      process.environment[key] = entry.second.Scalar();
    }
  }
  if (node["wait"]) process.wait_s = number_of(node["wait"], "wait", 0, longest_wait_s);
  const auto components = node["components"];
  if (!components || !components.IsSequence() || components.size() == 0)
    throw FailureAt{"process needs the list of its components", components ? components.Mark() : node.Mark()};
  for (std::size_t i = 0; i < components.size(); ++i) process.components.push_back(foreign_component_of(components[i]));
  return process;
}

std::vector<ForeignProcess> all_of(const std::string& text, const std::filesystem::path& beside) {
  const auto root = YAML::Load(text);
  yaml::expect_unique_keys(root);
  expect_map(root, "run file", {"processes"});
  const auto list = root["processes"];
  if (!list || !list.IsSequence() || list.size() == 0) throw FailureAt{"run file needs a list of processes", root.Mark()};
  std::vector<ForeignProcess> processes;
  std::set<std::string> names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    processes.push_back(process_of(list[i], beside));
    for (const auto& component : processes.back().components) {
      if (!names.insert(component.instance).second) throw FailureAt{"component " + component.instance + " is there twice", list[i].Mark()};
    }
  }
  return processes;
}

}  // namespace

Result<std::vector<ForeignProcess>> parse_run_file(const std::string& text, const std::string& file) {
  const auto folder = std::filesystem::path(file).parent_path();
  try {
    return all_of(text, folder.empty() ? "." : folder);
  } catch (const FailureAt& failure) {
    return Error{"run file " + file + (failure.at.is_null() ? "" : ":" + std::to_string(failure.at.line + 1)) + ": " + failure.what};
  } catch (const YAML::Exception& problem) {
    return Error{"run file " + file + ":" + std::to_string(problem.mark.line + 1) + ": " + problem.msg};
  }
}

Result<std::vector<ForeignProcess>> read_run_file(const std::string& file) {
  if (const auto problem = base::file_problem(file); !problem.empty()) return Error{"run file " + base::in_quotes(file) + ": " + problem};
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) return Error{"run file " + file + ": cannot be read"};
  if (text.str().size() > largest_run_file) return Error{"run file " + file + ": is larger than 1 MiB"};
  return parse_run_file(text.str(), file);
}

}  // namespace editor
