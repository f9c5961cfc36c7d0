#include "run/run_options.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/command.h"
#include "base/output_name.h"
#include "base/text.h"
#include "run/module_files.h"
#include "system/profile/rts_profile.h"
#include "system/profile/system_template.h"

namespace tools {
namespace {

using base::Error;
using base::Result;
using Json = nlohmann::ordered_json;
using Unit = RunOptionRow::Unit;

const RunOptions defaults{};

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

// An empty folder is most likely another than was meant, and the modules of the installation would be taken instead.
Result<void> check_modules(const std::vector<std::string>& paths) {
  for (const auto& path : paths) {
    std::error_code error;
    const std::filesystem::directory_iterator entries(path, error);
    if (std::none_of(begin(entries), end(entries), [](const auto& entry) { return is_module(entry.path()); }))
      return Error{"module path " + base::in_quotes(path) + ": holds no modules (*.so, *.py)"};
  }
  return {};
}

std::string json_name(const RunOptionRow& row) {
  std::string name(row.name);
  std::ranges::replace(name, '-', '_');
  return name;
}

std::string option_name(const RunOptionRow& row) { return "--" + std::string(row.name); }

// Of the command line: "-w,--world"; the system is positional.
std::string declared_name(const RunOptionRow& row) {
  if (row.name == "system") return "SYSTEM";
  return (row.letter.empty() ? "" : "-" + std::string(row.letter) + ",") + option_name(row);
}

bool is_choice(const RunOptionRow& row, const std::string& text) {
  return row.choices[0].empty() || std::ranges::find(row.choices, text) != row.choices.end();
}

std::string expected_choice(const RunOptionRow& row) { return std::string(row.choices[0]) + " or " + std::string(row.choices[1]); }

std::string property_problem(const std::string& text) {
  const auto parsed = parse_property(text);
  return parsed ? std::string() : parsed.error().message;
}

void add(base::Command& command, const RunOptionRow& row, RunOptions& options) {
  base::Option* option = nullptr;
  const auto name = declared_name(row);
  const std::string help(row.help);
  if (const auto* text = std::get_if<std::string RunOptions::*>(&row.member)) {
    option = command.add_option(name, options.*(*text), help);
    if (!row.choices[0].empty()) {
      option->capture_default_str()->check([&row](const std::string& given) {
        return is_choice(row, given) ? std::string() : "expected " + expected_choice(row) + ", got " + base::in_quotes(given);
      });
    }
  } else if (const auto* list = std::get_if<std::vector<std::string> RunOptions::*>(&row.member)) {
    option = command.add_option(name, options.*(*list), help)->allow_extra_args(false);
    if (*list == &RunOptions::properties) option->check(property_problem);
  } else if (const auto* number = std::get_if<double RunOptions::*>(&row.member)) {
    option = command.add_option(name, options.*(*number), help);
    if (row.unit == Unit::simulated_seconds)
      option->seconds_between(row.low, row.high);
    else
      option->check(base::number_between(row.low, row.high));
    if (options.*(*number) != 0) option->capture_default_str();
  } else if (const auto* whole = std::get_if<std::uint64_t RunOptions::*>(&row.member)) {
    option = command.add_option(name, options.*(*whole), help)->capture_default_str()->check(base::number_between(row.low, row.high));
  } else if (const auto* flag = std::get_if<bool RunOptions::*>(&row.member)) {
    option = command.add_flag(name, options.*(*flag), help);
  }
  if (row.must_exist) option->check(base::existing_file());
  if (row.is_path && !row.must_exist && std::holds_alternative<std::string RunOptions::*>(row.member)) option->check(base::output_name());
  if (!row.group.empty()) option->group(std::string(row.group));
  if (!row.needs.empty()) option->needs("--" + std::string(row.needs));
}

std::string absolute(const std::string& path) { return path.empty() ? path : std::filesystem::absolute(path).string(); }

Json value_of(const RunOptions& options, const RunOptionRow& row) {
  return std::visit(
      [&](auto member) -> Json {
        auto value = options.*member;
        if constexpr (std::is_same_v<decltype(value), std::string>) {
          if (row.is_path) value = absolute(value);
        } else if constexpr (std::is_same_v<decltype(value), std::vector<std::string>>) {
          for (auto& one : value) one = row.is_path ? absolute(one) : one;
        }
        return value;
      },
      row.member);
}

// Empty: the value was taken.
std::string problem_of(const Json& value, const RunOptionRow& row, RunOptions& options) {
  const auto limits = " must be from " + base::format_number(row.low) + " to " + base::format_number(row.high) + ", got " + value.dump();
  return std::visit(
      [&](auto member) -> std::string {
        auto& to = options.*member;
        using Value = std::remove_reference_t<decltype(to)>;
        if constexpr (std::is_same_v<Value, bool>) {
          if (!value.is_boolean()) return " must be true or false, got " + value.dump();
        } else if constexpr (std::is_same_v<Value, std::string>) {
          if (!value.is_string()) return " must be a text, got " + value.dump();
          if (!is_choice(row, value.template get<std::string>())) return " must be " + expected_choice(row) + ", got " + value.dump();
        } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
          if (!value.is_array() || !std::all_of(value.begin(), value.end(), [](const Json& one) { return one.is_string(); }))
            return " must be a list of texts, got " + value.dump();
        } else {
          const bool fits = std::is_same_v<Value, double> ? value.is_number() : value.is_number_unsigned();
          if (!fits) return limits;
          const auto number = value.template get<double>();
          const bool is_default = value.template get<Value>() == defaults.*member;       // 0 for "not given" is beyond some limits
          if (!is_default && !(number >= row.low && number <= row.high)) return limits;  // no NaN either
        }
        to = value.template get<Value>();
        return "";
      },
      row.member);
}

}  // namespace

