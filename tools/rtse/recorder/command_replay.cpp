// replay.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

#include "base/command_line.h"
#include "base/interrupt.h"
#include "base/output_name.h"
#include "base/shell_word.h"
#include "base/text.h"
#include "base/valid_file.h"
#include "base/whole_file.h"
#include "recording/ring.h"
#include "rtse/command.h"
#include "rtse/recorder/recorder_commands.h"
#include "run/module_files.h"
#include "run/recorded_run.h"
#include "run/replay.h"
#include "run/run_page.h"
#include "system/profile/rts_profile.h"

namespace recorder {

namespace {

using tools::Console;
using tools::Session;

struct Options {
  std::string file, component;
  std::vector<std::string> links;       // COMPONENT:PORT=INPORT
  std::vector<std::string> tolerances;  // MEMBER=EPS
  std::vector<std::string> ignored;
  std::vector<std::string> settings;  // NAME=VALUE, of the active configuration set
  std::vector<std::string> module_paths, properties, start;
  bool compares = false;
  std::string junit, keep, page;
  double hang_timeout_s = 30;
};

std::string after_dot(const std::string& port_name) { return port_name.substr(port_name.find('.') + 1); }

// With --module-path the component comes from there: with the installation's own a comparison would say nothing.
base::Result<void> check_module(const Options& options, const tools::SavedComponent& component) {
  if (options.module_paths.empty() || !options.start.empty()) return {};
  const auto parts = base::split_list(component.id, ':');
  const auto type = parts.size() >= 4 ? parts[3] : component.instance;
  if (tools::module_kind(type, options.module_paths) != tools::ModuleKind::none) return {};
  return base::Error{"component " + component.instance + ": module " + tools::module_names(type) + " is not in --module-path " +
                     base::join(options.module_paths, ", ")};
}

// The properties that decide what an InPort keeps: its buffer, and the stamps that it gives.
tools::Properties of_receiver(const tools::SavedConnector& connector) {
  tools::Properties kept;
  for (const auto& [key, value] : connector.properties) {
    const bool is_kept = key.find("buffer") != std::string::npos || key.ends_with("timestamp_policy");
    if (key.starts_with("dataport.") && is_kept) kept[key] = value;
  }
  return kept;
}

// The links that the profile has, and those of the command line in their place.
base::Result<std::vector<ReplayLink>> links_of(const tools::SavedSystem& system, const Options& options) {
  std::vector<ReplayLink> links;
  for (const auto& text : options.links) {
    const auto equals = text.find('=');
    const auto colon = text.find(':');
    if (equals == std::string::npos || colon > equals)
      return base::Error{"link " + base::in_quotes(text) + ": expected COMPONENT:PORT=INPORT"};
    links.push_back({"/" + text.substr(0, colon) + "/" + text.substr(colon + 1, equals - colon - 1), text.substr(equals + 1), {}});
  }
  for (const auto& connector : system.connectors) {
    if (!connector.is_data || connector.target.instance != options.component) continue;
    const std::string port = after_dot(connector.target.port_name);
    if (std::ranges::any_of(links, [&](const ReplayLink& link) { return link.port == port; })) continue;
    links.push_back({"/" + connector.source.instance + "/" + after_dot(connector.source.port_name), port, of_receiver(connector)});
  }
  return links;
}

// What the recording cannot give the component is said, and left out; what the command line names has to be there.
base::Result<std::vector<ReplayLink>> possible(Console& console, std::vector<ReplayLink> links, const tools::SavedSystem& system,
                                               const Options& options) {
  auto reader = open_recording(options.file);
  if (!reader) return reader.error();
  const auto has = [&](const std::string& topic) {
    return std::ranges::any_of(reader->channels(), [&](const auto& one) { return one.second.topic == topic; });
  };
  for (std::size_t i = 0; i < options.links.size(); ++i) {  // they come first
    if (!has(links[i].topic))
      return base::Error{"link " + base::in_quotes(options.links[i]) + ": the recording has no channel " + base::in_quotes(links[i].topic)};
  }
  std::erase_if(links, [&](const ReplayLink& link) {
    if (has(link.topic)) return false;
    console.warn("input " + options.component + ":" + link.port + ": missing, the recording has no " + base::printable(link.topic));
    return true;
  });
  for (const auto& connector : system.connectors) {
    if (connector.is_data || (connector.target.instance != options.component && connector.source.instance != options.component)) continue;
    console.warn("service port " + base::printable(connector.source.port_name) + ": missing, calls of " +
                 base::printable(connector.target.port_name) + " are not recorded");
  }
  return links;
}

// Connections to the component that had injected faults. A replay sends what their OutPorts wrote, so the component reads something else
// than in the run.
std::vector<std::string> faulty_inputs(const tools::SavedSystem& system, const std::string& instance) {
  std::vector<std::string> faulty;
  for (const auto& connector : system.connectors) {
    if (!connector.is_data || connector.target.instance != instance) continue;
    const auto fault = std::ranges::find(connector.properties, "dataport.fault", &std::pair<std::string, std::string>::first);
    if (fault != connector.properties.end() && !fault->second.empty())
      faulty.push_back("connection " + base::in_quotes(connector.name) + " had the fault " + base::in_quotes(fault->second));
  }
  return faulty;
}

tools::SavedSystem alone(const tools::SavedSystem& system, const std::string& instance) {
  tools::SavedSystem one;
  one.id = system.id;
  one.abstract = "a component alone";
  one.creation_date = system.creation_date;
  one.update_date = system.update_date;
  one.components = {*system.component(instance)};
  one.components.front().participants.clear();
  return one;
}

// Other values of the active configuration set than the recorded ones.
base::Result<void> configure(tools::SavedComponent& component, const std::vector<std::string>& settings) {
  for (const auto& text : settings) {
    const auto equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const auto set = std::ranges::find(component.configuration_sets, component.active_set, &tools::SavedConfigurationSet::id);
    const bool has_set = set != component.configuration_sets.end();
    const auto value =
        has_set ? std::ranges::find(set->values, name, &std::pair<std::string, std::string>::first) : tools::NamedValues::iterator();
    if (!has_set || value == set->values.end())
      return base::Error{"component " + component.instance + ": has no parameter " + base::in_quotes(name)};
    value->second = text.substr(equals + 1);
  }
  return {};
}

// The rate in which it ran; the profile may say something else. Of a component that was recorded outside of lock step it is not known, as
// is the tick in which it read a sample.
base::Result<void> take_rate(Console& console, tools::SavedComponent& component, const std::string& file) {
  auto reader = open_recording(file);
  if (!reader) return reader.error();
  bool is_recorded = false;
  for (const auto& [id, channel] : reader->channels()) {
    if (!channel.topic.starts_with("/" + component.instance + "/")) continue;
    is_recorded = true;
    const auto period = channel.metadata.find("period_ns");
    if (period == channel.metadata.end()) continue;
    const auto number = base::parse_integer(period->second).value_or(0);
    if (number > 0 && !component.contexts.empty()) component.contexts.front().rate = base::format_number(1e9 / static_cast<double>(number));
    return {};
  }
  if (is_recorded)
    console.warn(component.instance +
                 " was recorded outside of lock step: in which tick it read a sample is not known, so that its outputs may differ");
  return {};
}

// A world with nothing in it. Where the component ticks at whole steps one step is one tick.
base::Result<std::string> empty_world(const RecordedRun& run, const tools::SavedComponent& component) {
  std::int64_t step = base::parse_integer(run.note("step_ns")).value_or(1'000'000);
  const auto rate = component.contexts.empty() ? 0 : base::parse_number(component.contexts.front().rate).value_or(0);
  const auto period = rate > 0 ? std::llround(1e9 / rate) : 0;
  if (step > 0 && period >= step && period % step == 0) step = period;
  const auto file = (run.folder() / "empty.sdf").string();
  std::ofstream out(file);
  out << "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\"><world name=\"replay\"><physics name=\"default\" type=\"ode\"><max_step_size>"
      << base::format_number(static_cast<double>(step) * 1e-9) << "</max_step_size></physics></world></sdf>\n";
  out.close();
  if (!out) return base::Error{"file " + base::in_quotes(file) + ": cannot be written"};
  return file;
}

Json to_json(const ReplayResult& result) {
  Json json = {{"ticks", result.ticks},
               {"inputs", result.sent},
               {"changes", result.changes},
               {"simulated", result.simulated_s},
               {"wall", result.wall_s}};
  json["outputs"] = Json::array();
  for (const auto& output : result.outputs) {
    json["outputs"].push_back({{"topic", output.topic},
                               {"samples", output.samples},
                               {"recorded", output.recorded},
                               {"different", output.different},
                               {"first", output.first}});
  }
  return json;
}

void report(Console& console, const Options& options, const ReplayResult& result) {
  if (console.json()) {
    console.print(to_json(result));
  } else {
    std::printf("%llu ticks, %llu inputs, %.1f s in %.2f s (%.0f x real time)\n", static_cast<unsigned long long>(result.ticks),
                static_cast<unsigned long long>(result.sent), result.simulated_s, result.wall_s,
                result.wall_s > 0 ? result.simulated_s / result.wall_s : 0);
  }
  for (const auto& output : result.outputs) {
    const bool is_recorded = output.recorded > 0 || !options.compares;
    if (!console.json()) {
      std::cout << output.topic << ": " << output.samples << " samples";
      if (options.compares)
        std::cout << (!is_recorded            ? ", none recorded"
                      : output.different == 0 ? ", equal"
                                              : ", " + std::to_string(output.different) + " differ");
      std::cout << '\n';
    }
    if (output.different > 0) console.fail({output.topic + ": first difference at " + output.first});
  }
}

// What was to be compared has to be there.
std::string nothing_compared(const Options& options, const ReplayResult& result) {
  if (!options.compares || std::ranges::any_of(result.outputs, [](const auto& output) { return output.recorded > 0; })) return "";
  return "replay: cannot compare: the recording has no outputs of " + options.component + " while it was active";
}

base::Result<void> write_report(const Options& options, const ReplayResult& result, const std::string& problem, const std::string& page) {
  tools::RunOptions names;
  names.system = "replay";
  names.world = options.component;
  names.duration_s = result.simulated_s;
  tools::RunResult run;
  run.problem = problem;
  run.page = page;
  run.wall_s = result.wall_s;
  for (const auto& output : result.outputs)
    run.verdicts.push_back(
        {"output " + output.topic + " is as recorded", output.first.empty() ? "" : "first difference at " + output.first});
  return tools::write_junit(options.junit, names, {run});
}

// The page of the recording, which opens at the first difference. It shows the recorded run, not what the component sent now.
base::Result<void> write_page(Console& console, const Options& options, const ReplayResult& result, const std::string& command) {
  tools::RunResult run;
  for (const auto& output : result.outputs) {
    if (output.first.empty()) continue;
    const auto difference = "first difference at " + output.first;
    run.verdicts.push_back({.expectation = "output " + output.topic + " is as recorded",
                            .problem = difference,
                            .failure = "output " + output.topic + " differs from the recording: " + difference,
                            .time = output.first_s,
                            .subject = options.component});
  }
  auto summary = tools::page_summary(run, command);
  for (const char* unknown : {"seed", "hash", "simulated"}) summary.erase(unknown);
  const auto written = tools::write_run_page({options.file, options.page}, summary);
  if (!written) return written.error();
  if (!console.json()) std::cout << "page " << *written;
  return {};
}

std::string repeating_command(const Options& options) {
  std::vector<std::string> words{"--into", options.component, "--compare"};
  const auto add = [&](const char* name, const std::vector<std::string>& values) {
    for (const auto& value : values)
      for (auto& word : base::option_words(name, value)) words.push_back(std::move(word));
  };
  add("--tolerance", options.tolerances);
  add("--ignore", options.ignored);
  add("--link", options.links);
  add("--set", options.settings);
  add("--start", options.start);
  add("--module-path", options.module_paths);
  add("--property", options.properties);
  return base::shell_line(base::command_words({"rtse", "replay"}, {options.file}, words));
}

void conclude(Console& console, const Options& options, const ReplayResult& result, const std::string& problem) {
  if (!problem.empty()) console.fail({problem});
  std::string page;  // an older one stays as it is
  if (!options.page.empty() && problem.empty()) {
    if (const auto written = write_page(console, options, result, repeating_command(options)); written)
      page = options.page;
    else
      console.fail(written.error());
  }
  if (options.junit.empty()) return;
  if (const auto written = write_report(options, result, problem, page); !written) console.fail(written.error());
}

// It is of another maker: its stamps are those of its own clock.
bool has_own_stamps(const RecordedRun& run, const std::string& component) {
  const auto others = base::split_list(run.note("others"), '\n');
  return std::ranges::find(others, component) != others.end();
}

void replay_file(const Session& session, Console& console, const Options& options) {
  for (const auto& file : {options.page, options.junit}) {
    if (const auto writable = file.empty() ? base::Result<void>() : base::check_writable_file(file); !writable)
      return console.reject(writable.error());
  }
  const auto run = RecordedRun::unpack(options.file);
  if (!run) return console.reject(run.error());
  const auto system = tools::read_system(run->system());
  if (!system) return console.reject(system.error());
  if (system->component(options.component) == nullptr) {
    std::vector<std::string> names;
    for (const auto& component : system->components) names.push_back(component.instance);
    return console.reject({"component " + options.component + ": is not in the recording; components: " + base::join(names, ", ")});
  }
  if (const auto faulty = faulty_inputs(*system, options.component); !faulty.empty()) {
    const auto why = base::join(faulty, ", ") + ", which a replay does not repeat";
    if (options.compares) return conclude(console, options, {}, "replay: cannot compare: " + why);
    console.warn(why);
  }
  ReplayOptions replayed{.file = options.file, .component = options.component, .compares = options.compares};
  replayed.tolerated.ignored = options.ignored;
  if (has_own_stamps(*run, options.component)) replayed.tolerated.ignored.emplace_back("tm");
  for (const auto& text : options.tolerances) replayed.tolerated.tolerances.insert(*parse_tolerance(text));
  const auto links = links_of(*system, options);
  if (!links) return console.reject(links.error());
  auto given = possible(console, *links, *system, options);
  if (!given) return console.reject(given.error());
  replayed.links = std::move(*given);
  auto life = RecordedLife::read(options.file, options.component);
  if (!life) return console.reject(life.error());
  if (!life->is_recorded)
    console.warn("configuration and states of " + options.component + ": those of the profile, the recording has no /rtc/" +
                 options.component + "/state");
  for (const auto& text : options.settings) life->forget(text.substr(0, text.find('=')));
  replayed.life = std::move(*life);

  auto one = alone(*system, options.component);
  if (const auto taken = take_rate(console, one.components.front(), options.file); !taken) return console.reject(taken.error());
  auto recorded = run->options();
  if (!recorded) return console.reject(recorded.error());
  auto& call = *recorded;
  const auto world = empty_world(*run, one.components.front());
  if (!world) return console.fail(world.error());
  call.world = *world;
  call.system = (run->folder() / "alone.xml").string();
  call.keep = options.keep;
  call.start = options.start;  // those of the run start others, too
  call.start_folder.clear();
  call.run_file.clear();
  call.hang_timeout_s = options.hang_timeout_s;
  if (const auto good = check_module(options, one.components.front()); !good) return console.reject(good.error());
  call.module_paths.insert(call.module_paths.begin(), options.module_paths.begin(), options.module_paths.end());
  std::erase_if(call.properties, [&](const std::string& property) { return !property.starts_with(options.component + ":"); });
  call.properties.insert(call.properties.end(), options.properties.begin(), options.properties.end());
  if (const auto done = configure(one.components.front(), options.settings); !done) return console.reject(done.error());
  if (const auto written = tools::write_system(one, call.system); !written) return console.fail(written.error());
  ReplayResult result;
  tools::RunHooks hooks;
  hooks.driver = [&](tools::RunningSystem& running) -> base::Result<void> {
    auto done = replay(session.orb(), running, replayed);
    if (!done) return done.error();
    result = std::move(*done);
    return {};
  };
  base::catch_interrupts();
  const auto made = tools::run_system(session.orb(), call, console, hooks);
  if (made.refusal != tools::RunResult::Refusal::none) return console.reject({made.problem});
  std::string problem = made.problem;
  if (!problem.empty() && options.start.empty() && has_own_stamps(*run, options.component))
    problem += "; it was in a third-party process: start that with --start COMMAND";
  // Of all that can be rejected this has a reason that the component's log does not give.
  if (problem.find(": activating ") != std::string::npos)
    problem = "replay: " + options.component +
              " cannot be activated alone; one that uses the simulator's devices finds none in the empty world of a replay (" + problem +
              ")";
  if (problem.empty()) {
    report(console, options, result);
    problem = nothing_compared(options, result);
  }
  conclude(console, options, result, problem);
}

}  // namespace

void add_replay(base::Command& app, tools::Chosen& chosen) {
  auto* command = app.add_subcommand("replay", "Send recorded inputs to one component, in lock step, and compare its outputs");
  auto options = std::make_shared<Options>();
  command->add_option("FILE", options->file, "Recording of rtse run --record")
      ->required()
      ->check(base::valid_file(recording_format_problem));
  command->add_option("--into", options->component, "Instance name of the component")->required();
  command->add_flag("--compare", options->compares, "Fail unless the outputs are bit-identical to the recording");
  command->add_option("--tolerance", options->tolerances, "Absolute tolerance: MEMBER=EPS, or EPS for all members")
      ->allow_extra_args(false)
      ->check([](const std::string& text) {
        const auto parsed = parse_tolerance(text);
        return parsed ? std::string() : parsed.error().message;
      });
  command->add_option("--ignore", options->ignored, "Members to ignore, e.g. tm")->allow_extra_args(false);
  command->add_option("--link", options->links, "Send a recorded port to another InPort: COMPONENT:PORT=INPORT")->allow_extra_args(false);
  command->add_option("--set", options->settings, "Override a recorded parameter: NAME=VALUE")
      ->allow_extra_args(false)
      ->check([](const std::string& text) { return text.find('=') == std::string::npos ? "expected NAME=VALUE" : ""; });
  command->add_option("--start", options->start, "Command that starts the component, if it is a third-party component")
      ->allow_extra_args(false);
  command->add_option("--module-path", options->module_paths, "Folder with modules of components")->allow_extra_args(false);
  command->add_option("--property", options->properties, "Property of the component at its creation: INSTANCE:KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--hang-timeout", options->hang_timeout_s, "Timeout of one tick [wall-clock s]")
      ->check(base::number_between(0.1, 1e6))
      ->capture_default_str();
  command->add_option("--junit", options->junit, "Write the verdicts as JUnit XML")->check(base::output_name());
  command->add_option("--page", options->page, "With --compare: write the recording as an HTML page, opened at the first difference")
      ->check(base::output_name());
  command->add_option("--keep", options->keep, "Folder for the logs")->check(base::output_name());
  command->callback([&chosen, options] {
    tools::require(options->page.empty() || options->compares, "replay", "--page needs --compare");
    chosen.work = [options](const Session& session, Console& console) { replay_file(session, console, *options); };
  });
}

}  // namespace recorder
