#include "run/run_system.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "base/interrupt.h"
#include "base/text.h"
#include "run/foreign_links.h"
#include "run/foreign_processes.h"
#include "run/lost_members.h"
#include "run/nondeterminism_report.h"
#include "run/port_values.h"
#include "run/run_files.h"
#include "run/run_hashes.h"
#include "run/run_hosts.h"
#include "run/run_judge.h"
#include "run/run_naming.h"
#include "run/run_options.h"
#include "run/run_recorder.h"
#include "run/run_script.h"
#include "run/run_simulator.h"
#include "run/run_wiring.h"
#include "run/stepping.h"
#include "system/profile/system_template.h"
#include "system/reporter.h"
#include "system/saved_system.h"

namespace tools {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// Everything of one run. Its end takes the processes down, the components before the simulator before the naming service.
class Run final : public RunningSystem {
 public:
  Run(CORBA::ORB_ptr orb, const RunOptions& options, Reporter& reporter, const RunHooks& hooks)
      : orb_(CORBA::ORB::_duplicate(orb)),
        options_(options),
        hooks_(hooks),
        reporter_(reporter),
        place_(options.keep),
        naming_(place_, options.hang_timeout_s),
        hashes_(options.hash_log, place_),
        simulator_process_(options_, hooks_, place_, hashes_),
        simulator_(simulator_process_.control()),
        hosts_(options_, hooks_, place_, hashes_, simulator_),
        foreign_(place_) {}

  RunResult go() {
    const auto began = Clock::now();
    result_.seed = options_.seed;
    if (const auto done = run(); !done) {
      const bool is_refused = result_.refusal != RunResult::Refusal::none;
      result_.problem = is_refused ? done.error().message : with_naming(done.error().message);
      if (!is_refused) result_.logs = last_words();
    }
    ports_.end();
    if (const auto ended = links_.end(); !ended) result_.verdicts.push_back({"hash log", ended.error().message});
    recorder_.end();
    if (!hashes_.is_wanted()) keep_recording();
    const auto warnings = hosts_.warnings();
    result_.notes.insert(result_.notes.end(), warnings.begin(), warnings.end());
    if (hooks_.script) hooks_.script->end(scene_ ? &*scene_ : nullptr, judge_.seen(), result_);
    stop();
    keep_hashes();
    if (hashes_.is_wanted()) keep_recording();
    drop_ring();
    result_.wall_s = std::chrono::duration<double>(Clock::now() - began).count();
    return result_;
  }

  const std::string& naming() const override { return naming_.address(); }
  const std::string& simulator() const override { return simulator_.id(); }
  double step() const override { return simulator_.step(); }
  std::vector<Process> processes() const override {
    std::vector<Process> all = {{"sim-server", simulator_process_.pid()}};
    const auto hosts = hosts_.processes();
    all.insert(all.end(), hosts.begin(), hosts.end());
    const auto foreign = foreign_.processes();
    all.insert(all.end(), foreign.begin(), foreign.end());
    all.push_back({"omniNames", naming_.pid()});
    return all;
  }
  Result<void> make_steps(std::int64_t steps) override {
    const auto now = simulator_.now();  // a break may have stopped the last steps before their end
    if (!now) return fail("simulator " + simulator_.id() + " does not respond");
    return advance(std::llround(now->time_s / simulator_.step()), steps, [](double) {});
  }

 private:
  Result<void> run() {
    for (auto step : {&Run::read, &Run::read_expectations, &Run::start_naming, &Run::start_simulator, &Run::check_models,
                      &Run::start_foreign, &Run::start_hosts, &Run::wire, &Run::check_values, &Run::listen, &Run::record,
                      &Run::begin_script, &Run::drive, &Run::look, &Run::run_commands, &Run::judge_all}) {
      const auto done = (this->*step)();
      if (!done && result_.refusal != RunResult::Refusal::none) return done;
      if (!done) return base::is_interrupted() ? fail("run: interrupted") : lost_.with_reason(done.error());
      if (hooks_.driver && step == &Run::drive) return done;
    }
    return {};
  }

