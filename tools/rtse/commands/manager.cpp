// mgr: create, delete, load, unload, list, through a manager of the name server or at a corbaloc address.
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"

namespace tools {
namespace {

struct ManagerOptions {
  std::string manager;  // path or corbaloc:: address; empty: the only manager of the name server
  std::string action;   // create, delete, load, unload, list
  std::vector<std::string> arguments;
};

// RTC_ERROR tells no more.
constexpr const char* refused = "the manager's log has the reason; it rejects this call if its manager.remote_rights is read";
constexpr std::chrono::seconds longest_work{20};  // making a component, reading modules

Result<CORBA::Object_var> manager_object(const Session& session, const std::string& manager) {
  if (manager.starts_with("corbaloc:")) {
    auto url = manager;
    if (url.find('/') == std::string::npos) {
      if (std::count(url.begin(), url.end(), ':') < 3) url += ":2810";
      url += "/manager";
    }
    CORBA::Object_var object;
    const auto parsed = remote("manager " + manager, [&] { object = session.orb()->string_to_object(url.c_str()); });
    if (!parsed) return parsed.error();
    return object;
  }
  const char* working = std::getenv("RTCSH_CWD");
  const auto address = parse_address(manager, working ? working : "");
  if (!address) return address.error();
  const auto names = session.tree(manager);
  if (!names) return names.error();
  const Entry* entry = nullptr;
  if (manager.empty()) {
    for (const auto* candidate : names->objects()) {
      if (candidate->kind != EntryKind::manager || candidate->health != Health::alive) continue;
      if (entry)
        return Error{"name server " + names->server() + ": holds several managers, name one with --manager: " + entry->path() + ", " +
                     candidate->path()};
      entry = candidate;
    }
    if (!entry) return Error{"name server " + names->server() + ": holds no living manager; start one with: rtcd"};
  } else {
    const auto found = names->find(*address);
    if (!found) return found.error();
    entry = *found;
  }
  if (entry->kind != EntryKind::manager) return Error{entry->path() + ": is no manager"};
  if (entry->health != Health::alive) return Error{"manager " + entry->path() + " " + entry->problem};
  return entry->object;
}

void print_profiles(const char* title, const RTM::ModuleProfileList& list, nlohmann::ordered_json& json) {
  for (CORBA::ULong i = 0; i < list.length(); ++i) {
    const auto properties = to_properties(list[i].properties);
    json[title].push_back(properties);
  }
}

// Why nothing was created, as far as the manager tells.
std::string why_not_created(RTM::Manager_ptr manager, const std::string& argument) {
  const auto question = argument.find('?');
  const auto type = argument.substr(0, question);
  std::string instance;
  for (const auto& option : base::split_list(question == std::string::npos ? "" : argument.substr(question + 1), '&')) {
    if (option.starts_with("instance_name=")) instance = option.substr(std::string("instance_name=").size());
  }
  RTC::ComponentProfileList_var components = manager->get_component_profiles();
  for (CORBA::ULong i = 0; i < components->length(); ++i) {
    if (!instance.empty() && instance == components[i].instance_name.in()) return "there is a component " + instance + " already";
  }
  RTM::ModuleProfileList_var factories = manager->get_factory_profiles();
  for (CORBA::ULong i = 0; i < factories->length(); ++i) {
    if (property(to_properties(factories[i].properties), "implementation_id") == type)
      return "initialization failed or was denied; see the manager's log";
  }
  return "the manager has no type " + base::in_quotes(type) + " and finds no module with it; see: rtse mgr list";
}

void list_manager(Console& console, RTM::Manager_ptr manager) {
  nlohmann::ordered_json json{{"components", nlohmann::ordered_json::array()},
                              {"loaded_modules", nlohmann::ordered_json::array()},
                              {"loadable_modules", nlohmann::ordered_json::array()},
                              {"factories", nlohmann::ordered_json::array()}};
  const auto asked = remote("manager", [&] {
    RTC::ComponentProfileList_var components = manager->get_component_profiles();
    for (CORBA::ULong i = 0; i < components->length(); ++i)
      json["components"].push_back({{"instance", components[i].instance_name.in()}, {"type", components[i].type_name.in()}});
    RTM::ModuleProfileList_var loaded = manager->get_loaded_modules();
    print_profiles("loaded_modules", loaded.in(), json);
    RTM::ModuleProfileList_var loadable = manager->get_loadable_modules();
    print_profiles("loadable_modules", loadable.in(), json);
    RTM::ModuleProfileList_var factories = manager->get_factory_profiles();
    print_profiles("factories", factories.in(), json);
  });
  if (!asked) return console.fail(asked.error());
  if (console.json()) return console.print(json);
  for (const auto& component : json["components"])
    std::cout << "component " << component["instance"].get<std::string>() << " (" << component["type"].get<std::string>() << ")\n";
  for (const auto& module : json["loaded_modules"])
    std::cout << "loaded    " << module.value("file_path", module.value("module_file_path", "?")) << '\n';
  for (const auto& module : json["loadable_modules"])
    std::cout << "loadable  " << module.value("module_file_path", module.value("module_file_name", "?")) << '\n';
  for (const auto& factory : json["factories"]) std::cout << "factory   " << factory.value("implementation_id", "?") << '\n';
}

void manage(const Session& session, Console& console, const ManagerOptions& options) {
  const auto object = manager_object(session, options.manager);
  if (!object) return console.fail(object.error());
  RTM::Manager_var manager;
  const auto reached = remote("manager " + options.manager, [&] {
    const CallLimit limited(session.call_timeout());
    manager = RTM::Manager::_narrow(*object);
    if (!CORBA::is_nil(manager)) (void)manager->_non_existent();
  });
  if (!reached) return console.fail(reached.error());
  if (CORBA::is_nil(manager)) return console.fail({"manager " + options.manager + ": the object there is no manager"});
  const CallLimit limited(
      std::max<std::chrono::milliseconds>(longest_work, session.call_timeout()));  // it answers, and may have much to do
  if (options.action == "list") return list_manager(console, manager);
  if (options.action == "load") {
    const auto init = options.arguments.size() > 1 ? options.arguments[1] : "";
    RTC::ReturnCode_t code = RTC::RTC_OK;
    const auto called = remote("manager", [&] { code = manager->load_module(options.arguments[0].c_str(), init.c_str()); });
    if (!called) return console.fail(called.error());
    if (const auto done = check("loading module " + options.arguments[0], code, "the manager's log says why"); !done)
      console.fail(done.error());
    return;
  }
  for (const auto& argument : options.arguments) {
    RTC::ReturnCode_t code = RTC::RTC_OK;
    std::string meaning;
    const auto called = remote("manager", [&] {
      if (options.action == "create") {
        RTC::RTObject_var component = manager->create_component(argument.c_str());
        if (CORBA::is_nil(component)) {
          code = RTC::RTC_ERROR;
          meaning = why_not_created(manager, argument);
        } else {
          RTC::ComponentProfile_var profile = component->get_component_profile();
          std::cout << profile->instance_name.in() << '\n';
        }
      } else if (options.action == "delete") {
        code = manager->delete_component(argument.c_str());
        meaning = code == RTC::BAD_PARAMETER ? "the manager has no such component" : refused;
      } else if (options.action == "unload") {
        code = manager->unload_module(argument.c_str());
        meaning = code == RTC::PRECONDITION_NOT_MET ? "components of it exist"
                  : code == RTC::BAD_PARAMETER      ? "the manager has not loaded it"
                                                    : refused;
      }
    });
    if (!called) return console.fail(called.error());
    const auto done = check(options.action + " " + argument, code, meaning);
    if (!done) console.fail(done.error());
  }
}

}  // namespace

void add_manager(base::Command& app, Chosen& chosen) {
  auto* mgr = app.add_subcommand(
      "mgr", "Send a request to a manager: mgr list | create TYPE[?key=value&...] | delete INSTANCE | load FILE [INIT] | unload FILE");
  auto options = std::make_shared<ManagerOptions>();
  mgr->add_option("ACTION", options->action, "list, create, delete, load, unload")
      ->required()
      ->check(base::one_of({"list", "create", "delete", "load", "unload"}));
  mgr->add_option("ARGUMENT", options->arguments, "Types, instances or files");
  mgr->add_option("-m,--manager", options->manager, "Path or corbaloc::HOST[:PORT][/ID] (default: the only manager of the name server)");
  mgr->callback([&chosen, options] {
    require(options->action != "list" || options->arguments.empty(), "mgr list", "expected no further argument");
    require(options->action == "list" || !options->arguments.empty(), "mgr " + options->action, "expected a name");
    for (const auto& argument : options->action == "create" ? options->arguments : std::vector<std::string>()) {
      const auto question = std::min(argument.find('?'), argument.size());
      for (const auto& option : base::split_list(argument.substr(question == argument.size() ? question : question + 1), '&'))
        require(option.empty() || option.find('=') != std::string::npos, "mgr create",
                "expected KEY=VALUE after the '?', got \"" + option + "\"");
    }
    chosen.work = [options](const Session& session, Console& console) { manage(session, console, *options); };
  });
}

}  // namespace tools
