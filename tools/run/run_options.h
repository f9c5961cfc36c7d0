// The options of a run: one value, with defaults, units and limits in one table. The command line (`rtse run`, `rtse goto`), the JSON of a
// recording's metadata, and the JSON that a run receives from the process that starts it are made from this table. Values; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/result.h"

namespace base {
class Command;
}

namespace tools {

struct SavedSystem;

struct RunOptions {
  std::string system;              // RTSProfile
  std::string world;               // SDFormat
  double duration_s = 60;          // simulated
  std::string expectations;        // YAML; empty: only that everything runs
  std::uint64_t seed = 0;          // of the world's noise
  bool one_process_each = false;   // a host for every component, instead of one for all
  std::uint64_t hosts = 1;         // that the components are distributed over, neighbours of the profile together
  bool in_real_time = false;       // else as fast as possible
  std::string rolling = "on";      // sim-server --rolling
  std::vector<std::string> start;  // commands that start third-party components
  std::string start_folder;        // working directory of these commands; empty: that of rtse
  std::string run_file;            // YAML, see run_file.h
  std::vector<std::string> lists;  // of a system that is a template, "robot=r0..r9" (system_template.h)
  std::vector<std::string> module_paths, resource_paths;
  std::vector<std::string> properties;  // "INSTANCE:KEY=VALUE", of the component when it is created
  double hang_timeout_s = 30;           // of real time, for one tick
  double start_timeout_s = 30;          // of real time, for the simulator and for every other step of the start
  std::string junit;                    // file to write
  std::string picture;                  // PNG to write
  std::string record;                   // MCAP to write
  double record_last_s = 0;             // only the last seconds of it, and only if the run fails; 0: all
  std::string page;                     // HTML to write
  double page_camera_rate = 1;          // images of each camera in the page, per simulated second
  double page_limit_mib = 64;           // size of the page
  std::string hash_log;                 // to write
  double hash_period_s = 0;             // of the world's part; 0: when components are called
  bool twice = false;                   // run twice and compare
  bool strict = false;                  // a nondeterministic event fails the run; else it is a note, in a CI job
  std::string keep;                     // folder for logs and the pose log; empty: a temporary one, removed at the end

