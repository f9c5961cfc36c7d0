// act, deact, reset, exit, del, wait.
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "base/command_line.h"
#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "rtse/commands/state.h"

namespace editor {
namespace {

// A transition may take as long as the component's own callback; tools of the field wait half a second and then report a failure.
constexpr std::chrono::seconds transition_limit{10};
// A context answers RTC_ERROR when the component's callback has not returned within a time of its own; it may still come.
constexpr std::chrono::seconds late_limit{6};

std::chrono::milliseconds& patience() {
  static std::chrono::milliseconds time{0};
  return time;
}

struct Wording {
  const char* verb;
  RTC::LifeCycleState from;
  RTC::LifeCycleState to;
};

Wording wording(Transition transition) {
  switch (transition) {
    case Transition::activate:
      return {"activating", RTC::INACTIVE_STATE, RTC::ACTIVE_STATE};
    case Transition::deactivate:
      return {"deactivating", RTC::ACTIVE_STATE, RTC::INACTIVE_STATE};
    case Transition::reset:
      break;
  }
  return {"resetting", RTC::ERROR_STATE, RTC::INACTIVE_STATE};
}

RTC::ReturnCode_t call(RTC::ExecutionContext_ptr context, RTC::RTObject_ptr component, Transition transition) {
  switch (transition) {
    case Transition::activate:
      return context->activate_component(component);
    case Transition::deactivate:
      return context->deactivate_component(component);
    case Transition::reset:
      break;
  }
  return context->reset_component(component);
}

Result<const ContextView*> pick_context(const ComponentView& component, int index) {
  if (component.contexts.empty()) return Error{"component " + component.path + ": takes part in no execution context"};
  if (index < 0) return component.shown_context();
  if (static_cast<std::size_t>(index) >= component.contexts.size()) {
    return Error{"component " + component.path + ": has no execution context number " + std::to_string(index) + ", it has " +
                 std::to_string(component.contexts.size())};
  }
  return &component.contexts[static_cast<std::size_t>(index)];
}

}  // namespace

// A component that is there already is fine: the caller wanted the state, not the step.
void wait_for_states(std::chrono::milliseconds time) { patience() = time; }

Result<void> change_state(const ComponentView& component, Transition transition, int index) {
  const auto context = pick_context(component, index);
  if (!context) return context.error();
  const auto words = wording(transition);
  const auto what = std::string(words.verb) + " " + component.path;
  const auto state = (*context)->state;
  if (state == words.to && transition != Transition::reset) return {};
  if (state != words.from) {
    return Error{what + ": is " + state_text(state) + ", must be " + state_text(words.from) +
                 (state == RTC::ERROR_STATE ? " (try: rtse reset)" : "")};
  }
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  const CallLimit limited(std::max<std::chrono::milliseconds>(transition_limit, patience()));
  const auto called = remote(what + ":", [&] { code = call((*context)->object, component.object, transition); });
  if (!called) return called.error();
  if (code == RTC::RTC_OK) return {};
  RTC::LifeCycleState now = words.from;
  const auto end = std::chrono::steady_clock::now() +
                   (code == RTC::RTC_ERROR ? std::max<std::chrono::milliseconds>(late_limit, patience()) : std::chrono::milliseconds(0));
  while (true) {
    const auto asked = remote(what, [&] { now = (*context)->object->get_component_state(component.object); });
    if (!asked) return check(what, code);
    if (now == words.to) return {};  // late, but it arrived
    if (now != words.from || std::chrono::steady_clock::now() >= end) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // nobody tells when the callback returns
  }
  return check(what, code, "it is " + state_text(now) + " now, its log says why");
}

namespace {

void change_state(Editor& editor, const std::vector<std::string>& paths, Transition transition, int context) {
  for (const auto& path : paths) {
    const auto component = editor.component(path, {.contexts = true});
    if (!component) {
      editor.fail(component.error());
      continue;
    }
    if (const auto changed = change_state(*component, transition, context); !changed) editor.fail(changed.error());
  }
}

void exit_components(Editor& editor, const std::vector<std::string>& paths) {
  for (const auto& path : paths) {
    const auto component = editor.component(path, {});
    if (!component) {
      editor.fail(component.error());
      continue;
    }
    RTC::ReturnCode_t code = RTC::RTC_OK;
    const CallLimit limited(transition_limit);
    const auto called = remote("exit of " + component->path + ":", [&] { code = component->object->exit(); });
    if (!called) editor.fail(called.error());
    if (const auto checked = check("exit of " + component->path, code); !checked) editor.fail(checked.error());
  }
}

// Something under it that answers, or hangs.
bool holds_living(const Entry& entry) {
  if (entry.kind != EntryKind::context) return entry.health != Health::zombie;
  return std::ranges::any_of(entry.children, holds_living);
}

void delete_binding(Editor& editor, const Entry& entry, bool force) {
  const bool lives = holds_living(entry);
  if (lives && entry.kind == EntryKind::context && !force)
    return editor.fail({entry.path() + ": is a context that holds living objects (--force deletes it all the same)"});
  if (const auto gone = unbind(editor.orb(), entry); !gone) return editor.fail(gone.error());
  std::cout << "deleted " << entry.path() << (lives ? "  (it lives; its process may register it again)" : "") << '\n';
}

void delete_bindings(Editor& editor, const std::vector<std::string>& paths, bool zombies, bool force) {
  const auto names = editor.tree(paths.empty() ? "" : paths.front());
  if (!names) return editor.fail(names.error());
  if (zombies) {
    for (const auto* entry : names->objects()) {
      if (entry->health == Health::zombie) delete_binding(editor, *entry, force);
    }
  }
  for (const auto& path : paths) {
    const auto address = parse_address(path, "");
    if (!address) {
      editor.fail(address.error());
      continue;
    }
    const auto entry = names->find(*address);
    if (!entry) {
      editor.fail(entry.error());
      continue;
    }
    delete_binding(editor, **entry, force);
  }
}

// No name, or only such whose object is gone. A component that does not answer is not gone, and behind a name server that does not, nobody
// knows.
bool is_gone(const Editor& editor, const std::string& path) {
  const auto address = parse_address(path, working_path());
  const auto names = editor.tree(path, true);
  if (!address || !names) return false;
  const auto meant = names->candidates(*address);
  return meant && std::ranges::all_of(*meant, [](const Entry* entry) { return entry->health == Health::zombie; });
}

void wait_for_state(Editor& editor, const std::vector<std::string>& paths, const std::string& state, double timeout_s) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  for (const auto& path : paths) {
    while (true) {
      const auto component = editor.component(path, {.contexts = true});
      const auto now = component ? state_text(component->state()) : std::string("not there or does not answer");
      if (base::equal_ignoring_case(now, state) || (component && base::equal_ignoring_case(state, "any"))) break;
      if (base::equal_ignoring_case(state, "gone") && !component && is_gone(editor, path)) break;
      if (std::chrono::steady_clock::now() >= deadline) {
        editor.fail({"component " + base::in_quotes(path) + ": is " + now + " after " + base::format_number(timeout_s) + " s, waited for " +
                     state + (component ? "" : " (" + component.error().message + ")")});
        break;
      }
      // A component that is not there yet can tell nobody that it has come: asking again is all that can be done.
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
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
    command->callback(
        [&chosen, paths, context, transition] { chosen.work = [=](Editor& e) { change_state(e, *paths, transition, *context); }; });
  };
  add("act", "Activate components", Transition::activate);
  add("deact", "Deactivate components", Transition::deactivate);
  add("reset", "Reset components that are in the error state", Transition::reset);

  auto* exit = app.add_subcommand("exit", "Finalize components");
  auto exit_paths = std::make_shared<std::vector<std::string>>();
  exit->add_option("PATH", *exit_paths, "Components")->required();
  exit->callback([&chosen, exit_paths] { chosen.work = [exit_paths](Editor& e) { exit_components(e, *exit_paths); }; });

  auto* del = app.add_subcommand("del", "Delete name server entries, even of unreachable objects");
  auto del_paths = std::make_shared<std::vector<std::string>>();
  auto zombies = std::make_shared<bool>(false);
  del->add_option("PATH", *del_paths, "Names");
  del->add_flag("-z,--zombies", *zombies, "Delete all names of objects that do not exist");
  auto force = std::make_shared<bool>(false);
  del->add_flag("--force", *force, "Also delete contexts that contain existing objects");
  del->callback([&chosen, del_paths, zombies, force] {
    require(!del_paths->empty() || *zombies, "del", "expected names, or -z for all names of objects that do not exist");
    chosen.work = [=](Editor& e) { delete_bindings(e, *del_paths, *zombies, *force); };
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
  wait->callback(
      [&chosen, wait_paths, state, timeout] { chosen.work = [=](Editor& e) { wait_for_state(e, *wait_paths, *state, *timeout); }; });
}

}  // namespace editor
