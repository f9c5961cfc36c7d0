#include "run/foreign_processes.h"

#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <tuple>

#include "base/text.h"
#include "run/call_order.h"
#include "run/module_files.h"
#include "run/same_math.h"
#include "system/transitions.h"

namespace tools {
namespace {

constexpr const char* phase_key = "exec_cxt.sim_time.phase";
constexpr const char* stamp_key = "dataport.timestamp_policy";

std::string type_of(const SavedComponent& component) {
  const auto parts = base::split_list(component.id, ':');
  return parts.size() >= 4 ? parts[3] : component.instance;
}

bool has_module(const std::string& type, const std::vector<std::string>& paths) { return module_kind(type, paths) != ModuleKind::none; }

std::string shortened(const std::string& command) {
  constexpr std::size_t most = 60;
  return command.size() <= most ? command : command.substr(0, most) + "...";
}

// The system speaks of the component's state in this context.
void use_context(SavedSystem& system, const std::string& instance, const std::string& handle) {
  for (auto& component : system.components) {
    if (component.instance != instance) continue;
    if (component.contexts.empty()) component.contexts.emplace_back();
    component.contexts.resize(1);
    component.contexts.front().id = handle;
  }
  for (auto* turns : {&system.start_up, &system.shut_down}) {
    for (auto& turn : *turns) {
      if (turn.instance == instance) turn.context_id = handle;
    }
  }
}

// True: it was to be sent by a thread of the sender's.
bool send_at_once(SavedConnector& connector) {
  auto type = connector.subscription_type, dataflow = connector.dataflow_type;
  for (const auto& [key, value] : connector.properties) {
    if (key == "dataport.subscription_type") type = value;
    if (key == "dataport.dataflow_type") dataflow = value;
  }
  if (dataflow == "pull" || (type != "new" && type != "periodic")) return false;
  connector.subscription_type = "flush";
  for (auto& [key, value] : connector.properties) {
    if (key == "dataport.subscription_type") value = "flush";
  }
  return true;
}

const ForeignComponent* find(const std::vector<ForeignProcess>& processes, const std::string& instance) {
  for (const auto& process : processes) {
    for (const auto& component : process.components) {
      if (component.instance == instance) return &component;
    }
  }
  return nullptr;
}

}  // namespace

Result<void> ForeignProcesses::read(const RunOptions& options, const SavedSystem& system, std::vector<ComponentProperty>& properties) {
  if (!options.run_file.empty()) {
    auto processes = read_run_file(options.run_file);
    if (!processes) return processes.error();
    processes_ = std::move(*processes);
  }
  for (const auto& process : processes_) {
    for (const auto& component : process.components) {
      if (!system.component(component.instance))
        return Error{"run file " + options.run_file + ": the system has no component " + component.instance};
    }
  }
  if (!options.start_folder.empty() && !std::filesystem::is_directory(options.start_folder))
    return Error{"folder " + base::in_quotes(options.start_folder) + " (--start-folder): there is no such folder"};
  for (const auto& command : options.start) processes_.push_back({.command = command, .folder = options.start_folder});
  for (const auto& component : system.components) {
    const auto* named = find(processes_, component.instance);
    if (!named && (options.start.empty() || has_module(type_of(component), module_paths(options.module_paths)))) continue;
    if (!named) open_.push_back(component.instance);
    TimeMember member{.instance = component.instance};
    if (named) member.how = named->how;
    if (named && named->phase) member.phase = *named->phase;
    member.rate = named && !named->rate.empty() ? named->rate : component.contexts.empty() ? "" : component.contexts.front().rate;
    for (const auto& property : properties) {
      if (property.instance != component.instance) continue;
      if (property.key != phase_key)
        return Error{"property " + property.instance + ":" + property.key + ": the component is in a third-party process, only its " +
                     phase_key + " can be chosen"};
      member.phase = static_cast<int>(base::parse_integer(property.value).value_or(1));
    }
    if (member.rate.empty()) return Error{"component " + component.instance + ": neither the system nor the run file names its rate"};
    members_.push_back(std::move(member));
  }
  if (!options.start.empty() && open_.empty())
    return Error{"command " + base::in_quotes(shortened(options.start.front())) +
                 ": there is a module for each component of the system; name those of the process in a run file"};
  if (!empty()) order_calls(system, properties);
  return {};
}

void ForeignProcesses::order_calls(const SavedSystem& system, std::vector<ComponentProperty>& properties) {
  const auto order = call_order(system, [&](const std::string& instance) {
    const auto member = std::ranges::find(members_, instance, &TimeMember::instance);
    if (member != members_.end()) return CalledComponent{true, member->phase};
    const auto chosen = std::ranges::find_if(properties, [&](const auto& one) { return one.instance == instance && one.key == phase_key; });
    const auto phase = chosen == properties.end() ? std::nullopt : base::parse_integer(chosen->value);
    return CalledComponent{false, phase ? std::optional(static_cast<int>(*phase)) : std::nullopt};
  });
  in_a_circle_ = order.in_a_circle;
  for (auto& member : members_) {
    member.turn = order.turn_of(member.instance);
    if (member.how == TimeMember::How::clock && member.turn > 0)
      nondeterministic_events_.push_back("component " + member.instance +
                                         ": OpenHRP's clock ticks it together with its receivers in the phase: give it another phase");
  }
  for (const auto& component : system.components) {
    if (const int turn = order.turn_of(component.instance); turn > 0 && !has(component.instance))
      properties.push_back({component.instance, turn_key, std::to_string(turn)});
  }
}

bool ForeignProcesses::has(const std::string& instance) const {
  return std::ranges::any_of(members_, [&](const auto& member) { return member.instance == instance; });
}

std::vector<std::string> ForeignProcesses::components_of(const ForeignProcess& process) const {
  if (process.components.empty()) return open_;
  std::vector<std::string> names;
  for (const auto& component : process.components) names.push_back(component.instance);
  return names;
}

std::chrono::duration<double> ForeignProcesses::start_timeout(std::chrono::duration<double> usual) const {
  double longest = 0;
  for (const auto& process : processes_) longest = std::max(longest, process.wait_s.value_or(usual.count()));
  return std::chrono::duration<double>(longest);
}

std::vector<RunningSystem::Process> ForeignProcesses::processes() const {
  std::vector<RunningSystem::Process> all;
  for (const auto& running : running_) all.push_back({"process of " + running.components, running.process.pid()});
  return all;
}

Result<void> ForeignProcesses::start(const std::string& naming, const std::string& server_id) {
  const auto configuration = place_.scratch("foreign-rtc.conf");
  std::ofstream(configuration) << "corba.nameservers: " << naming
                               << "\nlogger.enable: YES\nlogger.file_name: stdout\nlogger.log_level: INFO\n"
                               << "manager.shutdown_auto: NO\n";
  const std::map<std::string, std::string> usual = {{"RTCTREE_NAMESERVERS", naming},
                                                    {"RTMSIM_NAMING", naming},
                                                    {"ORBInitRef", "NameService=corbaname::" + naming},
                                                    {"RTC_MANAGER_CONFIG", configuration},
                                                    {"RTMSIM_SERVER_ID", server_id},
                                                    {"PYTHONUNBUFFERED", "1"},
                                                    same_math()};
  for (const auto& process : processes_) {
    const auto components = base::join(components_of(process), ", ");
    const auto log = place_.new_file("foreign-" + std::to_string(running_.size()) + ".log");
    base::ProgramCall call{{"sh", "-c", process.command}, process.environment, log, process.folder, true};
    call.environment.insert(usual.begin(), usual.end());
    auto started = base::ChildProcess::start(call);
    if (!started) return started.error();
    running_.push_back({std::move(*started), components, log});
  }
  return {};
}

std::vector<std::string> ForeignProcesses::names() const {
  std::vector<std::string> names;
  for (const auto& member : members_) names.push_back(member.instance);
  return names;
}

std::vector<std::string> ForeignProcesses::proxies() const {
  std::vector<std::string> names;
  for (const auto& member : members_) {
    if (member.how != TimeMember::How::clock) names.push_back(proxy_name(member.instance));
  }
  return names;
}

std::vector<std::string> ForeignProcesses::creations(const std::string& server_id) const {
  int phase = 1;
  for (const auto& member : members_) {
    if (member.how == TimeMember::How::clock) phase = member.phase;
  }
  std::vector<std::string> all = {clock_creation(phase, server_id)};
  for (const auto& member : members_) {
    if (member.how != TimeMember::How::clock) all.push_back(proxy_creation(member, server_id));
  }
  return all;
}

Result<void> ForeignProcesses::join(const Session& session, SavedSystem& system, std::chrono::milliseconds timeout) {
  for (const auto& member : members_) {
    if (member.how == TimeMember::How::clock) continue;
    const auto path = member.instance + ".rtc";
    if (const auto joined = join_time(session, path, proxy_name(member.instance) + ".rtc", member.how, timeout); !joined) return joined;
    const auto view = session.component(path, {.contexts = true});
    if (!view) return view.error();
    if (member.how == TimeMember::How::tick && ticks_on_its_own(*view))
      nondeterministic_events_.push_back(
          "component " + member.instance +
          ": its context, an ExtTrigExecutionContext, runs it on a thread of its own after each tick: join it as a member");
    if (const auto* context = simulated_context(*view)) use_context(system, member.instance, std::to_string(context->handle));
  }
  return {};
}

std::vector<std::string> ForeignProcesses::rest(const Session& session, const SavedSystem& system) const {
  const auto turn = [&](const TimeMember& member) {
    const auto listed = std::ranges::find(system.shut_down, member.instance, &SavedTurn::instance);
    return listed == system.shut_down.end() ? std::numeric_limits<int>::max() : listed->sequence;
  };
  auto members = members_;
  std::ranges::stable_sort(members, {}, turn);
  std::vector<std::string> problems;
  const auto end = std::chrono::steady_clock::now() + default_transition_timeout;  // of all that hang
  for (const auto& member : members) {
    if (std::chrono::steady_clock::now() > end) {
      problems.push_back("component " + member.instance + ": was not deactivated: other components took too long");
      continue;
    }
    if (const auto rests = rest_in_time(session, member.instance + ".rtc", member.how); !rests) problems.push_back(rests.error().message);
  }
  return problems;
}

std::optional<ForeignProcesses::Ended> ForeignProcesses::ended() {
  for (std::size_t i = 0; i < running_.size(); ++i) {
    auto& one = running_[i];
    if (!one.process.is_running())
      return Ended{components_of(processes_[i]),
                   processes_[i].components.empty(),
                   std::ranges::count_if(processes_, [](const auto& process) { return process.components.empty(); }) == 1,
                   shortened(processes_[i].command),
                   one.process.how_it_ended(),
                   telling_line(one.log)};
  }
  return std::nullopt;
}

std::string ForeignProcesses::about(const std::string& instance) const {
  for (std::size_t i = 0; i < running_.size(); ++i) {
    const auto names = components_of(processes_[i]);
    if (std::ranges::find(names, instance) != names.end())
      return " (" + shortened(processes_[i].command) + "): " + telling_line(running_[i].log);
  }
  return "";
}

std::string ForeignProcesses::traceback_of(const std::string& instance) const {
  for (std::size_t i = 0; i < running_.size(); ++i) {
    const auto names = components_of(processes_[i]);
    if (std::ranges::find(names, instance) == names.end()) continue;
    if (auto line = last_line_of_traceback(running_[i].log); !line.empty()) return line;
  }
  return "";
}

std::string ForeignProcesses::last_words() const {
  std::string text;
  for (const auto& one : running_) text += last_lines(one.log);
  return text;
}

void ForeignProcesses::kill() const {
  for (const auto& one : running_) ::kill(-one.process.pid(), SIGKILL);
}

void ForeignProcesses::terminate() {
  for (auto& one : running_) one.process.terminate();
}

std::string ForeignProcesses::who_may_be_waited_for(const SavedSystem& system, const std::vector<std::string>& late) const {
  std::string text;
  for (const auto& connector : system.connectors) {
    const auto& [source, target] = std::tie(connector.source, connector.target);
    const bool is_late = std::ranges::find(late, source.instance) != late.end();
    if (connector.is_data && is_late && has(source.instance) && source.instance != target.instance)
      text += "; " + source.port_name + " sends to " + target.port_name;
  }
  return text;
}

std::vector<std::string> ForeignProcesses::set_links(SavedSystem& system) const {
  std::vector<std::string> stamped, differing, flushed;
  for (auto& connector : system.connectors) {
    if (!connector.is_data || !has(connector.source.instance)) continue;
    const auto link = connector.source.port_name + " to " + connector.target.port_name;
    if (send_at_once(connector)) flushed.push_back(link);
    const bool is_said = std::ranges::any_of(connector.properties, [](const auto& one) { return one.first.ends_with("timestamp_policy"); });
    if (has(connector.target.instance)) {
      differing.push_back(link);
    } else if (!is_said) {
      connector.properties.emplace_back(stamp_key, "on_received");
      stamped.push_back(link);
    }
  }
  std::vector<std::string> notes;
  if (!flushed.empty())
    notes.push_back("sent within the tick (subscription type flush), because a thread of a third-party component belongs to no tick: " +
                    base::join(flushed, ", "));
  if (!in_a_circle_.empty())
    notes.push_back("between components of one phase that are connected in a circle, so read in the tick in which it is sent: " +
                    base::join(in_a_circle_, ", "));
  if (!stamped.empty())
    notes.push_back("stamped with simulated time by the receiver (timestamp_policy on_received): " + base::join(stamped, ", "));
  if (!differing.empty())
    notes.push_back("between third-party components, with stamps of their own clocks, which differ in each run: " +
                    base::join(differing, ", "));
  return notes;
}

}  // namespace tools
