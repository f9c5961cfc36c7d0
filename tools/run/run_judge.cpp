#include "run/run_judge.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <utility>

#include "base/child_process.h"
#include "base/text.h"
#include "run/expectation_check.h"
#include "run/nondeterminism_report.h"
#include "run/run_script.h"

namespace tools {
namespace {

using namespace std::chrono_literals;

constexpr auto command_limit = 60s;          // of a command of the user's
constexpr std::uint32_t picture_size = 900;  // [pixels]

}  // namespace

Result<void> RunJudge::read() {
  if (options_.expectations.empty()) return {};
  auto expectations = read_expectations(options_.expectations);
  if (!expectations) return expectations.error();
  expectations_ = std::move(*expectations);
  const auto known = check_components(expectations_, system_);
  return known ? known : in_file(known.error());
}

Error RunJudge::in_file(const Error& error) const { return {"file " + base::in_quotes(options_.expectations) + ": " + error.message}; }

Result<void> RunJudge::check_models(bool may_spawn) const {
  if (may_spawn || expectations_.empty()) return {};
  const auto models = simulator_.models();
  if (!models) return models.error();
  const auto known = tools::check_models(expectations_, *models);
  if (!known) return in_file(known.error());
  const auto parts = simulator_.parts();
  if (!parts) return parts.error();
  const auto has_parts = tools::check_parts(expectations_, *parts);
  return has_parts ? has_parts : in_file(has_parts.error());
}

Result<void> RunJudge::check_values(const Session& session) const {
  const auto known = tools::check_values(session, expectations_);
  return known ? known : in_file(known.error());
}

std::vector<const Expectation*> RunJudge::looked_at() const {
  std::vector<const Expectation*> all;
  for (const auto& expectation : expectations_) all.push_back(&expectation);
  if (!hooks_.script) return all;
  for (const auto& watched : hooks_.script->watched()) all.push_back(&watched);
  return all;
}

void RunJudge::want_joints() {
  for (const auto* one : looked_at()) {
    if (one->kind == Expectation::Kind::joint) record_.wanted_joints.insert(one->joint_name());
  }
}

// What fingers touch at the end.
Result<void> RunJudge::look_at_grips() {
  const auto all = looked_at();
  const auto needs_parts = [](const Expectation* one) {
    return one->kind == Expectation::Kind::holds || one->kind == Expectation::Kind::joint;
  };
  if (std::ranges::none_of(all, needs_parts)) return {};
  auto parts = simulator_.parts();
  if (!parts) return parts.error();
  seen_.parts = std::move(*parts);
  for (const auto* one : all) {
    if (one->kind != Expectation::Kind::holds) continue;
    auto& problem = seen_.grips[grip_name(one->gripper, one->model)];
    const auto gripper = find_gripper(seen_.parts, one->gripper);
    const auto contacts = gripper ? simulator_.contacts(one->model) : gripper.error();
    problem = contacts ? grip_problem(*gripper, one->model, *contacts) : contacts.error().message;
  }
  return {};
}

Result<void> RunJudge::watch() {
  want_joints();
  record_.set_end(options_.duration_s + simulator_.step() / 2);
  return simulator_.read_events(record_);
}

Result<void> RunJudge::look(const Session& session, const std::vector<std::string>& nondeterministic_events, RunResult& result) {
  if (const auto watched = watch(); !watched) return watched;
  const auto state = simulator_.state();
  if (!state) return state.error();
  result.state_hash = state->hash;
  if (!options_.picture.empty()) {
    const auto file = std::filesystem::absolute(options_.picture).string();
    const auto drawn = simulator_.screenshot(file, picture_size);
    if (!drawn) result.verdicts.push_back({"picture " + options_.picture, drawn.error().message});
  }
  if (auto models = simulator_.models()) seen_.models = std::move(*models);
  if (const auto looked = look_at_grips(); !looked) return looked;
  std::vector<std::string> paths;
  for (const auto& component : system_.components) paths.push_back(component.instance + ".rtc");
  const auto views = session.components(paths, {.contexts = true});
  for (std::size_t i = 0; i < views.size(); ++i) {
    seen_.states[system_.components[i].instance] = views[i] ? state_text(views[i]->state()) : "gone";
    if (views[i]) providers_.merge(providers_of(*views[i]));
  }
  check_states(result);
  // What a script takes down takes its connections with it.
  if (!hooks_.script) {
    const auto lost = base::join(hosts_.lost_connections(system_), "; ");
    result.verdicts.push_back(
        {.expectation = "no connection is lost", .problem = lost, .failure = lost.empty() ? "" : "connection lost: " + lost});
  }
  check_determinism(nondeterministic_events, result);
  return {};
}

// What a next run may do otherwise: a failure when the run is to be strict, a note for each in a CI job.
void RunJudge::check_determinism(const std::vector<std::string>& known, RunResult& result) const {
  if (!reports_nondeterminism(options_)) return;
  const auto places = read_schedule(simulator_);
  auto nondeterministic_events = nondeterministic_events_in(hosts_.logs(), places);
  for (const auto& one : known) nondeterministic_events.push_back(with_tick(one, places));
  for (auto& pair : services_of_one_phase(system_, places)) nondeterministic_events.push_back(std::move(pair));
  for (auto& pair : callers_of_one_phase(system_, places, providers_)) nondeterministic_events.push_back(std::move(pair));
  if (options_.strict) {
    const auto found = base::join(nondeterministic_events, "; ");
    result.verdicts.push_back(
        {.expectation = "no nondeterministic event", .problem = found, .failure = found.empty() ? "" : "nondeterministic: " + found});
  } else {
    for (const auto& event : nondeterministic_events) result.notes.push_back("nondeterministic: " + event);
  }
}

// " (onExecute at 0.2 s: UNKNOWN; ValueError: no scan)"; empty: not known.
std::string RunJudge::why_error(const std::string& component) const {
  const auto threw = hosts_.what_threw(component);
  if (threw.empty()) return "";
  const auto traceback = foreign_.traceback_of(component);
  return " (" + threw + (traceback.empty() ? "" : "; " + traceback) + ")";
}

// A component that has ended in an error, or has gone, is no success, whether somebody has asked for its state or not.
void RunJudge::check_states(RunResult& result) const {
  std::string problem, first;
  for (const auto& [component, state] : seen_.states) {
    const bool is_judged = std::ranges::any_of(expectations_, [&](const Expectation& expectation) {
      return expectation.kind == Expectation::Kind::state && expectation.component == component;
    });
    if (hooks_.script && hooks_.script->excuses(component)) continue;
    if (is_judged || (state != "Error" && state != "gone")) continue;
    if (first.empty()) first = component;
    problem +=
        (problem.empty() ? "" : ", ") + component + (state == "Error" ? " ended in the ERROR state" : " exited") + why_error(component);
  }
  result.verdicts.push_back({.expectation = "no component ends in an error",
                             .problem = problem,
                             .failure = problem.empty() ? "" : "component " + problem,
                             .subject = first});
}

Result<void> RunJudge::run_commands(const std::string& naming) {
  for (const auto& expectation : expectations_) {
    if (expectation.kind != Expectation::Kind::command) continue;
    auto& seen = seen_.commands[expectation.command];
    auto started = base::ChildProcess::start(base::shell_call(expectation.command, place_.file("record.txt"), simulator_.id(), naming));
    if (!started) return started.error();
    const auto ending = started->wait_or_interrupt(command_limit);
    if (ending == base::Ending::interrupted) return Error{"run: interrupted"};
    const auto lines = base::split_list(started->said(), '\n');
    seen.text = lines.empty() ? "" : printable(lines.back());
    seen.output = tail_of(lines);
    if (ending == base::Ending::ended) {
      seen.exit_code = started->exit_code();
    } else {
      seen.text = "it did not end within " + std::to_string(command_limit.count()) + " s";
    }
  }
  return {};
}

Result<void> RunJudge::judge(RunResult& result) {
  constexpr double record_period = 0.1;  // [s]
  if (record_.last < options_.duration_s - record_period - simulator_.step())
    return Error{"the record of the run ends at " + base::format_number(record_.last) + " s: the world was reset"};
  seen_.record = std::move(record_);
  const auto verdicts = tools::judge(expectations_, seen_);
  result.verdicts.insert(result.verdicts.end(), verdicts.begin(), verdicts.end());
  for (const auto& [model, poses] : seen_.record.poses) result.path_m = std::max(result.path_m, path_length(poses));
  return {};
}

}  // namespace tools
