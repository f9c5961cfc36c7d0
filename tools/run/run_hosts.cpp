#include "run/run_hosts.h"

#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>

#include "base/text.h"
#include "corba/members/remote_participant.h"
#include "corba/transport/transport.h"
#include "run/module_files.h"
#include "run/prefork_server.h"
#include "run/same_math.h"
#include "run/stopped_process.h"
#include "run/time_members.h"

namespace tools {
namespace {

constexpr std::chrono::seconds kill_limit{5};
constexpr std::chrono::milliseconds end_of_steps{300};  // from the end of a process until the simulator has ended the steps for it

bool is_among(const RunHosts::Members& members, const std::string& instance) {
  return std::ranges::any_of(members, [&](const auto* member) { return member->instance == instance; });
}

template <class Hosts>
auto host_of(Hosts& hosts, const std::string& instance) {
  return std::ranges::find_if(hosts, [&](const auto& host) { return is_among(host.members, instance); });
}

}  // namespace

std::string names_of(const RunHosts::Members& members) {
  std::vector<std::string> names;
  for (const auto* member : members) names.push_back(member->instance);
  return base::join(names, ", ");
}

void RunHosts::use(std::string naming, std::vector<ComponentProperty> properties) {
  naming_ = std::move(naming);
  properties_ = std::move(properties);
}

// "Type?instance_name=...&..." as managers create components.
std::string RunHosts::creation(const SavedComponent& component) const {
  const auto parts = base::split_list(component.id, ':');
  const auto type = parts.size() >= 4 ? parts[3] : component.instance;
  auto text = type + "?instance_name=" + component.instance;
  if (!component.contexts.empty() && !component.contexts.front().rate.empty())
    text += "&exec_cxt.periodic.rate=" + component.contexts.front().rate;
  for (const auto& property : properties_) {
    if (property.instance == component.instance) text += "&" + property.key + "=" + property.value;
  }
  return text;
}

Result<void> RunHosts::start(const Members& members) {
  std::vector<std::string> creations;
  for (const auto* member : members) creations.push_back(creation(*member));
  return start(creations, members, names_of(members));
}

Result<void> RunHosts::start(const std::vector<std::string>& creations, const std::string& names) { return start(creations, {}, names); }

Result<void> RunHosts::start(const std::vector<std::string>& creations, const Members& members, const std::string& names) {
  // What stands in an rtc.conf of the folder or of the user is none of this run's business.
  const auto configuration = place_.scratch("rtc.conf");
  std::ofstream(configuration) << "# empty\n";
  const auto log = place_.new_file("rtcd-" + std::to_string(started_) + ".log");
  std::vector<std::string> more = {"manager.shutdown_auto:NO", "manager.shutdown_on_nortcs:NO"};
  if (!options_.lists.empty()) more.emplace_back("exec_cxt.sim_time.own_thread:NO");  // a fleet: many small components
  if (hashes_.is_wanted()) more.push_back("exec_cxt.sim_time.hash_log:" + hashes_.folder());
  const HostSettings settings{.naming = naming_,
                              .name = "host" + std::to_string(started_++),
                              .module_paths = options_.module_paths,
                              .empty_file = configuration,
                              .options = more,
                              .creations = creations};
  std::map<std::string, std::string> environment = {{"RTMSIM_SERVER_ID", simulator_.id()}, {"TMPDIR", place_.scratch("tmp")}, same_math()};
  environment.merge(same_python());
  auto started = start_program(hooks_.prefork, {host_words(settings), environment, log});
  if (!started) return started.error();
  hosts_.push_back({std::move(*started), members, names, log});
  return {};
}

Result<void> RunHosts::start_all(const Members& all) {
  Members together;
  for (const auto* component : all) {
    const auto parts = base::split_list(component->id, ':');
    const auto type = parts.size() >= 4 ? parts[3] : component->instance;
    const bool is_alone = options_.one_process_each || module_kind(type, options_.module_paths) == ModuleKind::python;
    if (!is_alone) {
      together.push_back(component);
    } else if (const auto started = start(Members{component}); !started) {
      return started;
    }
  }
  const auto count = std::min(together.size(), static_cast<std::size_t>(options_.hosts));
  for (std::size_t i = 0; i < count; ++i) {
    const auto begin = static_cast<std::ptrdiff_t>(i * together.size() / count),
               end = static_cast<std::ptrdiff_t>((i + 1) * together.size() / count);
    if (const auto started = start(Members(together.begin() + begin, together.begin() + end)); !started) return started;
  }
  return {};
}

Result<RunHosts::Members> RunHosts::kill(const std::string& instance) {
  const auto host = host_of(hosts_, instance);
  if (host == hosts_.end()) return Error{"component " + instance + ": its host does not run"};
  ::kill(host->process.pid(), SIGKILL);
  host->process.wait(kill_limit);
  const auto members = host->members;
  killed_.push_back(std::move(*host));
  hosts_.erase(host);
  return members;
}

Result<RunHosts::Members> RunHosts::restart(const std::string& instance) {
  const auto killed = host_of(killed_, instance);
  if (killed == killed_.end()) return Error{"component " + instance + ": its host was not killed"};
  const auto members = killed->members;
  killed_.erase(killed);
  if (const auto started = start(members); !started) return started.error();
  return members;
}

Result<void> RunHosts::check() {
  for (auto& host : hosts_) {
    if (!host.process.is_running()) return end_of(host);
  }
  return {};
}

// Where it was when it ended its last words say, and the lock step: which of its components had not finished their tick, and when.
Error RunHosts::end_of(const Host& host) {
  auto text = "host of " + host.components + " " + host.process.how_it_ended();
  const auto callback = abnormal_exit_in(host.log);
  const auto loss = simulator_.await_loss(end_of_steps);
  const bool is_known = loss && loss->pid == host.process.pid();
  if (callback) {
    text += " in " + callback->callback + " of " + callback->component;
  } else if (is_known && !loss->in_tick.empty()) {
    text += " in the tick of " + base::join(loss->in_tick, ", ");
  }
  if (is_known) {
    text += " at " + base::format_number(loss->time_s) + " s" + (loss->tick > 0 ? ", in tick " + std::to_string(loss->tick) : "");
  } else if (const auto now = simulator_.now(); now && now->time_s > 0) {
    text += " at " + base::format_number(now->time_s) + " s";
  }
  const bool has_failed = host.process.exit_code() < 128 && !callback;  // on its own account, as one that cannot load a module
  return {text + (has_failed ? ": " + telling_line(host.log) : last_output(host.log))};
}

std::vector<RunHosts::Gone> RunHosts::gone_members() {
  constexpr std::string_view ticked = ": the context that was ticked was lost";  // sim_time_proxy.cpp
  std::vector<Gone> gone;
  std::error_code error;
  for (auto& host : hosts_) {
    const auto size = host.members.empty() ? std::filesystem::file_size(host.log, error) : 0;
    if (error || size <= host.looked_at) continue;
    std::string text(size - host.looked_at, '\0');
    std::ifstream file(host.log, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(host.looked_at));
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(text.rfind('\n') + 1);  // nothing of a line that is being written
    host.looked_at += text.size();
    for (const auto& line : base::split_list(text, '\n')) {
      const auto at = std::min(line.find(corba::gone_mark), line.find(ticked));
      if (at == std::string::npos) continue;
      const auto begin = at == 0 ? std::string::npos : line.rfind(' ', at - 1);
      const auto what = line.substr(begin == std::string::npos ? 0 : begin + 1);
      constexpr std::string_view before_time = " at ";
      const auto time = what.rfind(before_time, what.find('('));
      const auto number = time == std::string::npos ? "" : what.substr(time + before_time.size());
      gone.push_back({what.substr(0, what.find(':')), what, base::parse_number(number.substr(0, number.find(' ')))});
    }
  }
  return gone;
}

std::string RunHosts::who_is_waited_for(const SavedSystem& system) const {
  std::map<std::pair<std::string, std::string>, bool> waits;  // by port and id of the connection, as told last
  for (const auto& host : hosts_) {
    for (const auto& line : lines_of(host.log)) {
      const auto at = line.find(corba::port_waits_mark);
      if (at == std::string::npos) continue;
      const auto begin = line.rfind(' ', at) + 1;
      const auto rest = line.substr(at + corba::port_waits_mark.size());
      const auto id_end = rest.rfind(") has ");
      if (id_end == std::string::npos) continue;
      const auto id = rest.substr(0, id_end).substr(rest.rfind('(', id_end) + 1);
      waits[{line.substr(begin, at - begin), id}] = rest.find(" has not ", id_end) != std::string::npos;
    }
  }
  std::string text;
  for (const auto& connector : system.connectors) {
    for (const auto& [own, peer] : {std::pair(&connector.source, &connector.target), std::pair(&connector.target, &connector.source)}) {
      const auto found = waits.find({own->port_name, connector.id});
      if (found != waits.end() && found->second) text += "; " + own->port_name + " waits for " + peer->port_name;
    }
  }
  return text;
}

std::vector<std::string> RunHosts::lost_connections(const SavedSystem& system) const {
  std::vector<std::string> lost;
  for (const auto& host : hosts_) {
    for (const auto& line : lines_of(host.log)) {
      const auto at = line.find(corba::lost_mark);
      if (at == std::string::npos) continue;
      const auto is_it = [&](const SavedConnector& one) { return line.substr(0, at).ends_with("(" + one.id + ")"); };
      const auto connector = std::ranges::find_if(system.connectors, is_it);
      if (connector == system.connectors.end()) continue;  // a tool's
      auto text = connector->source.port_name + " to " + connector->target.port_name + ": " + line.substr(at + corba::lost_mark.size());
      if (std::ranges::find(lost, text) == lost.end()) lost.push_back(std::move(text));
    }
  }
  return lost;
}

std::string RunHosts::what_threw(const std::string& instance) const {
  for (const auto& host : hosts_) {
    for (const auto& line : lines_of(host.log)) {
      const auto at = line.find(corba::threw_mark);
      if (at != std::string::npos && line.substr(0, at).ends_with(" " + instance)) return line.substr(at + corba::threw_mark.size());
    }
  }
  return "";
}

bool RunHosts::has(const std::string& instance) const { return host_of(hosts_, instance) != hosts_.end(); }

bool RunHosts::is_killed(const std::string& instance) const { return host_of(killed_, instance) != killed_.end(); }

std::vector<RunningSystem::Process> RunHosts::processes() const {
  std::vector<RunningSystem::Process> all;
  for (const auto& host : hosts_) all.push_back({"rtcd of " + host.components, host.process.pid()});
  return all;
}

std::vector<std::string> RunHosts::logs() const {
  std::vector<std::string> logs;
  for (const auto& host : hosts_) logs.push_back(host.log);
  return logs;
}

std::string RunHosts::about(const std::string& instance) const {
  const auto host = std::ranges::find_if(hosts_, [&](const Host& one) { return one.components.find(instance) != std::string::npos; });
  return host == hosts_.end() ? "" : ": " + telling_line(host->log);
}

std::vector<std::string> RunHosts::warnings() const {
  constexpr std::size_t enough = 5;
  std::vector<std::string> warnings;
  for (const auto& host : hosts_) {
    std::size_t count = 0;
    for (const auto& line : lines_of(host.log)) {
      const auto level = level_of(line);
      if (level != LogLevel::warning && level != LogLevel::error) continue;
      if (++count <= enough) warnings.push_back(line);
    }
    if (count > enough)
      warnings.push_back("host of " + host.components + ": and " + std::to_string(count - enough) + " more such lines (--keep)");
  }
  return warnings;
}

std::string RunHosts::last_words() const {
  std::string text;
  for (const auto& host : hosts_) text += last_lines(host.log);
  return text;
}

void RunHosts::kill() const {
  if (hooks_.prefork) return;  // somebody else's, whose numbers may belong to others already
  for (const auto& host : hosts_) ::kill(host.process.pid(), SIGKILL);
}

void RunHosts::terminate() {
  for (auto& host : hosts_) host.process.terminate();
}

std::set<std::string> instances_of(const RunHosts::Members& members) {
  std::set<std::string> instances;
  for (const auto* member : members) instances.insert(member->instance);
  return instances;
}

std::string who_is_stopped(const std::vector<RunningSystem::Process>& processes) {
  std::string text;
  for (const auto& one : processes) {
    const auto stopped = one.pid > 0 ? stopped_process(one.pid) : std::nullopt;
    if (stopped) text += one.what + " (pid " + std::to_string(*stopped) + ") is stopped, by a signal or a debugger; ";
  }
  return text;
}

}  // namespace tools
