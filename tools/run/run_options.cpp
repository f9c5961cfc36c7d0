#include "run/run_options.h"

#include <algorithm>
#include <filesystem>

#include "base/command.h"
#include "base/text.h"
#include "run/run_system.h"

namespace editor {
namespace {

Result<void> check_rates(const SavedSystem& system) {
  for (const auto& component : system.components) {
    if (component.contexts.empty() || component.contexts.front().rate.empty()) continue;
    const auto& rate = component.contexts.front().rate;
    const auto number = base::parse_number(rate);
    if (!number || *number <= 0 || *number > 1e9)
      return Error{"component " + component.instance + ": its rate must be more than 0 and at most 1e9 Hz, got " + base::in_quotes(rate)};
  }
  return {};
}

Result<void> check_folders(const std::string& kind, const std::vector<std::string>& paths) {
  for (const auto& path : paths) {
    if (!std::filesystem::is_directory(path)) return Error{kind + " path " + base::in_quotes(path) + ": no such folder"};
  }
  return {};
}

}  // namespace

void add_repeatability_options(base::Command& run, RunOptions& options) {
  const auto* group = "Repeatability";
  run.add_option("--hash-log", options.hash_log, "Write hashes of world, components and samples, for rtse diff")->group(group);
  run.add_option("--hash-period", options.hash_period_s, "Simulated seconds between world hashes (default: every component tick)")
      ->seconds_between(1e-6, 1e6)
      ->group(group);
  run.add_flag("--twice", options.twice, "Run twice and print the first difference")->group(group);
  run.add_flag("--strict", options.strict, "Fail if the run had a nondeterministic event")->group(group);
}

void add_recording_options(base::Command& run, RunOptions& options) {
  auto* record = run.add_option("--record", options.record, "Record all ports, component logs and simulator state (MCAP)");
  run.add_option("--last", options.record_last_s, "With --record: keep only the last N seconds, and only if the run fails")
      ->needs(record)
      ->seconds_between(0.1, 1e6);
}

Result<ComponentProperty> parse_property(const std::string& text) {
  const auto colon = text.find(':');
  const auto equals = text.find('=', colon == std::string::npos ? 0 : colon);
  if (colon == 0 || colon == std::string::npos || equals == std::string::npos || equals == colon + 1 || text.find('&') != std::string::npos)
    return Error{"property " + base::in_quotes(text) + ": expected INSTANCE:KEY=VALUE"};
  const auto value = text.substr(equals + 1);
  const auto phase = base::parse_integer(value);
  if (text.substr(colon + 1, equals - colon - 1) == "exec_cxt.sim_time.phase" && (!phase || *phase < 0 || *phase > 15))
    return Error{"property " + base::in_quotes(text) + ": a phase must be a number from 0 to 15"};
  return ComponentProperty{text.substr(0, colon), text.substr(colon + 1, equals - colon - 1), text.substr(equals + 1)};
}

Result<std::vector<ComponentProperty>> read_wishes(const RunOptions& options, const SavedSystem& system) {
  for (const auto& checked :
       {check_rates(system), check_folders("module", options.module_paths), check_folders("resource", options.resource_paths)}) {
    if (!checked) return checked.error();
  }
  std::vector<ComponentProperty> properties;
  for (const auto& text : options.properties) {
    auto property = parse_property(text);
    if (!property) return property.error();
    if (std::ranges::none_of(system.components, [&](const auto& component) { return component.instance == property->instance; }))
      return Error{"property " + base::in_quotes(text) + ": the system has no component " + property->instance};
    properties.push_back(std::move(*property));
  }
  return properties;
}

std::vector<std::pair<std::string, std::string>> notes_on(const RunOptions& options, const std::vector<std::string>& others) {
  const auto absolute = [](std::vector<std::string> paths) {
    for (auto& path : paths) path = std::filesystem::absolute(path).string();
    return base::join(paths, "\n");
  };
  return {{"duration", base::format_number(options.duration_s)},
          {"one_process_each", options.one_process_each ? "yes" : "no"},
          {"properties", base::join(options.properties, "\n")},
          {"start", base::join(options.start, "\n")},
          {"start_folder", options.start_folder.empty() ? std::filesystem::current_path().string() : options.start_folder},
          {"run_file", options.run_file.empty() ? "" : std::filesystem::absolute(options.run_file).string()},
          {"others", base::join(others, "\n")},
          {"script", options.script != nullptr ? "yes" : "no"},
          {"module_paths", absolute(options.module_paths)},
          {"resource_paths", absolute(options.resource_paths)}};
}

}  // namespace editor
