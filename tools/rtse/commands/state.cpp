// act, deact, reset, exit, del, wait.
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "base/command_line.h"
#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "system/transitions.h"

namespace tools {
namespace {

void change_state(const Session& session, Console& console, const std::vector<std::string>& paths, Transition transition, int context) {
  for (const auto& component : session.components(paths, {.contexts = true})) {
    if (!component) {
      console.fail(component.error());
      continue;
    }
    if (const auto changed = change_state(*component, transition, context); !changed) console.fail(changed.error());
  }
}

void exit_components(const Session& session, Console& console, const std::vector<std::string>& paths) {
  for (const auto& component : session.components(paths, {})) {
    if (!component) {
      console.fail(component.error());
      continue;
    }
    RTC::ReturnCode_t code = RTC::RTC_OK;
    const CallLimit limited(default_transition_timeout);
    const auto called = remote("exit of " + component->path + ":", [&] { code = component->object->exit(); });
    if (!called) console.fail(called.error());
    if (const auto checked = check("exit of " + component->path, code); !checked) console.fail(checked.error());
  }
}

// Something under it that answers, or hangs.
bool holds_living(const Entry& entry) {
  if (entry.kind != EntryKind::context) return entry.health != Health::zombie;
  return std::ranges::any_of(entry.children, holds_living);
}

void delete_binding(const Session& session, Console& console, const Entry& entry, bool force) {
  const bool lives = holds_living(entry);
  if (lives && entry.kind == EntryKind::context && !force)
    return console.fail({entry.path() + ": is a context that holds living objects (--force deletes it anyway)"});
  if (const auto gone = unbind(session.orb(), entry); !gone) return console.fail(gone.error());
  std::cout << "deleted " << entry.path() << (lives ? "  (it lives; its process may register it again)" : "") << '\n';
}

void delete_bindings(const Session& session, Console& console, const std::vector<std::string>& paths, bool zombies, bool force) {
  const auto names = session.tree(paths.empty() ? "" : paths.front());
  if (!names) return console.fail(names.error());
  if (zombies) {
    for (const auto* entry : names->objects()) {
      if (entry->health == Health::zombie) delete_binding(session, console, *entry, force);
    }
  }
  for (const auto& path : paths) {
    const auto address = parse_address(path, "");
    if (!address) {
      console.fail(address.error());
      continue;
    }
    const auto entry = names->find(*address);
    if (!entry) {
      console.fail(entry.error());
      continue;
    }
    delete_binding(session, console, **entry, force);
  }
}

// No name, or only such whose object is gone. A component that does not answer is not gone, and behind a name server that does not, nobody
// knows.
bool is_gone(const Session& session, const std::string& path) {
  const auto address = parse_address(path, working_path());
  const auto names = session.tree(path, true);
  if (!address || !names) return false;
  const auto meant = names->candidates(*address);
  return meant && std::ranges::all_of(*meant, [](const Entry* entry) { return entry->health == Health::zombie; });
}

void wait_for_state(const Session& session, Console& console, std::vector<std::string> paths, const std::string& state, double timeout_s) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  while (true) {
    const bool is_over = std::chrono::steady_clock::now() >= deadline;
    const auto components = session.components(paths, {.contexts = true});
    std::vector<std::string> missing;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const auto& component = components[i];
      const auto now = component ? state_text(component->state()) : std::string("not there or does not answer");
      if (base::equal_ignoring_case(now, state) || (component && base::equal_ignoring_case(state, "any"))) continue;
      if (base::equal_ignoring_case(state, "gone") && !component && is_gone(session, paths[i])) continue;
      missing.push_back(paths[i]);
      if (!is_over) continue;
      console.fail({"component " + base::in_quotes(paths[i]) + ": is " + now + " after " + base::format_number(timeout_s) +
                    " s, waited for " + state + (component ? "" : " (" + component.error().message + ")")});
    }
    if (missing.empty() || is_over) return;
    paths = std::move(missing);
    // A component that is not there yet can tell nobody that it has come: asking again is all that can be done.
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

}  // namespace

void add_state(base::Command& app, Chosen& chosen) {
  const auto add = [&](const char* name, const char* help, Transition transition) {
    auto* command = app.add_subcommand(name, help);
    auto paths = std::make_shared<std::vector<std::string>>();
    auto context = std::make_shared<int>(-1);
    command->add_option("PATH", *paths, "Components")->required();
    command->add_option("-e,--context", *context, "Index of the execution context (default: the first running one, as shown by ls)")
        ->check(base::number_between(0, 1000));
    command->callback([&chosen, paths, context, transition] {
      chosen.work = [=](const Session& session, Console& console) { change_state(session, console, *paths, transition, *context); };
    });
  };
  add("act", "Activate components", Transition::activate);
  add("deact", "Deactivate components", Transition::deactivate);
  add("reset", "Reset components that are in the error state", Transition::reset);

  auto* exit = app.add_subcommand("exit", "Finalize components");
  auto exit_paths = std::make_shared<std::vector<std::string>>();
  exit->add_option("PATH", *exit_paths, "Components")->required();
  exit->callback([&chosen, exit_paths] {
    chosen.work = [exit_paths](const Session& session, Console& console) { exit_components(session, console, *exit_paths); };
  });

  auto* del = app.add_subcommand("del", "Delete name server entries, even of unreachable objects");
  auto del_paths = std::make_shared<std::vector<std::string>>();
  auto zombies = std::make_shared<bool>(false);
  del->add_option("PATH", *del_paths, "Names");
  del->add_flag("-z,--zombies", *zombies, "Delete all names of objects that do not exist");
  auto force = std::make_shared<bool>(false);
  del->add_flag("--force", *force, "Also delete contexts that contain existing objects");
  del->callback([&chosen, del_paths, zombies, force] {
    require(!del_paths->empty() || *zombies, "del", "expected names, or -z for all names of objects that do not exist");
    chosen.work = [=](const Session& session, Console& console) { delete_bindings(session, console, *del_paths, *zombies, *force); };
  });

  auto* wait = app.add_subcommand("wait", "Wait until components are in a state");
  auto wait_paths = std::make_shared<std::vector<std::string>>();
  auto state = std::make_shared<std::string>("Active");
  auto timeout = std::make_shared<double>(10);
  wait->add_option("PATH", *wait_paths, "Components")->required();
  wait->add_option("--state", *state, "State: Inactive, Active, Error, any (exists), gone (does not exist)")
      ->capture_default_str()
      ->check(base::one_of({"created", "inactive", "active", "error", "any", "gone"}, base::Case::does_not_matter));
  wait->add_option("--timeout", *timeout, "Timeout [s]")->capture_default_str()->check(base::number_between(0.0, 1e6));
  wait->callback([&chosen, wait_paths, state, timeout] {
    chosen.work = [=](const Session& session, Console& console) { wait_for_state(session, console, *wait_paths, *state, *timeout); };
  });
}

}  // namespace tools