const RunOptionRow& run_option(std::string_view name) {
  const auto* row = std::ranges::find(run_option_rows, name, &RunOptionRow::name);
  assert(row != run_option_rows.end());
  return *row;
}

void add_run_options(base::Command& command, RunOptions& options, const std::vector<std::string_view>& names) {
  for (const auto& row : run_option_rows) {
    if (names.empty() || std::ranges::find(names, row.name) != names.end()) add(command, row, options);
  }
}

RunOptions with_given(RunOptions base, const RunOptions& given, const base::Command& command) {
  for (const auto& row : run_option_rows) {
    const auto name = row.name == "system" ? "SYSTEM" : option_name(row);
    if (!command.has(name) || command.count(name) == 0) continue;
    std::visit(
        [&](auto member) {
          if constexpr (std::is_same_v<decltype(member), std::vector<std::string> RunOptions::*>) {
            (base.*member).insert((base.*member).end(), (given.*member).begin(), (given.*member).end());
          } else {
            base.*member = given.*member;
          }
        },
        row.member);
  }
  return base;
}

Json to_json(const RunOptions& options, RunOptionSet set) {
  Json json = Json::object();
  for (const auto& row : run_option_rows) {
    if (set == RunOptionSet::all || row.repeats_run) json[json_name(row)] = value_of(options, row);
  }
  return json;
}

Result<RunOptions> run_options_from(const Json& json) {
  if (!json.is_object()) return Error{"options of a run: expected a JSON object, got " + json.dump().substr(0, 40)};
  RunOptions options;
  for (const auto& [key, value] : json.items()) {
    const auto* row = std::ranges::find_if(run_option_rows, [&](const auto& one) { return json_name(one) == key; });
    if (row == run_option_rows.end()) return Error{"options of a run: unknown option " + base::in_quotes(key)};
    if (const auto problem = problem_of(value, *row, options); !problem.empty()) return Error{"options of a run: " + key + problem};
  }
  return options;
}

namespace {

// The texts of recordings that were made before there was one for all options: numbers, "yes", and lists with an option in each line.
Json json_from_texts(const std::map<std::string, std::string>& notes) {
  Json json = Json::object();
  for (const auto& row : run_option_rows) {
    // Two lists had names of their own.
    const auto name = row.name == "property"                                     ? "properties"
                      : row.name == "module-path" || row.name == "resource-path" ? json_name(row) + "s"
                                                                                 : json_name(row);
    const auto note = notes.find(name);
    if (!row.repeats_run || note == notes.end() || note->second.empty()) continue;
    const auto& text = note->second;
    auto& value = json[json_name(row)];
    if (std::holds_alternative<std::string RunOptions::*>(row.member)) value = text;
    if (std::holds_alternative<std::vector<std::string> RunOptions::*>(row.member)) value = base::split_list(text, '\n');
    if (std::holds_alternative<bool RunOptions::*>(row.member)) value = text == "yes";
    if (std::holds_alternative<double RunOptions::*>(row.member)) value = base::parse_number(text).value_or(NAN);
    if (std::holds_alternative<std::uint64_t RunOptions::*>(row.member))
      value = static_cast<std::uint64_t>(base::parse_integer(text).value_or(0));
  }
  return json;
}

}  // namespace

Result<RunOptions> recorded_run_options(const std::map<std::string, std::string>& notes) {
  const auto text = notes.find(options_note);
  Json json = text == notes.end() ? json_from_texts(notes) : Json::parse(text->second, nullptr, false);
  if (json.is_object() && !json.contains("rolling")) json["rolling"] = "off";
  return run_options_from(json);
}

Result<RunOptions> parse_run_options(const std::string& text) { return run_options_from(Json::parse(text, nullptr, false)); }

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

Result<std::vector<ComponentProperty>> check_against(const RunOptions& options, const SavedSystem& system) {
  for (const auto& checked : {check_rates(system), check_folders("module", options.module_paths), check_modules(options.module_paths),
                              check_folders("resource", options.resource_paths)}) {
    if (!checked) return checked.error();
  }
  const auto texts = filled_in(options.properties, options.lists);
  if (!texts) return texts.error();
  std::vector<ComponentProperty> properties;
  for (const auto& text : *texts) {
    auto property = parse_property(text);
    if (!property) return property.error();
    if (system.component(property->instance) == nullptr)
      return Error{"property " + base::in_quotes(text) + ": the system has no component " + property->instance};
    properties.push_back(std::move(*property));
  }
  return properties;
}

}  // namespace tools
