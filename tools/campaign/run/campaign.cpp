#include "campaign/run/campaign.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/child_process.h"
#include "base/content_hash.h"
#include "base/text.h"
#include "campaign/run/iface_faults.h"
#include "campaign/run/subject_checks.h"
#include "system/connections.h"
#include "system/profile/system_template.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

using tools::SavedComponent;
using tools::SavedConnector;
using tools::SavedSystem;

template <class Items, class Name>
std::string names_in(const Items& items, Name name) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(name(item));
  return names.empty() ? "none" : base::join(names, ", ");
}

std::string component_names(const SavedSystem& system) {
  return names_in(system.components, [](const SavedComponent& component) { return component.instance; });
}

SavedComponent* find_component(SavedSystem& system, const std::string& name) {
  const auto found = std::ranges::find_if(system.components, [&](const auto& component) { return component.instance == name; });
  return found == system.components.end() ? nullptr : &*found;
}

Result<void> set_component(SavedSystem& system, const std::string& path, const std::vector<std::string>& words, const std::string& value) {
  if (words.size() != 3) return Error{path + ": expected component/INSTANCE/PARAMETER"};
  auto* component = find_component(system, words[1]);
  if (!component)
    return Error{path + ": the system has no component " + base::in_quotes(words[1]) + "; components: " + component_names(system)};
  if (words[2] == "rate") {
    const auto rate = base::parse_number(value);
    if (!rate || *rate <= 0 || *rate > 1e9) return Error{path + ": must be more than 0 and at most 1e9 Hz, got " + base::in_quotes(value)};
    if (component->contexts.empty()) return Error{path + ": the component has no execution context in the profile"};
    component->contexts.front().rate = value;
    return {};
  }
  std::vector<std::string> known{"rate"};
  bool found = false;
  for (auto& set : component->configuration_sets) {
    const bool is_active = set.id == component->active_set || component->configuration_sets.size() == 1;
    if (!is_active || set.is_hidden()) continue;
    for (auto& [key, old] : set.values) {
      known.push_back(key);
      if (key != words[2]) continue;
      old = value;
      found = true;
    }
  }
  if (!found)
    return Error{path + ": component " + words[1] + " has no parameter " + base::in_quotes(words[2]) +
                 " in the profile's active set; parameters: " + base::join(known, ", ")};
  return {};
}

// Transports of others read what they like.
bool is_known_key(const SavedConnector& connector, const std::string& key) {
  const std::string& type = connector.interface_type;
  if (!connector.is_data || !(type.empty() || tools::is_own_transport(type))) return true;
  return tools::is_connector_key(key);
}

Result<void> set_connector(SavedSystem& system, const std::string& path, const std::vector<std::string>& words, const std::string& value) {
  if (words.size() != 3) return Error{path + ": expected connector/ID/KEY"};
  const auto found = std::ranges::find_if(system.connectors, [&](const auto& one) { return one.id == words[1] || one.name == words[1]; });
  if (found == system.connectors.end())
    return Error{path + ": the system has no connection " + base::in_quotes(words[1]) +
                 "; connections: " + names_in(system.connectors, [](const SavedConnector& connector) { return connector.id; })};
  const std::string key = words[2].starts_with("dataport.") ? words[2] : "dataport." + words[2];
  auto& values = found->properties;
  const auto old = std::ranges::find_if(values, [&](const auto& one) { return one.first == key; });
  if (old == values.end() && !is_known_key(*found, key))
    return Error{path + ": no connection has a property " + base::in_quotes(words[2]) +
                 "; properties: " + base::join(tools::connector_keys(), ", ")};
  if (old != values.end()) old->second = value;
  if (old == values.end()) values.emplace_back(key, value);
  if (key == "dataport.subscription_type") found->subscription_type = value;
  if (key == "dataport.dataflow_type") found->dataflow_type = value;
  if (key == "dataport.interface_type") found->interface_type = value;
  return {};
}

Result<void> check_property(const SavedSystem& system, const std::string& path, const std::vector<std::string>& words) {
  if (words.size() != 3) return Error{path + ": expected property/INSTANCE/KEY"};
  if (!system.component(words[1]))
    return Error{path + ": the system has no component " + base::in_quotes(words[1]) + "; components: " + component_names(system)};
  return {};
}

