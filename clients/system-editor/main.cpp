// rtse, the command-line system editor: lists, wires, configures, starts and saves systems of RT components.
#include <iostream>

#include "base/command_line.h"
#include "base/text.h"
#include "editor.h"
#include "names_offered.h"
#include "orb.h"
#include "output.h"
#include "run/run_system.h"
#include "skeleton/skeleton.h"

namespace {

using editor::Editor;

struct Settings {
  std::string server = editor::default_server();
  bool json = false;
  double limit_s = 1;
};

using Work = std::function<void(Editor&)>;

// For what CLI11 cannot say of a command line: exit code 2 and a line.
void require(bool is_right, const std::string& command, const std::string& expectation) {
  if (!is_right) throw CLI::ValidationError(command, expectation);
}

// Each function declares one group of commands; the chosen one ends up in `work`.
void add_listing(CLI::App& app, Work& work) {
  auto* ls = app.add_subcommand("ls", "List components, managers and contexts");
  auto list = std::make_shared<editor::ListOptions>();
  ls->add_option("PATH", list->path, "Where to look; default: the whole name server");
  ls->add_flag("-l,--long", list->is_long, "With state, rate and ports (all/connected)");
  ls->add_flag("-R,--recurse", list->recurse, "Contexts inside contexts too");
  ls->callback([&work, list] { work = [list](Editor& e) { editor::list(e, *list); }; });

  auto* tree = app.add_subcommand("tree", "Show the name server as a tree, with states and ports");
  auto tree_path = std::make_shared<std::string>();
  tree->add_option("PATH", *tree_path, "Where to start");
  tree->callback([&work, tree_path] { work = [tree_path](Editor& e) { editor::tree(e, *tree_path); }; });

  auto* cat = app.add_subcommand("cat", "Show all of a component, port or manager");
  auto cat_path = std::make_shared<std::string>();
  auto cat_long = std::make_shared<bool>(false);
  cat->add_option("PATH", *cat_path, "COMPONENT, COMPONENT:PORT or MANAGER")->required();
  cat->add_flag("-l,--long", *cat_long, "With all properties");
  cat->callback([&work, cat_path, cat_long] { work = [cat_path, cat_long](Editor& e) { editor::cat(e, *cat_path, *cat_long); }; });

  auto* watch = app.add_subcommand("watch", "Full-screen view of components, states, ports and connections");
  auto watch_path = std::make_shared<std::string>();
  watch->add_option("PATH", *watch_path, "A name server, as /HOST:PORT");
  watch->callback([&work, watch_path] { work = [watch_path](Editor& e) { editor::watch(e, *watch_path); }; });
}

void add_states(CLI::App& app, Work& work) {
  const auto add = [&](const char* name, const char* help, editor::Transition transition) {
    auto* command = app.add_subcommand(name, help);
    auto paths = std::make_shared<std::vector<std::string>>();
    auto context = std::make_shared<int>(-1);
    command->add_option("PATH", *paths, "Components")->required();
    command->add_option("-e,--context", *context, "Index of the execution context; default: the first")
        ->check(base::number_between(0, 1000));
    command->callback(
        [&work, paths, context, transition] { work = [=](Editor& e) { editor::change_state(e, *paths, transition, *context); }; });
  };
  add("act", "Activate components", editor::Transition::activate);
  add("deact", "Deactivate components", editor::Transition::deactivate);
  add("reset", "Reset components that are in the error state", editor::Transition::reset);

  auto* exit = app.add_subcommand("exit", "End components");
  auto exit_paths = std::make_shared<std::vector<std::string>>();
  exit->add_option("PATH", *exit_paths, "Components")->required();
  exit->callback([&work, exit_paths] { work = [exit_paths](Editor& e) { editor::exit_components(e, *exit_paths); }; });

  auto* del = app.add_subcommand("del", "Delete names from the name server; what they name need not answer");
  auto del_paths = std::make_shared<std::vector<std::string>>();
  auto zombies = std::make_shared<bool>(false);
  del->add_option("PATH", *del_paths, "Names");
  del->add_flag("-z,--zombies", *zombies, "All names whose object is gone");
  auto force = std::make_shared<bool>(false);
  del->add_flag("--force", *force, "Contexts that hold living objects too");
  del->callback([&work, del_paths, zombies, force] {
    require(!del_paths->empty() || *zombies, "del", "expected names, or -z for all whose object is gone");
    work = [=](Editor& e) { editor::delete_bindings(e, *del_paths, *zombies, *force); };
  });

  auto* wait = app.add_subcommand("wait", "Wait until components are in a state");
  auto wait_paths = std::make_shared<std::vector<std::string>>();
  auto state = std::make_shared<std::string>("Active");
  auto timeout = std::make_shared<double>(10);
  wait->add_option("PATH", *wait_paths, "Components")->required();
  wait->add_option("--state", *state, "Inactive, Active, Error, any (is there), gone")
      ->capture_default_str()
      ->check(CLI::IsMember({"created", "inactive", "active", "error", "any", "gone"}, CLI::ignore_case));
  wait->add_option("--timeout", *timeout, "Seconds")->capture_default_str()->check(base::number_between(0.0, 1e6));
  wait->callback(
      [&work, wait_paths, state, timeout] { work = [=](Editor& e) { editor::wait_for_state(e, *wait_paths, *state, *timeout); }; });
}

void add_configuration(CLI::App& app, Work& work) {
  auto* conf = app.add_subcommand("conf", "Show and change configuration sets: conf PATH [list | get NAME | set NAME VALUE | use SET]");
  auto options = std::make_shared<editor::ConfigurationOptions>();
  conf->add_option("PATH", options->path, "Component")->required();
  conf->add_option("ACTION", options->action, "list, get, set or use")->check(CLI::IsMember({"list", "get", "set", "use", "act"}));
  conf->add_option("ARGUMENT", options->arguments, "Parameter, value or set");
  conf->add_option("-s,--set", options->set, "The set to read or change; default: the active one");
  conf->add_flag("-a,--all", options->all, "Hidden sets too");
  conf->add_flag("--force", options->force, "Set also what the component's own types and constraints forbid");
  conf->callback([&work, options] {
    for (auto& argument : options->arguments) {
      if (argument.starts_with(" [")) argument.erase(0, 1);  // see words_of
    }
    const auto& action = options->action;
    const auto count = options->arguments.size();
    require(action != "list" || count == 0, "conf list", "expected nothing more");
    require(action != "get" || count == 1, "conf get", "expected one parameter");
    require(action != "set" || count == 2, "conf set", "expected a parameter and a value");
    require((action != "use" && action != "act") || count == 1, "conf " + action, "expected one configuration set");
    work = [options](Editor& e) { editor::configure(e, *options); };
  });
}

void add_connections(CLI::App& app, Work& work) {
  auto* con = app.add_subcommand("con", "Connect ports");
  auto options = std::make_shared<editor::ConnectOptions>();
  con->add_option("PORT", options->ports, "COMPONENT:PORT, two or more")->required()->expected(2, 64);
  con->add_option("-i,--id", options->id, "Connector id; default: a new one");
  con->add_option("-n,--name", options->name, "Name of the connection");
  con->add_option("-p,--property", options->properties, "KEY=VALUE, e.g. subscription_type=new")->allow_extra_args(false);
  con->add_flag("-d,--no-duplicates", options->no_duplicates, "Do nothing when they are connected already");
  con->callback([&work, options] { work = [options](Editor& e) { editor::connect(e, *options); }; });

  auto* dis = app.add_subcommand("dis", "Disconnect: two ports, all of a port or component, or one by id");
  auto paths = std::make_shared<std::vector<std::string>>();
  auto id = std::make_shared<std::string>();
  dis->add_option("PATH", *paths, "Ports or a component")->expected(0, 2);
  dis->add_option("-i,--id", *id, "Connector id");
  dis->callback([&work, paths, id] {
    require(!paths->empty() || !id->empty(), "dis", "expected one component or port, two ports, or -i ID");
    work = [=](Editor& e) { editor::disconnect(e, *paths, *id); };
  });
}

void add_data(CLI::App& app, Work& work) {
  auto* print = app.add_subcommand("print", "Print what OutPorts send");
  auto options = std::make_shared<editor::PrintOptions>();
  print->add_option("PORT", options->ports, "OutPorts")->required();
  print->add_option("-n,--count", options->count, "End after so many samples")->check(base::number_between(0, 1e9));
  print->add_option("-t,--timeout", options->timeout_s, "End after so many seconds")->check(base::number_between(0.0, 1e9));
  print->add_option("-r,--rate", options->rate, "At most so many samples a second")->check(base::number_between(0.0, 1e6));
  print->callback([&work, options] { work = [options](Editor& e) { editor::print_ports(e, *options); }; });

  auto* inject = app.add_subcommand("inject", "Write values to an InPort");
  auto values = std::make_shared<editor::InjectOptions>();
  inject->add_option("PORT", values->port, "InPort")->required();
  inject->add_option("VALUE", values->values, "JSON, or RTC.TimedLong({time}, 42)")->required();
  inject->add_option("-n,--count", values->count, "How often; 0: until stopped")
      ->check(base::number_between(0, 1e9))
      ->capture_default_str();
  inject->add_option("-r,--rate", values->rate, "How often a second")->check(base::number_between(1e-3, 1e5))->capture_default_str();
  inject->callback([&work, values] { work = [values](Editor& e) { editor::inject(e, *values); }; });
}

void add_systems(CLI::App& app, Work& work) {
  auto* save = app.add_subcommand("save", "Save the running system as RTSProfile (XML; YAML by the file's ending)");
  auto options = std::make_shared<editor::SaveOptions>();
  save->add_option("FILE", options->file, "Where to; default: standard output");
  save->add_option("-n,--name", options->name, "System name")->capture_default_str();
  save->add_option("-e,--vendor", options->vendor, "Vendor")->capture_default_str();
  save->add_option("-v,--version", options->version, "Version of the system")->capture_default_str();
  save->add_option("-a,--abstract", options->abstract, "What it is");
  save->add_flag("-y,--yaml", options->yaml, "YAML on standard output");
  save->callback([&work, options] { work = [options](Editor& e) { editor::save(e, *options); }; });

  const auto add = [&](const char* name, const char* help, void (*function)(Editor&, const std::string&, bool)) {
    auto* command = app.add_subcommand(name, help);
    auto file = std::make_shared<std::string>();
    auto dry_run = std::make_shared<bool>(false);
    command->add_option("FILE", *file, "RTSProfile, XML or YAML; -: standard input")->required();
    command->add_flag("--dry-run", *dry_run, "Say what would be done");
    command->callback([&work, file, dry_run, function] { work = [=](Editor& e) { function(e, *file, *dry_run); }; });
  };
  auto* load = app.add_subcommand("load", "Restore connections and configuration of a saved system");
  auto load_options = std::make_shared<editor::LoadOptions>();
  load->add_option("FILE", load_options->file, "RTSProfile, XML or YAML; -: standard input")->required();
  load->add_flag("--dry-run", load_options->dry_run, "Say what would be done");
  load->add_flag("--states", load_options->with_states, "The components' states too: activate, deactivate and reset as saved");
  load->add_flag("--force", load_options->force, "Set also values that the components' own types and constraints forbid");
  load->callback([&work, load_options] { work = [load_options](Editor& e) { editor::load(e, *load_options); }; });
  add("start", "Activate the components of a saved system", editor::start);
  add("stop", "Deactivate the components of a saved system", editor::stop);
  add("teardown", "Remove the connections of a saved system", editor::teardown);

  auto* check = app.add_subcommand("check", "Compare the running system with a saved one; a line per difference");
  auto file = std::make_shared<std::string>();
  auto state = std::make_shared<std::string>("any");
  check->add_option("FILE", *file, "RTSProfile, XML or YAML")->required();
  check->add_option("-s,--state", *state, "State that every component should be in; saved: each in its own")
      ->capture_default_str()
      ->check(CLI::IsMember({"created", "inactive", "active", "error", "any", "saved"}, CLI::ignore_case));
  check->callback([&work, file, state] { work = [=](Editor& e) { editor::check_system(e, *file, *state); }; });
}

void add_run(CLI::App& app, Work& work) {
  auto* run = app.add_subcommand("run", "Run a saved system against a simulated world in lock step, and judge it");
  auto options = std::make_shared<editor::RunOptions>();
  auto seeds = std::make_shared<std::optional<std::string>>();
  auto jobs = std::make_shared<int>(1);
  run->add_option("SYSTEM", options->system, "RTSProfile, XML or YAML")->required()->check(CLI::ExistingFile);
  run->add_option("-w,--world", options->world, "SDFormat world")->required()->check(CLI::ExistingFile);
  run->add_option("-d,--duration", options->duration_s, "Simulated seconds")
      ->check(base::number_between(0.001, 1e7))
      ->capture_default_str();
  run->add_option("-x,--expect", options->expectations, "Expectations, YAML")->check(CLI::ExistingFile);
  auto* seed =
      run->add_option("--seed", options->seed, "Seed of the world's noise")->capture_default_str()->check(base::number_between(0, 1e18));
  run->add_option("--seeds", *seeds, "A run for each seed FIRST..LAST")->excludes(seed)->check([](const std::string& text) {
    const auto parsed = editor::parse_seeds(text);
    return parsed ? std::string() : parsed.error().message;
  });
  run->add_option("-j,--jobs", *jobs, "So many seeds at a time")->check(CLI::Range(1, 64))->capture_default_str();
  run->add_flag("--one-process-each", options->one_process_each, "A process for every component instead of one for all");
  run->add_flag("--realtime", options->in_real_time, "No faster than real time");
  run->add_option("--module-path", options->module_paths, "Folder with modules of components")->allow_extra_args(false);
  run->add_option("--resource-path", options->resource_paths, "Folder with models")->allow_extra_args(false);
  run->add_option("--property", options->properties, "INSTANCE:KEY=VALUE, a property that a component is created with")
      ->allow_extra_args(false)
      ->check([](const std::string& text) {
        const auto parsed = editor::parse_property(text);
        return parsed ? std::string() : parsed.error().message;
      });
  run->add_option("--hang-timeout", options->hang_timeout_s, "Seconds of real time that one tick may take")
      ->check(base::number_between(0.1, 1e6))
      ->capture_default_str();
  run->add_option("--junit", options->junit, "Write the verdicts as JUnit XML");
  run->add_option("--picture", options->picture, "Write the world at the end as PNG");
  run->add_option("--keep", options->keep, "Keep logs and the record in this folder");
  run->callback([&work, options, seeds, jobs] { work = [=](Editor& e) { editor::run(e, *options, *seeds, *jobs); }; });
}

void add_managers(CLI::App& app, Work& work) {
  auto* mgr = app.add_subcommand(
      "mgr", "Talk to a manager: mgr list | create TYPE[?key=value&...] | delete INSTANCE | load FILE [INIT] | unload FILE");
  auto options = std::make_shared<editor::ManagerOptions>();
  mgr->add_option("ACTION", options->action, "list, create, delete, load, unload")
      ->required()
      ->check(CLI::IsMember({"list", "create", "delete", "load", "unload"}));
  mgr->add_option("ARGUMENT", options->arguments, "Types, instances or files");
  mgr->add_option("-m,--manager", options->manager, "Path or corbaloc::HOST[:PORT][/ID]; default: the only one of the name server");
  mgr->callback([&work, options] {
    require(options->action != "list" || options->arguments.empty(), "mgr list", "expected nothing more");
    require(options->action == "list" || !options->arguments.empty(), "mgr " + options->action, "expected a name");
    for (const auto& argument : options->action == "create" ? options->arguments : std::vector<std::string>()) {
      const auto question = std::min(argument.find('?'), argument.size());
      for (const auto& option : base::split_list(argument.substr(question == argument.size() ? question : question + 1), '&'))
        require(option.empty() || option.find('=') != std::string::npos, "mgr create",
                "expected KEY=VALUE after the '?', got \"" + option + "\"");
    }
    work = [options](Editor& e) { editor::manage(e, *options); };
  });
}

}  // namespace

