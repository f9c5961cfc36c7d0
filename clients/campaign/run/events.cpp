// What events do to a run.
#include <algorithm>
#include <chrono>

#include "base/text.h"
#include "commands/conf.h"
#include "commands/connect.h"
#include "commands/state.h"
#include "profile/matched_system.h"
#include "run/child_process.h"
#include "run/deeds_runner.h"

namespace campaign {
namespace {

using namespace std::chrono_literals;

constexpr auto simulator_limit = 20s;  // a spawned model is loaded meanwhile
constexpr auto command_limit = 60s;

Result<void> simctl(editor::RunScene& scene, std::vector<std::string> words, const std::vector<std::string>& more = {}) {
  words.insert(words.end(), more.begin(), more.end());
  const auto said = scene.simulator.simctl(words, simulator_limit);
  return said ? Result<void>() : said.error();
}

Result<void> spawn(editor::RunScene& scene, const Event& event) {
  std::vector<std::string> words{"spawn", event.target};
  if (!event.name.empty()) words.insert(words.end(), {"--name", event.name});
  if (!event.numbers.empty()) words.insert(words.end(), {"--pose", base::join(event.numbers, " ")});
  return simctl(scene, words);
}

Result<void> push(editor::RunScene& scene, const Event& event) {
  std::vector<std::string> words{"wrench"};
  if (event.duration_s > 0) words.insert(words.end(), {"--for", base::format_number(event.duration_s)});
  words.insert(words.end(), {"--", event.target});
  return simctl(scene, words, event.numbers);
}

Result<editor::ComponentView> component(editor::RunScene& scene, const std::string& instance, editor::Detail detail) {
  auto view = scene.editor.component(instance + ".rtc", detail);
  if (!view) return view.error();
  if (!view->problem.empty()) return Error{"component " + instance + " " + view->problem};
  return view;
}

// What a component refuses, because it is in another state, is no failure of the run.
Result<void> change(editor::RunScene& scene, const std::string& instance, editor::Transition transition) {
  const auto view = component(scene, instance, {.contexts = true});
  if (!view) return view.error();
  static_cast<void>(editor::change_state(*view, transition, -1));
  return {};
}

Result<void> set(editor::RunScene& scene, const Event& event) {
  const auto view = component(scene, event.target, {.configuration = true});
  if (!view) return view.error();
  const auto id = view->active_set.empty() ? "default" : view->active_set;
  if (const auto problem = editor::value_problem(*view, event.name, event.value); !problem.empty())
    return Error{"parameter " + event.name + " cannot be " + base::in_quotes(event.value) + ", expected " + problem};
  if (const auto done = editor::set_values(*view, id, {{event.name, event.value}}); !done) return done;
  return editor::use_set(*view, id);
}

Result<void> connection(editor::RunScene& scene, const Event& event) {
  const auto& connectors = scene.system.connectors;
  const auto saved = std::ranges::find_if(connectors, [&](const auto& one) { return one.id == event.target || one.name == event.target; });
  if (saved == connectors.end()) return Error{"the system has no connection " + base::in_quotes(event.target)};
  const auto port = [&](const editor::SavedTarget& target) {
    return scene.editor.port(target.instance + ".rtc:" + target.port_name.substr(target.port_name.find('.') + 1), true);
  };
  const auto source = port(saved->source);
  if (!source) return source.error();
  if (event.kind == Event::Kind::disconnect) return editor::disconnect_connector(source->port, saved->id);
  const auto target = port(saved->target);
  if (!target) return target.error();
  return editor::connect_ports({&source->port, &target->port}, saved->id, saved->name, editor::connect_properties(*saved));
}

Result<void> command(editor::RunScene& scene, const Event& event) {
  const auto said = editor::output_of({{"sh", "-c", event.target},
                                       {{"RTMSIM_RECORD", scene.place.file("record.txt")},
                                        {"RTMSIM_SERVER_ID", scene.simulator.id()},
                                        {"RTCTREE_NAMESERVERS", scene.naming}},
                                       ""},
                                      command_limit);
  return said ? Result<void>() : said.error();
}

}  // namespace

Result<void> carry_out_event(editor::RunScene& scene, const Event& event) {
  switch (event.kind) {
    case Event::Kind::spawn:
      return spawn(scene, event);
    case Event::Kind::remove:
      return simctl(scene, {"delete", event.target});
    case Event::Kind::push:
      return push(scene, event);
    case Event::Kind::pose:
      return simctl(scene, {"pose", "--", event.target}, event.numbers);
    case Event::Kind::set:
      return set(scene, event);
    case Event::Kind::activate:
      return change(scene, event.target, editor::Transition::activate);
    case Event::Kind::deactivate:
      return change(scene, event.target, editor::Transition::deactivate);
    case Event::Kind::reset:
      return change(scene, event.target, editor::Transition::reset);
    case Event::Kind::connect:
    case Event::Kind::disconnect:
      return connection(scene, event);
    case Event::Kind::command:
      return command(scene, event);
  }
  return {};
}

}  // namespace campaign