Result<void> set_in_system(SavedSystem& system, const std::string& path, const std::string& value) {
  const auto words = base::split_list(path, '/');
  if (words.front() == "component") return set_component(system, path, words, value);
  if (words.front() == "connector") return set_connector(system, path, words, value);
  if (words.front() == "property") return check_property(system, path, words);
  return Error{path +
               ": is no parameter; expected seed, component/..., property/..., connector/..., model/..., light/..., world/... or for/..."};
}

// "for/robot": a list of a system that is a template.
bool is_list_path(const std::string& path) { return path.starts_with("for/"); }

// What a run loads: our programs and libraries, and every module of the plan.
// The files that a row needs, in order: programs and libraries.
std::vector<std::string> programs_of(const Plan& plan) {
  std::vector<std::string> files;
  for (const char* name : {"sim-server", "rtcd", "rtse-campaign"}) files.push_back(base::own_program(name));
  const auto libraries = fs::path(base::own_program("rtcd")).parent_path().parent_path() / "lib";
  auto folders = plan.run.module_paths;
  folders.push_back(libraries.string());
  folders.push_back((libraries / "rtm-sim").string());
  for (const auto& folder : folders) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().filename().string().find(".so") != std::string::npos && entry.is_regular_file(error))
        files.push_back(entry.path().string());
    }
  }
  std::ranges::sort(files);
  return files;
}

Result<std::string> part(const std::string& name, const std::string& file) {
  base::ContentHash hash;
  if (const auto added = hash.add_file(file); !added) return added.error();
  return name + "\t" + hash.text() + "\n";
}

// The models that events spawn. Sets relative paths to absolute ones: in the folder of the plan, else in the one that rtse is called in.
std::vector<std::string> spawned_models(Plan& plan) {
  std::vector<std::string> models;
  for (auto* events : {&plan.events, &plan.hunt.events}) {
    for (auto& event : *events) {
      const bool is_text = event.target.find('<') != std::string::npos;
      if (event.kind != Event::Kind::spawn || is_text || event.target.starts_with("http")) continue;
      std::error_code ignored;  // what is not there is looked for among the models
      for (const auto& folder : {fs::path(plan.folder()), fs::path(".")}) {
        const auto file = fs::absolute(folder / event.target, ignored).lexically_normal();
        if (event.target.find("://") != std::string::npos || !fs::exists(file, ignored)) continue;
        set_spawned(event, file.string());
        break;
      }
      models.push_back(event.target);
    }
  }
  return models;
}

}  // namespace

bool can_be_started(const std::string& name) {
  const auto program = base::own_program(name);
  if (program.find('/') != std::string::npos) return access(program.c_str(), X_OK) == 0;
  const char* path = std::getenv("PATH");
  return std::ranges::any_of(base::split_list(path != nullptr ? path : "", ':'),
                             [&](const std::string& folder) { return access((folder + "/" + program).c_str(), X_OK) == 0; });
}

Result<void> check_programs() {
  for (const char* program : {"sim-server", "rtcd", "omniNames"}) {
    if (!can_be_started(program))
      return Error{std::string("program ") + program + ": cannot be started; expected it beside rtse or in PATH"};
  }
  return {};
}

Result<Campaign> Campaign::prepare(Plan plan) {
  const auto spawned = spawned_models(plan);
  Campaign campaign(std::move(plan));
  if (const auto good = campaign.check_files(); !good) return good.error();
  auto system = campaign.read_system();
  if (!system) return system.error();
  campaign.system_ = std::move(*system);
  if (const auto done = campaign.survey_world(spawned); !done) return done.error();
  if (const auto good = campaign.check_axes(); !good) return good.error();
  if (const auto good = check_subjects(campaign.plan(), campaign.system(), campaign.models()); !good) return good.error();
  if (const auto good = check_iface_faults(campaign.plan()); !good) return good.error();
  auto rows = RowMaker::make(campaign.plan(), campaign.models());
  if (!rows) return rows.error();
  campaign.rows_ = std::make_unique<RowMaker>(std::move(*rows));
  const auto first = campaign.row(1);
  if (!first) return Error{"plan " + base::in_quotes(campaign.plan().file) + ": " + first.error().message};
  if (const auto hashed = campaign.hash_everything(); !hashed) return hashed.error();
  return campaign;
}

