// check: the running system beside a saved one.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "system/profile/matched_system.h"
#include "system/profile/system_template.h"

namespace tools {
namespace {

// What is not as in the file, in order.
class Differences {
 public:
  void add(const Error& difference) { found_.push_back(difference); }
  // A line each on standard error, or one JSON object on standard output.
  void tell(Console& console) const {
    if (!console.json()) {
      for (const auto& difference : found_) console.fail(difference);
      return;
    }
    auto texts = nlohmann::ordered_json::array();
    for (const auto& difference : found_) texts.push_back(difference.message);
    console.print({{"same", found_.empty()}, {"differences", texts}});
    if (!found_.empty()) console.set_failed();
  }

 private:
  std::vector<Error> found_;
};

void check_connection(const Matched& matched, const SavedConnector& saved, Differences& differences) {
  if (matched.leaves_out(saved.source) || matched.leaves_out(saved.target)) return;
  const auto from = matched.port(saved.source), to = matched.port(saved.target);
  if (!from || !to) return differences.add({"connection " + saved.id + ": " + (from ? to : from).error().message});
  const PortView *source = *from, *target = *to;
  for (const auto& connector : source->connectors) {
    if (!same_connection(connector, *source, *target)) continue;
    if (!saved.is_data) return;
    const auto wanted = connect_properties(saved);
    for (const auto* key : {"dataport.interface_type", "dataport.dataflow_type", "dataport.subscription_type"}) {
      const auto is = property(connector.properties, key);
      const auto should = property(wanted, key);
      if (!should.empty() && !base::equal_ignoring_case(is, should))
        differences.add({"connection " + saved.id + ": " + key + " is " + base::in_quotes(is) + ", expected " + base::in_quotes(should)});
    }
    return;
  }
  differences.add({"connection " + saved.id + ": " + source->full_name + " and " + target->full_name + " are not connected"});
}

void check_component(const Matched& matched, const SavedComponent& saved, const std::string& state, Differences& differences) {
  const auto* component = matched.find(saved.path_uri, saved.instance);
  if (!component || !component->problem.empty()) return;
  if (component->profile_id() != saved.id)
    differences.add({"component " + component->path + ": is a " + component->profile_id() + ", expected " + saved.id});
  if (!saved.active_set.empty() && component->active_set != saved.active_set) {
    differences.add({"component " + component->path + ": active configuration set is " + base::in_quotes(component->active_set) +
                     ", expected " + base::in_quotes(saved.active_set)});
  }
  for (const auto& set : saved.configuration_sets) {
    if (set.is_hidden()) continue;
    for (const auto& [key, value] : set.values) {
      std::string is;
      bool found = false;
      for (const auto& candidate : component->configuration_sets) {
        for (const auto& [name, text] : candidate.values) {
          if (candidate.id != set.id || name != key) continue;
          is = text;
          found = true;
        }
      }
      if (!found || is != value)
        differences.add({"component " + component->path + ": parameter " + set.id + "." + key + " is " +
                         (found ? base::in_quotes(is) : "missing") + ", expected " + base::in_quotes(value)});
    }
  }
  if (state.empty() || base::equal_ignoring_case(state, "any")) return;
  for (const auto& context : component->contexts) {
    if (!context.is_owned) continue;
    auto wanted = state;
    if (base::equal_ignoring_case(state, "saved")) {
      const auto handle = std::to_string(context.handle);
      const auto same = std::find_if(saved.contexts.begin(), saved.contexts.end(), [&](const auto& one) { return one.id == handle; });
      wanted = same == saved.contexts.end() ? "" : same->state;
    }
    if (!wanted.empty() && !base::equal_ignoring_case(state_text(context.state), wanted)) {
      differences.add({"component " + component->path + ": is " + state_text(context.state) + " in context " +
                       std::to_string(context.handle) + ", expected " + wanted});
    }
  }
}

// State: that of every component; "any": not compared; "saved": as the file says.
void check_system(const Session& session, Console& console, const std::string& file, const std::vector<std::string>& lists,
                  const std::string& state) {
  const auto system = read_system(file, lists);
  if (!system) return console.reject(system.error());
  const auto matched = Matched::read(session, *system, {.contexts = true, .connectors = true, .configuration = true});
  if (!matched) return console.fail(matched.error());
  Differences differences;
  for (const auto& missing : matched->missing()) differences.add(missing);
  for (const auto& line : matched->absent()) console.warn(line);
  for (const auto& connector : system->connectors) check_connection(*matched, connector, differences);
  for (const auto& component : system->components) check_component(*matched, component, state, differences);
  differences.tell(console);
}

}  // namespace

void add_check(base::Command& app, Chosen& chosen) {
  auto* check = app.add_subcommand("check", "Compare the running system with a saved one; print a line per difference");
  auto file = std::make_shared<std::string>();
  auto lists = std::make_shared<std::vector<std::string>>();
  auto state = std::make_shared<std::string>("any");
  check->add_option("FILE", *file, "RTSProfile, XML or YAML")->required();
  check->add_option("--for", *lists, base::name_list_help)->type_name("NAME=LIST")->allow_extra_args(false);
  check->add_option("-s,--state", *state, "Expected state of every component; saved: the state in FILE")
      ->capture_default_str()
      ->check(base::one_of({"created", "inactive", "active", "error", "any", "saved"}, base::Case::does_not_matter));
  check->callback([&chosen, file, lists, state] {
    chosen.work = [=](const Session& session, Console& console) { check_system(session, console, *file, *lists, *state); };
  });
}

}  // namespace tools
