// goto.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>

#include "base/child_process.h"
#include "base/command_line.h"
#include "base/interrupt.h"
#include "base/text.h"
#include "campaign/run/action_script.h"
#include "recording/ring.h"
#include "recording/sample_text.h"
#include "rtse/command.h"
#include "rtse/recorder/recorder_commands.h"
#include "run/break_watch.h"
#include "run/recorded_run.h"

namespace recorder {

namespace {

using tools::Console;
using tools::Session;

struct GotoOptions {
  std::string what;  // a recording or a profile
  std::optional<double> time_s;
  std::string condition;
  int back = 0;  // ticks
  std::string world;
  std::string then;
  std::optional<std::uint64_t> seed;
  std::vector<std::string> start;
  tools::RunOptions run;  // those of a run that can be given here
};

// A run that stands at a moment: what is done with it, until it is to stand at another one before it, or to end.
class Stand {
 public:
  // `input`: what was read of the user's commands and not obeyed yet; it outlives the stands.
  Stand(const Session& session, const Console& console, const GotoOptions& options, const std::optional<Expression>& condition,
        double time_s, std::string& input)
      : session_(session), console_(console), options_(options), condition_(condition), time_s_(time_s), input_(input) {}

  base::Result<void> drive(tools::RunningSystem& system);
  // Where a run that is made anew is to stand.
  std::optional<double> wish() const { return wish_; }

 private:
  base::Result<void> go_to(double time_s);
  base::Result<void> go_to_condition();
  base::Result<void> go_on(std::int64_t steps);
  base::Result<void> then();
  base::Result<void> listen();
  base::Result<bool> obey(const std::string& line);
  void say() const;
  // Nothing below a nanosecond: 57 300 steps of a millisecond are no 57.300000000000004 s.
  double now() const { return std::round(static_cast<double>(steps_) * system_->step() * 1e9) / 1e9; }

