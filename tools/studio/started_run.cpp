#include "studio/started_run.h"

#include <omnithread.h>

#include <condition_variable>
#include <cstdlib>
#include <optional>
#include <thread>

#include "base/child_process.h"
#include "base/guarded.h"
#include "base/text.h"
#include "run/run_script.h"
#include "shm/request_board.h"
#include "studio/start_hints.h"

namespace studio {
namespace {

using base::Error;
using base::Result;
using namespace std::chrono_literals;

// Stands before the first step of a run for as long as the studio wants it.
class Standing final : public tools::RunScript {
 public:
  struct State {
    std::string naming;
    std::uint32_t server_id = 0;
    bool is_there = false;
    bool is_ending = false;
    std::optional<Error> problem;  // it has ended, and why
    bool is_rejected = false;      // before anything ran
  };

  const std::vector<tools::Expectation>& watched() const override { return nothing_; }
  Result<void> begin(tools::RunScene& scene) override {
    auto state = state_.lock();
    state->naming = scene.naming;
    state->server_id = static_cast<std::uint32_t>(base::parse_integer(scene.simulator.id()).value_or(0));
    state->is_there = true;
    changed_.notify_all();
    state.wait(changed_, [&] { return state->is_ending; });
    return Error{"the studio has ended"};
  }
  std::optional<std::int64_t> next_stop(std::int64_t) const override { return std::nullopt; }
  Result<void> act(tools::RunScene&, std::int64_t) override { return {}; }
  bool excuses(const std::string&) const override { return true; }
  void end(tools::RunScene*, const tools::Seen&, tools::RunResult&) override {}

  void has_ended(const std::string& problem, bool is_rejected) {
    auto state = state_.lock();
    state->problem = Error{problem};
    state->is_rejected = is_rejected;
    changed_.notify_all();
  }
  Result<void> wait_until_there() {
    auto state = state_.lock();
    state.wait(changed_, [&] { return state->is_there || state->problem; });
    if (state->is_there) return {};
    return *state->problem;
  }
  void let_go() {
    state_.lock()->is_ending = true;
    changed_.notify_all();
  }
  State state() const { return state_.snapshot(); }

 private:
  const std::vector<tools::Expectation> nothing_;
  base::Guarded<State, base::Rank::manager> state_;
  std::condition_variable changed_;
};

class SystemRun final : public StartedRun {
 public:
  SystemRun(CORBA::ORB_ptr orb, const StartOptions& start, tools::Reporter& reporter)
      : thread_([this, orb, start, &reporter] { run(orb, start, reporter); }) {}
  ~SystemRun() override {
    standing_.let_go();
    thread_.join();
  }
  Result<void> wait() { return standing_.wait_until_there(); }
  bool is_rejected() const { return standing_.state().is_rejected; }
  std::string name_server() const override { return standing_.state().naming; }
  std::uint32_t server_id() const override { return standing_.state().server_id; }

 private:
  void run(CORBA::ORB_ptr orb, const StartOptions& start, tools::Reporter& reporter) {
    const omni_thread::ensure_self known_to_the_orb;  // time-outs per thread need it
    tools::RunOptions options;
    options.system = start.system;
    options.world = start.world;
    options.in_real_time = true;
    std::string problem;
    bool is_rejected = false;
    try {
      const auto result = tools::run_system(orb, options, reporter, {.script = &standing_});
      problem = result.problem;
      is_rejected = result.refusal != tools::RunResult::Refusal::none;
    } catch (const CORBA::Exception& e) {
      problem = tools::describe(e);
    } catch (const std::exception& e) {
      problem = e.what();
    }
    standing_.has_ended(problem, is_rejected);
  }

  Standing standing_;
  std::thread thread_;  // last: it uses it
};

class WorldRun final : public StartedRun {
 public:
  WorldRun(base::ChildProcess process, std::uint32_t server_id) : process_(std::move(process)), server_id_(server_id) {}
  std::string name_server() const override { return {}; }
  std::uint32_t server_id() const override { return server_id_; }

  // The simulator answers; nobody announces that.
  Result<void> wait() {
    constexpr auto limit = 60s;
    constexpr auto pause = 50ms;
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < deadline) {
      if (!process_.is_running()) {
        const auto lines = base::split_list(process_.said(), '\n');
        if (is_rejected() && !lines.empty()) return Error{lines.back()};
        return Error{"sim-server " + process_.how_it_ended() + (lines.empty() ? "" : ": " + lines.back())};
      }
      if (auto simulator = shm::Requester::open(server_id_); simulator && simulator->ask(shm::StatsRequest{}, 1s)) return {};
      std::this_thread::sleep_for(pause);
    }
    return Error{"sim-server: not ready after 60 s"};
  }
  bool is_rejected() {
    constexpr int wrong_command_line = 2;  // or the world that it names
    return !process_.is_running() && process_.exit_code() == wrong_command_line;
  }

 private:
  base::ChildProcess process_;
  const std::uint32_t server_id_;
};

template <class Run>
Result<std::unique_ptr<StartedRun>> ready(std::unique_ptr<Run> run, bool& is_rejected) {
  const auto there = run->wait();
  is_rejected = run->is_rejected();
  if (!there) return there.error();
  return std::unique_ptr<StartedRun>(std::move(run));
}

}  // namespace

Result<base::ChildProcess> start_host(const std::string& name_server) {
  // Its modules are looked for where it runs; the manager's own log is for its folder.
  return base::ChildProcess::start({{base::own_program("rtcd"), "--with-naming", "-o", "corba.nameservers:" + name_server, "-o",
                                     "manager.modules.load_path:" + own_modules(), "-o", "naming.update.interval:1"},
                                    {},
                                    "/dev/null"});
}

Result<std::unique_ptr<StartedRun>> StartedRun::start(CORBA::ORB_ptr orb, const StartOptions& options, std::uint32_t server_id,
                                                      tools::Reporter& reporter, bool& is_rejected) {
  if (!options.system.empty()) {
    auto run = std::make_unique<SystemRun>(orb, options, reporter);
    return ready(std::move(run), is_rejected);
  }
  if (shm::Requester::open(server_id))
    return Error{"simulator " + std::to_string(server_id) + ": runs already; leave --world out to attach to it, or choose another -s"};
  base::ProgramCall call{{base::own_program("sim-server"), options.world, "--paused", "--server-id", std::to_string(server_id)}, {}, ""};
  for (const auto& path : options.resource_paths) call.words.insert(call.words.end(), {"--resource-path", path});
  auto process = base::ChildProcess::start(call);
  if (!process) return process.error();
  return ready(std::make_unique<WorldRun>(std::move(*process), server_id), is_rejected);
}

}  // namespace studio