  Result<void> read_all() {
    auto system = read_system(options_.system, options_.lists);
    if (!system) return system.error();
    system_ = std::move(*system);
    auto properties = check_against(options_, system_);
    if (!properties) return properties.error();
    properties_ = std::move(*properties);
    if (hooks_.script) {
      if (const auto altered = hooks_.script->alter(system_); !altered) return altered;
    }
    return foreign_.read(options_, system_, properties_);
  }

  Result<void> read() { return refused(RunResult::Refusal::system, read_all()); }
  Result<void> read_expectations() { return refused(RunResult::Refusal::expectations, judge_.read()); }

  // A component that adds models may do so when it is active, a program of others at any time, and a script when it says so.
  Result<void> check_models() {
    const bool has_spawner = std::ranges::any_of(
        system_.components, [](const auto& component) { return component.id.find(":RTCSimulation:") != std::string::npos; });
    return refused(RunResult::Refusal::expectations, judge_.check_models(has_spawner || !foreign_.empty() || hooks_.script != nullptr));
  }

  Result<void> check_values() { return refused(RunResult::Refusal::expectations, judge_.check_values(wiring_.session())); }

  Result<void> refused(RunResult::Refusal refusal, Result<void> checked) {
    if (!checked && !base::is_interrupted()) result_.refusal = refusal;
    return checked;
  }

  static Result<void> fail(const std::string& what) { return Error{what}; }

  using Seconds = std::chrono::duration<double>;
  Seconds start_limit() const { return Seconds(options_.start_timeout_s); }

  // A problem that has a reason: what needs the naming service cannot be found without it.
  std::string with_naming(const std::string& problem) {
    const auto answer = base::is_interrupted() ? Result<void>() : naming_.ask();
    return answer || problem == answer.error().message ? problem : answer.error().message + "; " + problem;
  }

  Result<void> wait_until(const std::string& what, const std::function<bool()>& ready) { return wait_until(what, ready, start_limit()); }

  // Waits until `ready`, a child ends, an interrupt comes, or time is up. A wait is told after a third of the time.
  Result<void> wait_until(const std::string& what, const std::function<bool()>& ready, Seconds limit) {
    const auto began = Clock::now();
    auto told = began;
    while (!ready()) {
      const auto now = Clock::now();
      if (base::is_interrupted()) return fail("run: interrupted");
      if (const auto alive = check_children(); !alive) return alive;
      if (now - began > limit) return fail(what + ": not ready after " + base::format_number(limit.count()) + " s (--start-timeout)");
      if (now - told > limit / 3) {
        told = now;
        reporter_.warn(base::printable(what) + ": not ready after " + std::to_string(std::lround(Seconds(now - began).count())) +
                       " s; waiting up to " + base::format_number(limit.count()) + " s (--start-timeout)");
      }
      std::this_thread::sleep_for(20ms);  // what is waited for is another program's start, which nobody announces
    }
    return {};
  }

  Result<void> check_children() {
    if (const auto alive = naming_.check(); !alive) return alive;
    if (const auto alive = simulator_process_.check(); !alive) return alive;
    if (const auto whole = lost_.check(); !whole) return whole;
    return hosts_.check();
  }

  Stepping stepping(std::function<void(double)> passed) {
    return {options_.in_real_time, options_.hang_timeout_s, [this] { return check_children(); }, std::move(passed),
            [this](const std::string& text) { reporter_.warn(who_is_stopped(processes()) + text); }};
  }

  // For the commands of the user, and for whoever looks at a run afterwards.
  bool writes_poses() const {
    return !options_.keep.empty() ||
           std::ranges::any_of(judge_.expectations(), [](const auto& one) { return one.kind == Expectation::Kind::command; });
  }

  RunSimulator::Wait wait() {
    return [this](const auto& what, const auto& ready) { return wait_until(what, ready); };
  }

  Result<void> start_naming() {
    const auto started = naming_.start(orb_, wait());
    hosts_.use(naming_.address(), properties_);
    return started;
  }

  Result<void> start_simulator() {
    const auto started = simulator_process_.start(wait(), writes_poses());
    if (started) result_.notes = simulator_process_.notes();
    const auto refusal = simulator_process_.refusal();
    return refusal.empty() ? started : refused(RunResult::Refusal::system, fail(refusal));
  }

