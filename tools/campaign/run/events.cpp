// What events do to a run.
#include <algorithm>
#include <chrono>

#include "base/child_process.h"
#include "base/text.h"
#include "campaign/run/action_runner.h"
#include "system/configuration.h"
#include "system/connections.h"
#include "system/profile/matched_system.h"
#include "system/transitions.h"

namespace campaign {
namespace {

using namespace std::chrono_literals;

constexpr auto command_limit = 60s;

// As the plan's reader has checked them.
std::vector<double> numbers_of(const Event& event) {
  std::vector<double> numbers;
  for (const auto& text : event.numbers) numbers.push_back(base::parse_number(text).value_or(0));
  return numbers;
}

Result<std::string> spawn(tools::RunScene& scene, const Event& event) {
  const auto done = scene.simulator.spawn({event.target, event.name, numbers_of(event)});
  if (done) return std::string();
  const auto models = event.name.empty() ? std::vector<std::string>() : scene.simulator.models();
  const bool is_there = models && std::ranges::find(*models, event.name) != models->end();
  return is_there ? Result<std::string>("there is a model " + base::in_quotes(event.name) + " already") : done.error();
}

// What was done to a model that does not exist, or does not exist yet, is not done.
Result<void> unless_missing(tools::RunScene& scene, const std::string& model, const Result<void>& done) {
  return done || !is_missing(scene, model) ? done : Result<void>();
}

// What a component rejects, because it is in another state, is no failure of the run.
Result<void> change(tools::RunScene& scene, const std::string& instance, tools::Transition transition) {
  const auto view = scene.component(instance, {.contexts = true});
  if (!view) return view.error();
  static_cast<void>(tools::change_state(*view, transition, -1, scene.transition_timeout));
  return {};
}

Result<void> set(tools::RunScene& scene, const Event& event) {
  const auto view = scene.component(event.target, {.configuration = true});
  if (!view) return view.error();
  const auto id = view->active_set.empty() ? "default" : view->active_set;
  if (const auto problem = tools::value_problem(*view, event.name, event.value); !problem.empty())
    return Error{"parameter " + event.name + " cannot be " + base::in_quotes(event.value) + ", expected " + problem};
  if (const auto done = tools::set_values(*view, id, {{event.name, event.value}}); !done) return done;
  return tools::use_set(*view, id);
}

const tools::SavedConnector* saved_connection(const tools::RunScene& scene, const std::string& name) {
  const auto& connectors = scene.system.connectors;
  const auto saved = std::ranges::find_if(connectors, [&](const auto& one) { return one.id == name || one.name == name; });
  return saved == connectors.end() ? nullptr : &*saved;
}

Result<tools::PortView> port(tools::RunScene& scene, const tools::SavedTarget& target) {
  const auto view = scene.component(target.instance, {.connectors = true});
  if (!view) return view.error();
  const auto* found = view->port(target.port_name.substr(target.port_name.find('.') + 1));
  if (found == nullptr) return Error{"component " + target.instance + ": has no port " + base::in_quotes(target.port_name)};
  return *found;
}

// What is connected already, or not any more, is left as it is.
Result<void> connection(tools::RunScene& scene, const Event& event) {
  const auto* saved = saved_connection(scene, event.target);
  if (saved == nullptr) return Error{"the system has no connection " + base::in_quotes(event.target)};
  const auto source = port(scene, saved->source);
  if (!source) return source.error();
  const bool is_there = std::ranges::any_of(source->connectors, [&](const auto& one) { return one.id == saved->id; });
  if (is_there == (event.kind == Event::Kind::connect)) return {};
  if (event.kind == Event::Kind::disconnect) return tools::disconnect_connector(*source, saved->id);
  const auto target = port(scene, saved->target);
  if (!target) return target.error();
  std::vector<const tools::PortView*> ports = {&*source};
  if (!saved->has_one_port()) ports.push_back(&*target);
  return tools::connect_ports(ports, saved->id, saved->name, tools::restored_properties(*saved));
}

// The component that an event needs and that was killed; empty: none.
std::string away_of(const tools::RunScene& scene, const Event& event) {
  std::vector<std::string> needed;
  switch (event.kind) {
    case Event::Kind::set:
    case Event::Kind::activate:
    case Event::Kind::deactivate:
    case Event::Kind::reset:
      needed = {event.target};
      break;
    case Event::Kind::connect:
    case Event::Kind::disconnect:
      if (const auto* saved = saved_connection(scene, event.target)) needed = {saved->source.instance, saved->target.instance};
      break;
    default:
      break;
  }
  const auto away = std::ranges::find_if(needed, scene.is_away);
  return away == needed.end() ? "" : *away;
}

Result<void> command(tools::RunScene& scene, const Event& event) {
  const auto said =
      base::output_of(base::shell_call(event.target, scene.place.file("record.txt"), scene.simulator.id(), scene.naming), command_limit);
  return said ? Result<void>() : said.error();
}

Result<void> do_it(tools::RunScene& scene, const Event& event) {
  switch (event.kind) {
    case Event::Kind::remove:
      return unless_missing(scene, event.target, scene.simulator.remove(event.target));
    case Event::Kind::push:
    case Event::Kind::wrench:
    case Event::Kind::joint_force: {
      const tools::Push push{numbers_of(event), event.duration_s, event.stays, event.kind == Event::Kind::joint_force};
      return unless_missing(scene, event.target, scene.simulator.push(event.target, push));
    }
    case Event::Kind::pose:
      return unless_missing(scene, event.target, scene.simulator.set_pose(event.target, numbers_of(event)));
    case Event::Kind::set:
      return set(scene, event);
    case Event::Kind::activate:
      return change(scene, event.target, tools::Transition::activate);
    case Event::Kind::deactivate:
      return change(scene, event.target, tools::Transition::deactivate);
    case Event::Kind::reset:
      return change(scene, event.target, tools::Transition::reset);
    case Event::Kind::connect:
    case Event::Kind::disconnect:
      return connection(scene, event);
    case Event::Kind::command:
      return command(scene, event);
    case Event::Kind::spawn:
      break;
  }
  return {};
}

}  // namespace

Result<std::string> carry_out_event(tools::RunScene& scene, const Event& event) {
  if (event.kind == Event::Kind::spawn) return spawn(scene, event);
  if (const auto away = away_of(scene, event); !away.empty()) return "component " + away + " was killed and is not there again";
  const auto done = do_it(scene, event);
  return done ? Result<std::string>(std::string()) : done.error();
}

}  // namespace campaign