namespace {

// CLI11 takes a word in brackets apart at its commas; with a blank before it stays one value, which JSON does not mind.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> words(argv, argv + argc);
  for (auto& word : words) {
    if (word.starts_with('[') && word.ends_with(']')) word.insert(0, " ");
  }
  return words;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "rtse: list, wire, configure, start and save systems of RT components\n"
      "Paths: /HOST[:PORT]/CONTEXT.KIND/NAME.rtc:PORT, relative to $RTCSH_CWD, or any tail that names one thing (NAME:PORT)."};
  base::add_standard_options(app, "rtse", RTMSIM_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  Settings settings;
  app.add_option("--ns", settings.server, "Name server HOST[:PORT]; default: the first of $RTCTREE_NAMESERVERS, else localhost:2809");
  app.add_flag("--json", settings.json, "Print JSON");
  app.add_option("--call-timeout", settings.limit_s, "Seconds that one call to another process may take")
      ->check(base::number_between(0.01, 600.0))
      ->capture_default_str();
  Work work;
  int code = 0;
  add_listing(app, work);
  add_states(app, work);
  add_configuration(app, work);
  add_connections(app, work);
  add_data(app, work);
  add_systems(app, work);
  add_managers(app, work);
  add_run(app, work);
  editor::add_new_command(app, code);
  const auto words = words_of(argc, argv);
  std::vector<const char*> arguments;
  for (const auto& word : words) arguments.push_back(word.c_str());
  if (const auto end = base::parse_command_line(app, "rtse", argc, arguments.data(), editor::names_offered)) return *end;
  if (!work) return code;  // done without an ORB
  try {
    const editor::Orb orb;
    Editor editor(orb.get(), settings.server, settings.json, std::chrono::milliseconds(static_cast<int>(settings.limit_s * 1000)));
    work(editor);
    if (!editor::flush_output()) editor.fail({"standard output: cannot be written"});
    return editor.failed() ? 1 : 0;
  } catch (const CORBA::Exception& e) {
    std::cerr << "rtse: " << editor::describe(e) << '\n';
  } catch (const std::exception& e) {
    std::cerr << "rtse: " << e.what() << '\n';
  }
  return 1;
}