  bool operator==(const RunOptions&) const = default;
};

using RunOptionMember = std::variant<std::string RunOptions::*, std::vector<std::string> RunOptions::*, double RunOptions::*,
                                     std::uint64_t RunOptions::*, bool RunOptions::*>;

struct RunOptionRow {
  std::string_view name;  // "hang-timeout": --hang-timeout on the command line, "hang_timeout" in JSON
  RunOptionMember member;
  std::string_view help;
  double low = 0, high = 0;  // of a number
  enum class Unit { none, simulated_seconds, wall_seconds } unit = Unit::none;
  std::string_view letter = {};                  // "w": -w
  std::string_view group = {};                   // of the help
  std::string_view needs = {};                   // another option
  std::array<std::string_view, 2> choices = {};  // the values that it takes
  bool must_exist = false;                       // names a file that is read
  bool is_path = false;                          // relative to the working directory
  bool repeats_run = false;                      // makes the same run again: part of a recording
};

// In the order of the help. `system` is the positional SYSTEM.
inline constexpr auto run_option_rows = [] {
  using O = RunOptions;
  using Unit = RunOptionRow::Unit;
  constexpr double longest_s = 1e7;
  constexpr std::string_view repeatability = "Repeatability";
  return std::to_array<RunOptionRow>({
      {.name = "system", .member = &O::system, .help = "RTSProfile, XML or YAML", .must_exist = true, .is_path = true},
      {.name = "world", .member = &O::world, .help = "SDFormat world", .letter = "w", .must_exist = true, .is_path = true},
      {.name = "duration",
       .member = &O::duration_s,
       .help = "Simulated seconds",
       .low = 0.001,
       .high = longest_s,
       .unit = Unit::simulated_seconds,
       .letter = "d",
       .repeats_run = true},
      {.name = "expect", .member = &O::expectations, .help = "Expectations, YAML", .letter = "x", .must_exist = true, .is_path = true},
      {.name = "seed", .member = &O::seed, .help = "Seed of the world's noise", .low = 0, .high = 1e18, .repeats_run = true},
      {.name = "one-process-each",
       .member = &O::one_process_each,
       .help = "A process for every component instead of one for all",
       .repeats_run = true},
      {.name = "hosts",
       .member = &O::hosts,
       .help = "Number of component hosts; components that follow one another in SYSTEM share one",
       .low = 1,
       .high = 1000,
       .repeats_run = true},
      {.name = "realtime", .member = &O::in_real_time, .help = "Run in real time"},
      {.name = "rolling",
       .member = &O::rolling,
       .help = "on: move robots that roll alone on level ground by the rolling step, which is faster; off: by ODE",
       .choices = {"on", "off"},
       .repeats_run = true},
      {.name = "for",
       .member = &O::lists,
       .help = "NAME=LIST: repeat what contains {NAME} for each value: robot=r0..r99, robot=a,b, robot=100"},
      {.name = "start",
       .member = &O::start,
       .help = "Command that starts third-party components (those without a module)",
       .repeats_run = true},
      {.name = "start-folder",
       .member = &O::start_folder,
       .help = "Working directory of the --start commands (default: current directory)",
       .is_path = true,
       .repeats_run = true},
      {.name = "run-file",
       .member = &O::run_file,
       .help = "YAML file of third-party processes and their components",
       .must_exist = true,
       .is_path = true,
       .repeats_run = true},
      {.name = "module-path",
       .member = &O::module_paths,
       .help = "Folder with modules of components",
       .is_path = true,
       .repeats_run = true},
      {.name = "resource-path", .member = &O::resource_paths, .help = "Folder with models", .is_path = true, .repeats_run = true},
      {.name = "property",
       .member = &O::properties,
       .help = "INSTANCE:KEY=VALUE, a property that a component is created with",
       .repeats_run = true},
      {.name = "hang-timeout",
       .member = &O::hang_timeout_s,
       .help = "Timeout for one tick [wall-clock s]",
       .low = 0.1,
       .high = 1e6,
       .unit = Unit::wall_seconds},
      {.name = "start-timeout",
       .member = &O::start_timeout_s,
       .help = "Timeout for starting the simulator, and the components [wall-clock s]",
       .low = 0.1,
       .high = 1e6,
       .unit = Unit::wall_seconds},
      {.name = "junit", .member = &O::junit, .help = "Write the verdicts as JUnit XML", .is_path = true},
      {.name = "picture", .member = &O::picture, .help = "Save an image of the final world (PNG)", .is_path = true},
      {.name = "record", .member = &O::record, .help = "Record all ports, component logs and simulator state (MCAP)", .is_path = true},
      {.name = "last",
       .member = &O::record_last_s,
       .help = "With --record: keep only the last N seconds, and only if the run fails",
       .low = 0.1,
       .high = 1e6,
       .unit = Unit::simulated_seconds,
       .needs = "record"},
      {.name = "page", .member = &O::page, .help = "Write the run as one HTML page for any browser", .is_path = true},
      {.name = "page-camera-rate",
       .member = &O::page_camera_rate,
       .help = "Images of each camera in the page per simulated second; 0: none",
       .low = 0,
       .high = 1000,
       .needs = "page"},
      {.name = "page-limit",
       .member = &O::page_limit_mib,
       .help = "Maximum size of the page [MiB]",
       .low = 1,
       .high = 4096,
       .needs = "page"},
      {.name = "hash-log",
       .member = &O::hash_log,
       .help = "Write hashes of the world, the components and the samples of each port, for rtse diff",
       .group = repeatability,
       .is_path = true},
      {.name = "hash-period",
       .member = &O::hash_period_s,
       .help = "Simulated seconds between world hashes (default: every component tick)",
       .low = 1e-6,
       .high = 1e6,
       .unit = Unit::simulated_seconds,
       .group = repeatability},
      {.name = "twice", .member = &O::twice, .help = "Run it twice and name the first difference", .group = repeatability},
      {.name = "strict", .member = &O::strict, .help = "Fail if the run had a nondeterministic event", .group = repeatability},
      {.name = "keep", .member = &O::keep, .help = "Keep logs and the pose log in this folder", .is_path = true},
  });
}();

// Of a name that is in the table.
const RunOptionRow& run_option(std::string_view name);

// ---- command line ----
// Those of these names, all for none. `options` must live as long as the command; its values are the defaults that the help shows.
void add_run_options(base::Command& command, RunOptions& options, const std::vector<std::string_view>& names = {});
// `base`, with what the user has given on the command line in its place; lists get longer.
RunOptions with_given(RunOptions base, const RunOptions& given, const base::Command& command);

// ---- JSON ----
enum class RunOptionSet { all, repeats_run };
// An object with all of them, or those that make the same run again. Paths are absolute there, since the reader is elsewhere.
nlohmann::ordered_json to_json(const RunOptions& options, RunOptionSet set);
// What is missing has its default. An Error names a member that is unknown, has another type, or is beyond its limits.
base::Result<RunOptions> run_options_from(const nlohmann::ordered_json& json);
base::Result<RunOptions> parse_run_options(const std::string& text);

// A recording has them as a text of its metadata `run` under this key. Older recordings have a text for each option. An option that a
// recording has not is what the run was without it.
inline constexpr const char* options_note = "options";
base::Result<RunOptions> recorded_run_options(const std::map<std::string, std::string>& notes);

// ---- checks against the system ----
struct ComponentProperty {
  std::string instance, key, value;
};
base::Result<ComponentProperty> parse_property(const std::string& text);
// Rates, folders and properties. The properties.
base::Result<std::vector<ComponentProperty>> check_against(const RunOptions& options, const SavedSystem& system);

}  // namespace tools
