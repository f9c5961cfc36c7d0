#include "run/run_wiring.h"

#include <algorithm>
#include <set>

#include "base/interrupt.h"
#include "base/text.h"
#include "system/remote.h"
#include "system/reporter.h"

namespace tools {
namespace {

using namespace std::chrono_literals;

constexpr auto call_timeout = 5s;

bool is_among(const std::vector<LockstepParticipant>& participants, const std::string& name) {
  return std::ranges::any_of(participants, [&](const auto& one) { return one.name == name; });
}

}  // namespace

// Who joins or is activated may hang in it: an interrupt kills it.
Result<void> RunWiring::wire(std::vector<std::string>& notes) {
  auto& [orb, options, hooks, reporter, place, naming, simulator, hosts, foreign, system] = parts_;
  const base::OnInterrupt early([this] { parts_.foreign.kill(), parts_.hosts.kill(); });
  for (auto& component : system.components) {
    for (auto& set : component.configuration_sets) {
      if (set.is_hidden()) continue;
      for (auto& [key, value] : set.values) {
        if (key == "server_id") value = simulator.id();  // the simulator has an id of its own
      }
    }
  }
  const auto file = place.file("system.xml");
  const auto links = foreign.set_links(system);
  notes.insert(notes.end(), links.begin(), links.end());
  if (const auto written = write_system(system, file); !written) return written;
  const auto timeout = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::duration<double>(options.start_timeout_s));
  session_.emplace(orb, naming.address(), call_timeout, timeout);
  if (const auto wired = check("wired and activated", load(*session_, system)); !wired) return wired;
  if (!foreign.empty()) {
    if (const auto joined = foreign.join(*session_, system, timeout); !joined) return joined;
    if (const auto written = write_system(system, file); !written) return written;
  }
  if (const auto started = check("wired and activated", start(*session_, system)); !started) return started;
  return wait_for_participants();
}

// Reports warnings and failures. The first failure is the run's problem. A driver reports failures itself.
Result<void> RunWiring::check(const std::string& goal, const Changes& changes) {
  for (const auto& warning : changes.warnings) parts_.reporter.warn(warning);
  if (changes.ok()) return {};
  for (const auto& error : changes.errors) {
    if (!parts_.hooks.driver) parts_.reporter.warn(error.message);
  }
  return Error{"system " + parts_.options.system + ": could not be " + goal + ": " + changes.errors.front().message};
}

Result<void> RunWiring::wire_again(const RunHosts::Members& members) {
  const auto& system = parts_.system;
  const auto& hosts = parts_.hosts;
  const auto is_member = [&](const SavedComponent& component) { return std::ranges::find(members, &component) != members.end(); };
  auto all = system;
  auto started = system;
  for (std::size_t i = 0; i < system.components.size(); ++i) {
    if (!is_member(system.components[i])) all.components[i].configuration_sets.clear();
    for (auto& context : all.components[i].contexts) context.state.clear();
  }
  std::erase_if(started.components, [&](const SavedComponent& component) {
    return std::ranges::none_of(members, [&](const auto* member) { return member->instance == component.instance; });
  });
  std::erase_if(started.start_up, [&](const SavedTurn& turn) { return started.component(turn.instance) == nullptr; });
  std::erase_if(all.components, [&](const SavedComponent& component) { return hosts.is_killed(component.instance); });
  const auto is_away = [&](const SavedTarget& end) { return hosts.is_killed(end.instance); };
  std::erase_if(all.connectors, [&](const SavedConnector& one) { return is_away(one.source) || is_away(one.target); });
  if (const auto wired = check("wired and activated again", load(*session_, all)); !wired) return wired;
  if (const auto begun = check("wired and activated again", start(*session_, started)); !begun) return begun;
  return wait_for_participants();
}

// Every context on simulated time takes part before the first step, or the run would not be the same each time.
Result<void> RunWiring::wait_for_participants() {
  auto expected = parts_.foreign.names();
  std::vector<std::string> paths;
  for (const auto& component : parts_.system.components) {
    if (parts_.hosts.has(component.instance)) paths.push_back(component.instance + ".rtc");  // else killed by a script
  }
  for (const auto& view : session_->components(paths, {.contexts = true})) {
    if (!view) return view.error();
    const bool has_time = std::ranges::any_of(view->contexts, [](const ContextView& context) {
      return context.is_owned && context.is_running && property(context.properties, "type") == "SimTimeContext";
    });
    if (has_time) expected.push_back(view->instance);
  }
  std::string missing;
  const auto waited = wait_until_("simulated time", [&] {
    std::set<std::string> there;
    for (const auto& one : parts_.simulator.participants()) there.insert(one.name);
    missing.clear();
    for (const auto& name : expected) {
      if (!there.contains(name)) missing = name;
    }
    return missing.empty();
  });
  if (waited || missing.empty() || base::is_interrupted() || !check_children_()) return waited;
  return Error{"component " + missing + ": does not participate in simulated time after " +
               base::format_number(parts_.options.start_timeout_s) + " s"};
}

bool RunWiring::has_participant_of(const RunHosts::Members& members) {
  const auto there = parts_.simulator.participants();
  return std::ranges::any_of(members, [&](const auto* member) { return is_among(there, member->instance); });
}

// Who is there is known before it cannot be asked.
void RunWiring::set_naming(bool is_there) {
  auto names = is_there ? Result<NamingTree>(Error{}) : session_->tree();
  names_ = names ? std::optional(std::move(*names)) : std::nullopt;
  parts_.naming.set_running(is_there);
}

Result<ComponentView> RunWiring::component(const std::string& instance, Detail detail) {
  if (!names_) return session_->component(instance + ".rtc", detail);
  const auto entry = names_->find_component({false, {instance + ".rtc"}, ""});
  if (!entry) return entry.error();
  const CallLimit limited(call_timeout);
  auto view = read_component(**entry, detail);
  return view.problem.empty() ? Result<ComponentView>(std::move(view)) : Error{"component " + instance + " " + view.problem};
}

}  // namespace tools