// With the first value of each list that varies; the others are tried, too.
Result<SavedSystem> Campaign::read_system() const {
  const auto fail = [&](const Axis& axis, const std::string& why) {
    return Error{"plan " + base::in_quotes(plan_->file) + ": vary: " + axis.path + ": " + why};
  };
  std::vector<const Axis*> lists;
  for (const auto& axis : plan_->axes) {
    if (is_list_path(axis.path)) lists.push_back(&axis);
    if (is_list_path(axis.path) && axis.values.empty()) return fail(axis, "expected a list of values");
  }
  for (const auto* axis : lists) {
    for (const auto& value : axis->values) {
      Row row;
      row.values.emplace_back(axis->path, value);
      if (const auto tried = tools::read_system(plan_->run.system, lists_of(row)); !tried) return fail(*axis, tried.error().message);
    }
  }
  return tools::read_system(plan_->run.system, lists_of({}));
}

Result<void> Campaign::survey_world(const std::vector<std::string>& spawned) {
  auto survey = campaign::survey_world(plan_->run.world, plan_->run.resource_paths, spawned);
  if (!survey) return survey.error();
  survey_ = std::move(*survey);
  if (survey_.not_found.empty()) return {};
  return Error{"plan " + base::in_quotes(plan_->file) + ": events: there is no model " + base::in_quotes(survey_.not_found.front()) +
               " to spawn; expected a file, a folder or model://NAME"};
}

Result<void> Campaign::check_files() const {
  for (const auto& [kind, file] :
       {std::pair("system", &plan_->run.system), std::pair("world", &plan_->run.world), std::pair("expect", &plan_->run.expectations)}) {
    std::error_code error;
    if (!file->empty() && !fs::is_regular_file(*file, error))
      return Error{"plan " + base::in_quotes(plan_->file) + ": " + kind + ": there is no file " + base::in_quotes(*file)};
  }
  for (const auto* paths : {&plan_->run.module_paths, &plan_->run.resource_paths}) {
    for (const auto& path : *paths) {
      std::error_code error;
      if (!fs::is_directory(path, error))
        return Error{"plan " + base::in_quotes(plan_->file) + ": there is no folder " + base::in_quotes(path)};
    }
  }
  return {};
}

// Every value of every list is tried, the ends of every range.
Result<void> Campaign::check_axes() const {
  const auto fail = [&](const Error& error) { return Error{"plan " + base::in_quotes(plan_->file) + ": vary: " + error.message}; };
  for (const auto& axis : plan_->axes) {
    if (is_list_path(axis.path)) continue;  // read_system() has tried them
    auto values = axis.values;
    if (axis.range && axis.range->kind == Range::Kind::normal) values = {base::format_number(axis.range->a)};
    if (axis.range && axis.range->kind != Range::Kind::normal)
      values = {base::format_number(axis.range->a), base::format_number(axis.range->b)};
    std::optional<WorldFile> world;
    if (is_world_path(axis.path)) {
      auto read = WorldFile::read(plan_->run.world, survey_);
      if (!read) return read.error();
      world.emplace(std::move(*read));
    }
    for (const auto& value : values) {
      if (axis.path == "seed") {
        const auto seed = base::parse_integer(value);
        if (!seed || *seed < 0 || *seed > 1e18) return fail({"seed: must be a whole number from 0 to 1e18, got " + base::in_quotes(value)});
        continue;
      }
      auto system = system_;
      if (const auto set = world ? world->set(axis.path, value) : set_in_system(system, axis.path, value); !set) return fail(set.error());
    }
  }
  return {};
}

