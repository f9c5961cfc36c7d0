// save, load, start, stop, teardown: whole systems, as RTSProfile files.
#include <iostream>

#include "base/output_name.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "system/profile/system_template.h"
#include "system/saved_system.h"

namespace tools {
namespace {

struct SaveCall {
  std::string file = "-";
  bool yaml = false;  // on standard output; a file's ending decides otherwise
  SaveOptions system;
};

// A saved system, and the lists of its template.
struct SystemFile {
  std::string name;
  std::vector<std::string> lists;

  void add_to(base::Command& command) {
    command.add_option("FILE", name, "RTSProfile, XML or YAML; -: standard input")->required();
    command.add_option("--for", lists, base::name_list_help)->type_name("NAME=LIST")->allow_extra_args(false);
  }
};

struct LoadCall {
  SystemFile file;
  LoadOptions options;
};

void save_system(const Session& session, Console& console, const SaveCall& call) {
  const auto snapshot = save(session, call.system);
  if (!snapshot) return console.fail(snapshot.error());
  console.fail(snapshot->left_out);
  if (call.file == "-") {
    std::cout << (call.yaml ? to_yaml(snapshot->system) : to_xml(snapshot->system));
  } else if (const auto written = write_system(snapshot->system, call.file); !written) {
    console.fail(written.error());
  }
}

// Reads the profile, changes the running system by it, and prints what failed; in a dry run, what would be done.
template <class F>
void change_system(Console& console, const SystemFile& file, bool dry_run, F change) {
  const auto system = read_system(file.name, file.lists);
  if (!system) return console.reject(system.error());
  const Changes changes = change(*system);
  if (dry_run) {
    for (const auto& action : changes.actions) std::cout << action << '\n';
  }
  for (const auto& warning : changes.warnings) console.warn(warning);
  console.fail(changes.errors);
}

}  // namespace

void add_system(base::Command& app, Chosen& chosen) {
  auto* save = app.add_subcommand("save", "Save the running system as RTSProfile (XML; YAML by the file's ending)");
  auto call = std::make_shared<SaveCall>();
  save->add_option("FILE", call->file, "Output file (default: standard output)")->check(base::output_name());
  save->add_option("-n,--name", call->system.name, "System name")->capture_default_str();
  save->add_option("-e,--vendor", call->system.vendor, "Vendor")->capture_default_str();
  save->add_option("-v,--version", call->system.version, "Version of the system")->capture_default_str();
  save->add_option("-a,--abstract", call->system.abstract, "Description");
  save->add_flag("-y,--yaml", call->yaml, "Write YAML to standard output");
  save->callback(
      [&chosen, call] { chosen.work = [call](const Session& session, Console& console) { save_system(session, console, *call); }; });

  const auto add = [&](const char* name, const char* help, Changes (*change)(const Session&, const SavedSystem&, bool)) {
    auto* command = app.add_subcommand(name, help);
    auto file = std::make_shared<SystemFile>();
    auto dry_run = std::make_shared<bool>(false);
    file->add_to(*command);
    command->add_flag("--dry-run", *dry_run, "Print the actions without executing them");
    command->callback([&chosen, file, dry_run, change] {
      chosen.work = [=](const Session& session, Console& console) {
        change_system(console, *file, *dry_run, [&](const SavedSystem& system) { return change(session, system, *dry_run); });
      };
    });
  };
  auto* load = app.add_subcommand("load", "Restore connections and configuration of a saved system");
  auto load_call = std::make_shared<LoadCall>();
  load_call->file.add_to(*load);
  load->add_flag("--dry-run", load_call->options.dry_run, "Print the actions without executing them");
  load->add_flag("--states", load_call->options.with_states, "Also restore component states (activate, deactivate, reset)");
  load->add_flag("--force", load_call->options.force, "Also set values that violate the components' types and constraints");
  load->callback([&chosen, load_call] {
    chosen.work = [load_call](const Session& session, Console& console) {
      const auto& options = load_call->options;
      change_system(console, load_call->file, options.dry_run,
                    [&](const SavedSystem& system) { return tools::load(session, system, options); });
    };
  });
  add("start", "Activate the components of a saved system", start);
  add("stop", "Deactivate the components of a saved system", stop);
  add("teardown", "Remove the connections of a saved system", teardown);
}

}  // namespace tools
