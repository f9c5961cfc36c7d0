#include "run/run_simulator.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/text.h"
#include "run/same_math.h"
#include "run/warm_program.h"
#include "shm/client.h"

namespace editor {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto call_limit = 5s;
constexpr auto look_period = 100ms;                         // at the processes: one that dies is named within it
constexpr auto show_period = 1s;                            // of progress
constexpr auto long_time = 1s;                              // without a step: somebody is named
constexpr int lowest_server = 5000, highest_server = 9999;  // those below are for people and their scripts
const std::string log_name = "sim-server.log";

nlohmann::json parsed(const Result<std::string>& text) { return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json(); }

}  // namespace

Result<void> RunSimulator::start(const Wait& wait_until) {
  static std::atomic<unsigned> next{static_cast<unsigned>(getpid()) * 7};
  constexpr int tries = 50;
  for (int i = 0; i < tries; ++i) {
    id_ = std::to_string(lowest_server + next.fetch_add(1) % (highest_server - lowest_server + 1));
    if (owner()) continue;  // somebody's
    const auto started = try_start(wait_until);
    if (started || !owner()) return started;
    process_.reset();  // somebody was quicker
  }
  return Error{"no server id is free"};
}

Result<void> RunSimulator::try_start(const Wait& wait_until) {
  ProgramCall call{{own_program("sim-server"), options_.world, "--server-id", id_, "--paused", "--lockstep", "--rtf",
                    options_.in_real_time ? "1" : "0", "--seed", std::to_string(options_.seed), "--record", place_.new_file("record.txt")},
                   {same_math()},
                   place_.new_file(log_name)};
  if (hashes_.is_wanted() && options_.hash_period_s > 0)
    call.words.insert(call.words.end(), {"--hash-period", base::format_number(options_.hash_period_s)});
  if (hashes_.is_wanted()) call.words.insert(call.words.end(), {"--hash-log", hashes_.world_part()});
  for (const auto& path : options_.resource_paths) call.words.insert(call.words.end(), {"--resource-path", path});
  call.words.insert(call.words.end(), options_.simulator_options.begin(), options_.simulator_options.end());
  auto started = start_program(options_.warm, call);
  if (!started) return started.error();
  process_.emplace(std::move(*started));
  return wait_until("simulator", [&] {
    if (!is_in_memory()) return false;  // a look costs less than a program that looks
    const auto stats = statistics(call_limit);
    if (stats.value("pid", 0) != process_->pid()) return false;
    step_s_ = stats.value("step", 0.0);
    return step_s_ > 0;
  });
}

void RunSimulator::end() {
  if (!process_) return;
  process_->terminate();
  const bool is_killed = !process_->wait(call_limit) || process_->exit_code() >= 128;
  process_.reset();
  if (is_killed && !owner()) remove_segments();
}

Result<void> RunSimulator::check() {
  if (!process_ || process_->is_running()) return {};
  return Error{"sim-server " + process_->how_it_ended() + ": " + telling_line(place_.file(log_name))};
}

std::vector<std::string> RunSimulator::notes() const {
  std::vector<std::string> notes;
  for (const auto& line : lines_of(place_.file(log_name))) {
    if (level_of(line) != LogLevel::info) notes.push_back(line);
  }
  return notes;
}

Result<std::string> RunSimulator::simctl(const std::vector<std::string>& words, std::chrono::milliseconds limit) const {
  ProgramCall call{{own_program("simctl"), "-s", id_}, {}, ""};
  call.words.insert(call.words.end(), words.begin(), words.end());
  auto started = start_program(options_.warm, call);
  return started ? output_of(*started, limit) : started.error();
}

nlohmann::json RunSimulator::statistics(std::chrono::milliseconds limit) const {
  auto json = parsed(simctl({"--json", "stats"}, limit));
  return json.is_object() ? json : nlohmann::json::object();
}

// Of the simulator with our id, whoever's it is.
std::optional<pid_t> RunSimulator::owner() const {
  if (!is_in_memory()) return std::nullopt;
  const auto stats = statistics(call_limit);
  return stats.contains("pid") ? std::optional(stats.value("pid", 0)) : std::nullopt;
}

std::optional<double> RunSimulator::time() const {
  const auto stats = process_ ? statistics(call_limit) : nlohmann::json::object();
  return stats.contains("sim_time") ? std::optional(stats.value("sim_time", 0.0)) : std::nullopt;
}