  // When everybody has ended.
  void keep_hashes() {
    if (!hashes_.is_wanted()) return;
    const auto hash = hashes_.merge();
    if (hash) {
      result_.run_hash = hash_text(*hash);
    } else {
      result_.verdicts.push_back({"hash log " + options_.hash_log, hash.error().message});
    }
  }

  // Its hashes are there, if it is to have some.
  void keep_recording() {
    if (const auto recorded = recorder_.finish(); !recorded)
      result_.verdicts.push_back({"recording " + options_.record, recorded.error().message});
  }

  // The last seconds are for those who look for what went wrong.
  void drop_ring() {
    std::error_code ignored;  // what is not there need not go
    if (options_.record_last_s > 0 && result_.is_passed()) std::filesystem::remove(options_.record, ignored);
  }

  Result<void> start_foreign() {
    result_.has_begun = true;
    return foreign_.start(naming_.address(), simulator_.id());
  }

  // The contexts in which components of others are called.
  Result<void> start_time_host() {
    return foreign_.empty() ? Result<void>() : hosts_.start(foreign_.creations(simulator_.id()), "the contexts of third-party components");
  }

  Result<void> start_hosts() {
    RunHosts::Members all;
    for (const auto& component : system_.components) {
      if (!foreign_.has(component.instance)) all.push_back(&component);
    }
    if (system_.components.empty()) return fail("system " + options_.system + ": has no components");
    if (const auto started = start_time_host(); !started) return started;
    if (const auto started = hosts_.start_all(all); !started) return started;
    std::vector<std::string> expected = foreign_.proxies();
    for (const auto* component : all) expected.push_back(component->instance);
    if (const auto there = await_components(expected, start_limit()); !there) return there;
    return await_components(foreign_.names(), foreign_.start_timeout(start_limit()));
  }

  Result<void> await_components(const std::vector<std::string>& expected, std::chrono::duration<double> limit) {
    std::string missing;
    const auto are_there = [&] {
      const auto names = NamingTree::read(orb_, naming_.address(), 1000ms);
      naming_.answered(names.ok());
      if (!names) return false;
      std::set<std::string> there;
      for (const auto* entry : names->objects()) {
        if (entry->kind == EntryKind::component && entry->health == Health::alive) there.insert(entry->id);
      }
      missing.clear();
      for (const auto& name : expected) {
        if (!there.contains(name)) missing = name;
      }
      return missing.empty();
    };
    const auto waited = wait_until("components", are_there, limit);
    // A host that has ended has been named already.
    if (waited || missing.empty() || base::is_interrupted() || !check_children()) return waited;
    const auto why = hosts_.about(missing);
    return fail("component " + missing + ": is not there after " + base::format_number(limit.count()) + " s" +
                (why.empty() ? foreign_.about(missing) : why));
  }

  Result<void> wire() { return wiring_.wire(result_.notes); }

  // Returns when lock step does not wait for its contexts any more.
  Result<void> kill_host(const std::string& instance) {
    const auto members = hosts_.kill(instance);
    if (!members) return members.error();
    ports_.forget(instances_of(*members));
    return wait_until("end of the host of " + names_of(*members), [&] { return !wiring_.has_participant_of(*members); });
  }

  Result<void> restart_host(const std::string& instance) {
    const auto members = hosts_.restart(instance);
    if (!members) return members.error();
    const auto back = wait_until("components of the host of " + instance, [&] {
      return std::ranges::all_of(*members, [&](const auto* member) {
        const auto view = wiring_.session().component(member->instance + ".rtc", {.contexts = true});
        return view.ok() && view->problem.empty();
      });
    });
    if (!back) return back;
    if (const auto wired = wiring_.wire_again(*members); !wired) return wired;
    if (const auto heard = ports_.listen_again(orb_, wiring_.session(), instances_of(*members)); !heard) return heard;
    return recorder_.look_again(wait());
  }