Result<void> Campaign::hash_everything() {
  base::ContentHash hash;
  hash.add("rows of a campaign, 1");
  for (const auto& file : programs_of(*plan_)) {
    const auto name = fs::path(file).filename().string();
    hash.add(name);
    if (const auto added = hash.add_file(file); !added) return added;
    const auto line = part(name, file);
    if (!line) return line.error();
    parts_ += *line;
  }
  auto files = survey_.files;
  files.insert(plan_->run.system);
  if (!plan_->run.expectations.empty()) files.insert(plan_->run.expectations);
  for (const auto& file : files) {
    if (const auto added = hash.add_file(file); !added) return added;
    const auto line = part(file, file);
    if (!line) return line.error();
    parts_ += *line;
  }
  hash_questions(hash);
  base_key_ = hash.text();
  base::ContentHash questions;
  hash_questions(questions);
  parts_ += "the plan's duration, actions or expectations\t" + questions.text() + "\n";
  return {};
}

// What the plan asks of every run; not how many there are.
void Campaign::hash_questions(base::ContentHash& hash) const {
  hash.add(plan_->expect_text);
  hash.add(base::format_number(plan_->run.duration_s) + (plan_->run.one_process_each ? " each" : "") +
           (plan_->checks_invariants ? " invariants" : ""));
  for (const auto& property : plan_->run.properties) hash.add(property);
  for (const auto& list : plan_->run.lists) hash.add("for " + list);
  for (const auto& measure : plan_->measures) hash.add(measure.text);
  for (const auto& event : plan_->events) hash.add(event.text);
  for (const auto& fault : plan_->faults) hash.add(fault.text());
  for (const auto& condition : plan_->never) hash.add("never " + condition.text);
  for (const auto& condition : plan_->eventually) hash.add("eventually " + condition.text);
}

std::vector<std::string> changed_parts(const std::string& before, const std::string& now) {
  std::map<std::string, std::string> old, fresh;
  for (auto [text, parts] : {std::pair(&before, &old), std::pair(&now, &fresh)}) {
    for (const auto& line : base::split_list(*text, '\n')) parts->emplace(line.substr(0, line.rfind('\t')), line);
  }
  std::vector<std::string> changed;
  for (const auto& [name, line] : fresh) {
    if (const auto found = old.find(name); found == old.end() || found->second != line) changed.push_back(name);
  }
  for (const auto& [name, line] : old) {
    if (!fresh.contains(name)) changed.push_back(name);
  }
  return changed;
}

std::string Campaign::key(const Row& row) const {
  base::ContentHash hash;
  hash.add(base_key_);
  hash.add(std::to_string(row.seed));
  for (const auto& [path, value] : row.values) {
    hash.add(path);
    hash.add(value);
  }
  return hash.text();
}

std::string Campaign::list_key() const {
  base::ContentHash hash;
  hash.add(base_key_);
  hash.add(plan_->text);
  hash.add(fs::absolute(plan_->file).string());
  return hash.text();
}

Result<std::optional<WorldFile>> Campaign::world_of(const Row& row) const {
  if (std::ranges::none_of(row.values, [](const auto& one) { return is_world_path(one.first); })) return std::optional<WorldFile>();
  auto world = WorldFile::read(plan_->run.world, survey_);
  if (!world) return world.error();
  for (const auto& [path, value] : row.values) {
    if (!is_world_path(path)) continue;
    if (const auto set = world->set(path, value); !set) return set.error();
  }
  return std::optional<WorldFile>(std::move(*world));
}

Result<void> Campaign::alter(tools::SavedSystem& system, const Row& row) const {
  for (const auto& [path, value] : row.values) {
    if (is_world_path(path) || is_list_path(path)) continue;
    if (const auto set = set_in_system(system, path, value); !set) return set;
  }
  return {};
}

std::vector<std::string> Campaign::lists_of(const Row& row) const {
  auto lists = plan_->run.lists;
  for (const auto& axis : plan_->axes) {
    if (!is_list_path(axis.path)) continue;
    const auto in_row = std::ranges::find(row.values, axis.path, &std::pair<std::string, std::string>::first);
    lists.push_back(axis.path.substr(axis.path.find('/') + 1) + "=" + (in_row == row.values.end() ? axis.values.front() : in_row->second));
  }
  return lists;
}

std::vector<std::string> Campaign::properties_of(const Row& row) const {
  auto properties = plan_->run.properties;
  for (const auto& [path, value] : row.values) {
    const auto words = base::split_list(path, '/');
    if (words.front() == "property") properties.push_back(words[1] + ":" + words[2] + "=" + value);
  }
  return properties;
}

}  // namespace campaign
