#include "run/run_file.h"

#include <yaml-cpp/yaml.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "base/plain_file.h"
#include "base/text.h"
#include "base/yaml_keys.h"
#include "run/yaml_shape.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

constexpr double longest_wait_s = 3600;
constexpr std::size_t largest_run_file = std::size_t{1} << 20;

constexpr std::array run_file_keys = {Key{"processes", Form::maps, "process", true}};
constexpr std::array process_keys = {Key{"command", Form::text, {}, true}, Key{"folder", Form::text}, Key{"environment", Form::any},
                                     Key{"wait", Form::positive}, Key{"components", Form::any, {}, true}};
constexpr std::array component_keys = {Key{"name", Form::text, {}, true}, Key{"phase", Form::count}, Key{"rate", Form::positive},
                                       Key{"join", Form::words, "member tick clock"}};
constexpr std::array run_file_shapes = {Shape{"run file", run_file_keys}, Shape{"process", process_keys},
                                        Shape{"component", component_keys}};

// Of a key that has a number.
double at_most(const YAML::Node& node, const char* key, double highest) {
  const double value = *number(node, key);
  if (value > highest)
    fail_at(node[key], std::string(key) + " must be at most " + base::format_number(highest) + ", got " + base::in_quotes(word(node, key)));
  return value;
}

ForeignComponent foreign_component_of(const YAML::Node& node) {
  ForeignComponent component;
  if (node.IsScalar()) {
    check_form(run_file_shapes, node, {"component", Form::text});
    component.instance = node.Scalar();
    return component;
  }
  check_shape(run_file_shapes, node, "component", "component");
  component.instance = word(node, "name");
  if (node["phase"]) component.phase = static_cast<int>(at_most(node, "phase", highest_phase));
  if (node["rate"]) component.rate = base::format_number(at_most(node, "rate", 1e6));
  if (node["join"]) component.how = *parse_how(word(node, "join"));
  return component;
}

std::map<std::string, std::string> environment_of(const YAML::Node& node) {
  if (!node.IsMap()) fail_at(node, "environment must be a map");
  std::map<std::string, std::string> environment;
  for (const auto& entry : node) {
    const auto key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    if (key.empty() || key.find('=') != std::string::npos || !entry.second.IsScalar())
      fail_at(entry.first, "environment must have names without = and texts, got " + base::in_quotes(key));
    environment[key] = entry.second.Scalar();
  }
  return environment;
}

ForeignProcess process_of(const YAML::Node& node, const std::filesystem::path& beside) {
  ForeignProcess process;
  process.command = word(node, "command");
  const auto folder = node["folder"] ? beside / word(node, "folder") : beside;
  if (!std::filesystem::is_directory(folder))
    fail_at(node["folder"] ? node["folder"] : node, "folder " + base::in_quotes(folder.string()) + ": no such folder");
  process.folder = folder.string();
  if (node["environment"]) process.environment = environment_of(node["environment"]);
  if (node["wait"]) process.wait_s = at_most(node, "wait", longest_wait_s);
  const auto components = node["components"];
  if (!components.IsSequence() || components.size() == 0) fail_at(components, "components must be a list with at least one component");
  for (const auto& component : components) process.components.push_back(foreign_component_of(component));
  return process;
}

std::vector<ForeignProcess> all_of(const std::string& text, const std::filesystem::path& beside) {
  const auto root = YAML::Load(text);
  yaml::expect_unique_keys(root);
  check_shape(run_file_shapes, root, "run file", "run file");
  if (root["processes"].size() == 0) fail_at(root["processes"], "run file needs a list with at least one process");
  std::vector<ForeignProcess> processes;
  std::set<std::string> names;
  for (const auto& node : root["processes"]) {
    processes.push_back(process_of(node, beside));
    for (const auto& component : processes.back().components) {
      if (!names.insert(component.instance).second) fail_at(node, "component " + component.instance + " appears twice");
    }
  }
  return processes;
}

}  // namespace

Result<std::vector<ForeignProcess>> parse_run_file(const std::string& text, const std::string& file) {
  const auto folder = std::filesystem::path(file).parent_path();
  const auto fail = [&](int line, int column, const std::string& what) {
    return Error{"run file " + file + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + what};
  };
  try {
    return all_of(text, folder.empty() ? "." : folder);
  } catch (const YamlFailure& failure) {
    return fail(failure.line, failure.column, failure.message);
  } catch (const YAML::Exception& problem) {
    return fail(problem.mark.line + 1, problem.mark.column + 1, problem.msg);
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

}  // namespace tools