std::set<std::string> RunSimulator::participants() const {
  std::set<std::string> names;
  const auto json = parsed(simctl({"--json", "participants"}, call_limit));
  for (const auto& participant : json.is_array() ? json : nlohmann::json::array()) names.insert(participant.value("name", ""));
  return names;
}

PlacesInTime RunSimulator::places() const {
  const std::chrono::nanoseconds step(std::llround(step_s_ * 1e9));
  PlacesInTime places;
  const auto json = parsed(simctl({"--json", "participants"}, call_limit));
  for (const auto& participant : json.is_array() ? json : nlohmann::json::array())
    places[participant.value("name", "")] = {participant.value("phase", std::int64_t{0}),
                                             std::max(std::chrono::nanoseconds(participant.value("period_ns", std::int64_t{0})), step)};
  return places;
}

std::vector<std::string> RunSimulator::models() const {
  std::vector<std::string> names;
  const auto json = parsed(simctl({"--json", "tree"}, call_limit));
  for (const auto& model : json.is_object() ? json.value("models", nlohmann::json::array()) : nlohmann::json::array())
    names.push_back(model.value("name", ""));
  return names;
}

Result<void> RunSimulator::make_steps(std::int64_t steps, const std::function<Result<void>()>& alive,
                                      const std::function<void(double)>& passed) {
  ProgramCall call{{own_program("simctl"), "-s", id_, "step", std::to_string(steps)}, {}, ""};
  if (options_.in_real_time) call.words.push_back("--paced");
  auto stepping = start_program(options_.warm, call);
  if (!stepping) return stepping.error();
  auto clock = shm::Iface::open(static_cast<std::uint32_t>(base::parse_integer(id_).value_or(0)), shm::IfaceType::simulation, "world");
  if (!clock) return clock.error();
  std::uint64_t last = 0;
  auto moved = Clock::now(), shown = moved;
  bool is_told = false;
  for (;;) {
    const auto ending = stepping->wait_or_interrupt(look_period);
    if (ending == Ending::interrupted) return Error{"run: interrupted"};
    if (const auto good = alive(); !good) return good;
    if (ending == Ending::ended) {
      const auto said = output_of(*stepping);
      return said ? Result<void>() : said.error();
    }
    const auto now = Clock::now();
    if (clock->read()) {
      const auto& sample = clock->sample<shm::SimulationSample>();
      last_time_ = base::to_seconds(std::chrono::nanoseconds(sample.stamp.sim_time_ns));
      if (std::exchange(last, sample.steps) != sample.steps) moved = now;
    }
    if (now - shown > show_period) {
      shown = now;
      passed(last_time_);
    }
    if (now - moved > long_time && !std::exchange(is_told, true)) reporter_.warn(base::printable(who_waits()));
    if (now - moved > std::chrono::duration<double>(options_.hang_timeout_s)) return Error{who_hangs()};
  }
}

std::vector<std::string> RunSimulator::late() const {
  const auto json = parsed(simctl({"--json", "participants"}, 1s));
  std::vector<std::string> late;
  for (const auto& participant : json.is_array() ? json : nlohmann::json::array()) {
    if (participant.value("late", false)) late.push_back(participant.value("name", "?"));
  }
  return late;
}

std::string RunSimulator::who_waits() const {
  const auto names = late();
  return (names.empty() ? "the simulator" : base::join(names, ", ")) + ": has not ended its tick at " + base::format_number(last_time_) +
         " s for more than a second of real time; it is waited for up to " + base::format_number(options_.hang_timeout_s) +
         " s (--hang-timeout)";
}

std::string RunSimulator::who_hangs() const {
  const auto names = late();
  const auto end =
      " at " + base::format_number(last_time_) + " s after " + base::format_number(options_.hang_timeout_s) + " s (--hang-timeout)";
  return names.empty() ? "the simulator has not ended its step" + end : base::join(names, ", ") + ": has not ended its tick" + end;
}

std::string RunSimulator::segment_prefix() const { return "rtmsim-" + std::to_string(getuid()) + "-" + id_ + "."; }

// Whether there is, or was, a simulator with our id.
bool RunSimulator::is_in_memory() const {
  std::error_code ignored;  // who cannot look sees nothing
  return std::filesystem::exists("/dev/shm/" + segment_prefix() + "simulation.world", ignored);
}

// After an orderly end there is nothing. The id was ours alone.
void RunSimulator::remove_segments() const {
  const auto prefix = segment_prefix();
  std::error_code ignored;  // nobody else may be harmed by a file that stays
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", ignored)) {
    if (entry.path().filename().string().starts_with(prefix)) std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace editor