  const Session& session_;
  const Console& console_;
  const GotoOptions& options_;
  const std::optional<Expression>& condition_;
  const double time_s_;
  std::string& input_;
  tools::RunningSystem* system_ = nullptr;
  std::int64_t steps_ = 0;
  std::int64_t tick_ = 1;  // [steps]
  std::optional<double> wish_;
};

base::Result<void> Stand::go_on(std::int64_t steps) {
  if (const auto made = system_->make_steps(steps); !made) return made;
  steps_ += steps;
  return {};
}

base::Result<void> Stand::go_to(double time_s) {
  const auto steps = std::llround(time_s / system_->step()) - steps_;
  return steps > 0 ? go_on(steps) : base::Result<void>();
}

base::Result<void> Stand::go_to_condition() {
  auto watch = BreakWatch::start(session_.orb(), *system_, *condition_);
  if (!watch) return watch.error();
  const auto steps = std::max<std::int64_t>(std::llround(time_s_ / system_->step()), 1);
  const auto made = system_->make_steps(steps);
  if (const auto hit = (*watch)->hit()) {
    steps_ = std::llround(std::chrono::duration<double>(*hit).count() / system_->step());
    return {};
  }
  if (!made) return made;
  const auto missing = (*watch)->missing();
  return base::Error{"goto: the condition " + base::in_quotes(options_.condition) + " does not hold up to " + base::format_number(time_s_) +
                     " s" + (missing.empty() ? "" : "; " + base::join(missing, ", "))};
}

void Stand::say() const {
  if (console_.json()) {
    Json json = {{"time", now()}, {"steps", steps_}, {"simulator", system_->simulator()}, {"naming", system_->naming()}};
    json["processes"] = Json::array();
    for (const auto& process : system_->processes()) json["processes"].push_back({{"what", process.what}, {"pid", process.pid}});
    std::cout << json.dump() << std::endl;
    return;
  }
  std::cout << "stopped at " << base::format_number(now()) << " s, after " << steps_ << " steps\n";
  for (const auto& process : system_->processes())
    std::printf("%8d  %s\n", static_cast<int>(process.pid), base::printable(process.what).c_str());
  std::fflush(stdout);
  std::cout << "export RTMSIM_SERVER_ID=" << system_->simulator() << " RTCTREE_NAMESERVERS=" << system_->naming() << std::endl;
}

base::Result<void> Stand::then() {
  std::cout.flush();
  std::fflush(stdout);
  auto child = base::ChildProcess::start({{"sh", "-c", options_.then},
                                          {{"RTMSIM_SERVER_ID", system_->simulator()}, {"RTCTREE_NAMESERVERS", system_->naming()}},
                                          base::own_output});
  if (!child) return child.error();
  if (child->wait_or_interrupt(std::chrono::hours(24 * 365)) != base::Ending::ended) return base::Error{"goto: interrupted"};
  if (child->exit_code() != 0) return base::Error{"command " + base::in_quotes(options_.then) + ": " + child->how_it_ended()};
  return {};
}

// True when the run is to end.
base::Result<bool> Stand::obey(const std::string& line) {
  const auto words = base::split_list(line, ' ');
  const std::string verb = words.empty() ? "n" : words[0];
  const double number = words.size() > 1 ? base::parse_number(words[1]).value_or(-1) : 1;  // less than 0: none that means something
  constexpr double most = 1e9;                                                             // ticks, or seconds
  if (verb == "q" || verb == "quit") return true;
  if ((verb == "n" || verb == "next") && number >= 1 && number <= most) {
    const auto done = go_on(tick_ * std::llround(number));
    return done ? base::Result<bool>(false) : done.error();
  }
  const bool is_back = (verb == "b" || verb == "back") && number >= 1;
  if (is_back || ((verb == "t" || verb == "to") && words.size() > 1 && number >= 0 && number <= most)) {
    const double to = is_back ? std::max(0.0, now() - number * static_cast<double>(tick_) * system_->step()) : number;
    if (to < now()) {
      wish_ = to;
      return true;
    }
    const auto done = go_to(to);
    return done ? base::Result<bool>(false) : done.error();
  }
  std::cerr << "n [N]: N ticks on; t SECONDS: to that time; b [N]: N ticks back; q: end\n";
  return false;
}

// Until the user has had enough, or sends no more.
base::Result<void> Stand::listen() {
  for (;;) {
    for (auto end = input_.find('\n'); end != std::string::npos; end = input_.find('\n')) {
      const std::string line = input_.substr(0, end);
      input_.erase(0, end + 1);
      const auto is_over = obey(line);
      if (!is_over) return is_over.error();
      if (*is_over) return {};
      say();
    }
    pollfd handles[2] = {{base::interrupt_handle(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    (void)::poll(handles, 2, -1);
    if (base::is_interrupted()) return {};
    char piece[512];
    const auto size = ::read(STDIN_FILENO, piece, sizeof piece);
    if (size <= 0) return {};
    input_.append(piece, static_cast<std::size_t>(size));
  }
}

base::Result<void> Stand::drive(tools::RunningSystem& system) {
  system_ = &system;
  const auto tick = tick_of(system.simulator(), system.step());
  if (!tick) return tick.error();
  tick_ = std::max<std::int64_t>(1, std::llround(std::chrono::duration<double>(*tick).count() / system.step()));
  if (condition_) {
    if (const auto gone = go_to_condition(); !gone) return gone;
    if (options_.back > 0) {
      wish_ = std::max(0.0, now() - options_.back * static_cast<double>(tick_) * system.step());
      return {};
    }
  } else {
    const double back = options_.back * static_cast<double>(tick_) * system.step();
    if (const auto gone = go_to(std::max(0.0, time_s_ - back)); !gone) return gone;
  }
  say();
  return options_.then.empty() ? listen() : then();
}

// What a plan did in the run; null: nothing.
using Script = std::unique_ptr<campaign::ActionScript>;
base::Result<Script> script_of(const RecordedRun& run) {
  if (run.script().empty()) return Script();
  const auto file = (run.folder() / "script.yaml").string();
  std::ofstream(file, std::ios::binary) << run.script();
  return campaign::ActionScript::read(file);
}

void go(const Session& session, Console& console, const GotoOptions& options, const base::Command& command) {
  std::optional<Expression> condition;
  if (!options.condition.empty()) {
    auto parsed = Expression::parse(options.condition);
    if (!parsed) return console.reject(parsed.error());
    condition = std::move(*parsed);
  }
  std::optional<RecordedRun> recorded;
  tools::RunOptions call;
  if (options.world.empty()) {
    if (!is_recording(options.what))
      return console.reject({base::in_quotes(options.what) + ": is not a recording; for a system profile, give its world: -w WORLD"});
    auto run = RecordedRun::unpack(options.what);
    if (!run) return console.reject(run.error());
    if (const auto lost = run->lost(); run->script().empty() && !lost.empty()) console.warn(lost);
    recorded.emplace(std::move(*run));
    auto recorded_options = recorded->options();
    if (!recorded_options) return console.reject(recorded_options.error());
    call = std::move(*recorded_options);
    if (options.time_s.value_or(0) > call.duration_s)
      console.warn("the recorded run ended at " + base::format_number(call.duration_s) + " s");
  } else {
    call.system = options.what;
    call.world = options.world;
  }
  if (!options.start.empty()) {
    call.start = options.start;
    call.start_folder.clear();
  }
  if (options.seed) call.seed = *options.seed;
  auto given = options.run;
  given.world = call.world, given.seed = call.seed;  // options of this command that have the names of a run's
  call = tools::with_given(std::move(call), given, command);
  base::catch_interrupts();
  GotoOptions wanted = options;
  double time_s = options.time_s.value_or(call.duration_s);
  std::string input;
  for (;;) {
    Stand stand(session, console, wanted, condition, time_s, input);
    const auto script = recorded ? script_of(*recorded) : base::Result<Script>(nullptr);
    if (!script) return console.fail(script.error());
    tools::RunHooks hooks{.driver = [&](tools::RunningSystem& system) { return stand.drive(system); }};
    if (*script) hooks.script = script->get(), hooks.simulator_options = (*script)->simulator_options();
    const auto made = tools::run_system(session.orb(), call, console, hooks);
    if (made.refusal != tools::RunResult::Refusal::none) return console.reject({made.problem});
    if (!made.problem.empty()) return console.fail({made.problem});
    if (!stand.wish()) return;
    // The same run once more, and not so far.
    time_s = *stand.wish();
    condition.reset();
    wanted.back = 0;
  }
}

}  // namespace

void add_goto(base::Command& app, tools::Chosen& chosen) {
  auto* command = app.add_subcommand("goto", "Repeat a recorded run and stop at a given time, with all processes running");
  auto options = std::make_shared<GotoOptions>();
  command->add_option("RUN", options->what, "Recording of rtse run --record, or an RTSProfile with --world")
      ->required()
      ->check(recording_absence_problem);
  auto* time = command->add_option("TIME", options->time_s, "Time to stop at [simulated s]")->seconds_between(0.0, 1e7);
  command->add_option("--until", options->time_s, "Same as TIME")->seconds_between(0.0, 1e7)->excludes(time);
  command->add_option(
      "--break", options->condition,
      "Stop at the first tick where this condition is true, e.g. 'pose(pioneer2dx).x > 2 && A0:out.data < 0.1'; TIME limits the search");
  command->add_option("--back", options->back, "Stop N ticks earlier")->check(base::integer_between(0, 1000000));
  command->add_option("-w,--world", options->world, "SDFormat world, for an RTSProfile")->check(base::existing_file());
  command->add_option("--then", options->then, "Run this shell command at that time and exit, instead of reading commands");
  command->add_option("--seed", options->seed, "Seed of the sensor noise (default: the recorded one)")
      ->check(base::number_between(0, 1e18));
  command->add_option("--start", options->start, "Command that starts third-party components (default: the recorded commands)")
      ->allow_extra_args(false);
  tools::add_run_options(*command, options->run, {"run-file", "module-path", "resource-path", "property", "hang-timeout"});
  command->callback([&chosen, options, command] {
    tools::require(options->time_s || !options->condition.empty(), "goto", "name a TIME, or a condition with --break");
    chosen.work = [options, command](const Session& session, Console& console) { go(session, console, *options, *command); };
  });
}

}  // namespace recorder