  // What can be seen only while everything still runs.
  Result<void> look() {
    judge_.take_values(ports_.end());
    naming_.set_running(true);  // what is judged now is found by it
    if (const auto answer = naming_.ask(); !answer) return answer;
    auto nondeterministic_events = links_.nondeterministic_events();
    nondeterministic_events.insert(nondeterministic_events.end(), foreign_.nondeterministic_events().begin(),
                                   foreign_.nondeterministic_events().end());
    return judge_.look(wiring_.session(), nondeterministic_events, result_);
  }

  Result<void> run_commands() {
    if (const auto done = judge_.run_commands(naming_.address()); !done) return done;
    return check_children();
  }

  Result<void> judge_all() { return judge_.judge(result_); }

  // The ends of all logs, for a report.
  std::string last_words() const { return last_lines(place_.file("sim-server.log")) + hosts_.last_words() + foreign_.last_words(); }

  Result<void> record() {
    if (options_.record.empty()) return {};
    auto started =
        recorder_.start({naming_.address(), simulator_.id(), place_.file("system.xml"), std::filesystem::absolute(options_.record).string(),
                         options_.record_last_s, write_script(), hashes_.file(), notes()},
                        wait());
    if (started && hooks_.recording) hooks_.recording();
    return started;
  }

  // Its file; empty: there is nothing that can be done again.
  std::string write_script() const {
    const auto text = hooks_.script != nullptr ? hooks_.script->written() : std::string();
    if (text.empty()) return {};
    const auto file = place_.file("script.yaml");
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }

  // What makes the run again, beside the profile and the world.
  std::vector<std::pair<std::string, std::string>> notes() const {
    RunOptions options = options_;
    if (auto filled = filled_in(options.properties, options.lists)) options.properties = std::move(*filled);  // as the recorded system is
    if (options.start_folder.empty()) options.start_folder = std::filesystem::current_path().string();
    return {
        {options_note, to_json(options, RunOptionSet::repeats_run).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)},
        {"others", base::join(foreign_.names(), "\n")},
        {"script", hooks_.script != nullptr && !hooks_.script->written().empty() ? "yes" : "no"}};
  }

  Result<void> listen() {
    if (hashes_.is_wanted() || reports_nondeterminism(options_)) {
      const auto part = hashes_.is_wanted() ? hashes_.links_part() : std::string();
      const auto silent = links_.listen(orb_, wiring_.session(), system_, foreign_, simulator_.id(), part);
      if (!silent) return silent.error();
      result_.notes.insert(result_.notes.end(), silent->begin(), silent->end());
    }
    if (const auto listening = ports_.listen(orb_, wiring_.session(), judge_.expectations()); !listening || !hooks_.script)
      return listening;
    return ports_.listen(orb_, wiring_.session(), hooks_.script->watched());
  }

  Result<void> begin_script() {
    if (!hooks_.script) return {};
    scene_.emplace(RunScene{
        simulator_, place_, naming_.address(), system_, ports_, [this](const auto& instance) { return kill_host(instance); },
        [this](const auto& instance) { return restart_host(instance); },
        [this](const auto& instance) { return hosts_.is_killed(instance); }, [this](bool is_there) { wiring_.set_naming(is_there); },
        [this](const auto& instance, Detail detail) { return wiring_.component(instance, detail); },
        wiring_.session().transition_timeout()});
    return hooks_.script->begin(*scene_);
  }

  Result<void> drive() {
    if (hooks_.driver) return hooks_.driver(*this);
    const auto left = static_cast<std::int64_t>(std::llround(options_.duration_s / simulator_.step()));
    if (const auto alive = check_children(); !alive) return alive;
    if (const auto watched = judge_.watch(); !watched) return watched;
    double last = 0;  // [s], simulated
    auto shown = Clock::now();
    const auto passed = [&](double now) {
      last = now;
      if (Clock::now() - shown < 1s) return;
      shown = Clock::now();
      reporter_.show_progress(now, options_.duration_s);
      static_cast<void>(judge_.watch());  // so that the simulator need not keep it; at the end it must succeed
    };
    is_stopped_in_a_step_ = false;
    if (const auto stepped = advance(0, left, passed); !stepped) {
      if (!is_stopped_in_a_step_) return stepped;
      const auto now = simulator_.now();
      result_.simulated_s = now ? now->time_s : std::max(last, result_.simulated_s);
      return fail(who_is_stopped(processes()) + stepped.error().message + hosts_.who_is_waited_for(system_) +
                  foreign_.who_may_be_waited_for(system_, late_participants(simulator_)));
    }
    reporter_.end_progress();
    return check_children();
  }

  // Makes steps after `done` ones, and what the script wants between them. An error of a step is marked.
  Result<void> advance(std::int64_t done, std::int64_t steps, const std::function<void(double)>& passed) {
    const auto end = done + steps;
    const auto act = [&] {
      return hooks_.script != nullptr && done > acted_ ? hooks_.script->act(*scene_, acted_ = done) : Result<void>();
    };
    // A break stopped the last steps where the script wanted something, too.
    if (hooks_.script != nullptr && done > acted_ && hooks_.script->next_stop(done - 1) == done) {
      if (const auto acted = act(); !acted) return acted;
    }
    while (done < end) {
      const auto stop = std::min(end, hooks_.script != nullptr ? hooks_.script->next_stop(done).value_or(end) : end);
      const bool is_wanted = hooks_.script != nullptr && hooks_.script->next_stop(done) == stop;
      if (const auto stepped = tools::make_steps(simulator_, stop - done, stepping(passed)); !stepped) {
        is_stopped_in_a_step_ = true;
        return stepped;
      }
      done = stop;
      result_.simulated_s = static_cast<double>(done) * simulator_.step();
      if (!is_wanted) continue;
      if (const auto acted = act(); !acted) return acted;
    }
    return {};
  }

  // A member of others that is told to end gets no onDeactivated, as our own do. Where a tick hangs, or a process has gone, nobody could
  // be deactivated.
  void rest_foreign() {
    if (foreign_.empty() || !wiring_.has_session() || base::is_interrupted() || !late_participants(simulator_).empty() || !naming_.ask())
      return;
    if (!lost_.check()) return;
    for (const auto& problem : foreign_.rest(wiring_.session(), system_)) reporter_.warn(problem);
  }

  // Ends components first, so that they can say good-bye to the naming service.
  void stop() {
    naming_.set_running(true);
    rest_foreign();
    if (!naming_.ask()) naming_.end();  // nobody need wait for it
    foreign_.terminate();
    hosts_.terminate();
    if (!result_.problem.empty()) foreign_.end();  // a host may wait for one that hangs
    hosts_.end();
    foreign_.end();
    if (const auto ended = simulator_process_.end(); !ended && result_.problem.empty()) {
      result_.problem = ended.error().message;
      result_.logs = last_words();
    }
    naming_.end();
  }

  CORBA::ORB_var orb_;
  const RunOptions& options_;
  const RunHooks& hooks_;
  Reporter& reporter_;
  Workplace place_;
  RunNaming naming_;
  SavedSystem system_;
  std::vector<ComponentProperty> properties_;
  RunResult result_;
  RunHashes hashes_;
  RunSimulator simulator_process_;
  Simulator& simulator_;
  RunHosts hosts_;
  ForeignProcesses foreign_;
  LostMembers lost_{foreign_, hosts_, simulator_, [this] { return wiring_.has_session(); },
                    [this](const auto& instance) { return wiring_.component(instance, {}).ok(); }};
  RunRecorder recorder_{place_};
  RunWiring wiring_{{orb_, options_, hooks_, reporter_, place_, naming_, simulator_, hosts_, foreign_, system_}, wait(), [this] {
                      return check_children();
                    }};
  RunJudge judge_{options_, hooks_, place_, system_, simulator_, hosts_, foreign_};
  PortValues ports_;
  ForeignLinks links_;
  std::optional<RunScene> scene_;  // of a script
  std::int64_t acted_ = 0;         // the step after which it did something last
  bool is_stopped_in_a_step_ = false;
};

}  // namespace

RunResult run_system(CORBA::ORB_ptr orb, const RunOptions& options, Reporter& reporter, const RunHooks& hooks) {
  try {
    return Run(orb, options, reporter, hooks).go();
  } catch (const std::filesystem::filesystem_error& error) {
    RunResult result;
    result.seed = options.seed;
    result.problem = folder_problem(error);
    return result;
  }
}

}  // namespace tools
