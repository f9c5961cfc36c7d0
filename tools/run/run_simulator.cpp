#include "run/run_simulator.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <utility>

#include "base/text.h"
#include "run/prefork_server.h"
#include "run/same_math.h"

namespace tools {
namespace {

using namespace std::chrono_literals;

constexpr auto end_limit = 5s;
constexpr int lowest_server = 5000, highest_server = 9999;  // those below are for people and their scripts
const std::string log_name = "sim-server.log";

std::string segment_prefix(std::uint32_t id) { return "rtmsim-" + std::to_string(getuid()) + "-" + std::to_string(id) + "."; }

// Whether there is, or was, a simulator with this server ID.
bool is_in_memory(std::uint32_t id) {
  std::error_code ignored;  // who cannot look sees nothing
  return std::filesystem::exists("/dev/shm/" + segment_prefix(id) + "simulation.world", ignored);
}

// After an orderly end there is nothing. The ID was ours alone.
void remove_segments(std::uint32_t id) {
  const auto prefix = segment_prefix(id);
  std::error_code ignored;  // nobody else may be harmed by a file that stays
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", ignored)) {
    if (entry.path().filename().string().starts_with(prefix)) std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace

Result<void> RunSimulator::start(const Wait& wait_until, bool writes_poses) {
  static std::atomic<unsigned> next{static_cast<unsigned>(getpid()) * 7};
  constexpr int tries = 50;
  for (int i = 0; i < tries; ++i) {
    id_ = lowest_server + next.fetch_add(1) % (highest_server - lowest_server + 1);
    if (owner(id_)) continue;  // somebody's
    const auto started = try_start(id_, wait_until, writes_poses);
    // Somebody was quicker, who may have ended since.
    const bool was_taken = owner(id_) || telling_line(place_.file(log_name)).find("is already running as pid") != std::string::npos;
    if (started || !was_taken) return started;
    process_.reset();
  }
  return Error{"no server id is free"};
}

Result<void> RunSimulator::try_start(std::uint32_t id, const Wait& wait_until, bool writes_poses) {
  base::ProgramCall call{{base::own_program("sim-server"), options_.world, "--server-id", std::to_string(id), "--paused", "--lockstep",
                          "--rtf", options_.in_real_time ? "1" : "0", "--seed", std::to_string(options_.seed)},
                         {same_math()},
                         place_.new_file(log_name)};
  if (writes_poses) call.words.insert(call.words.end(), {"--record", place_.new_file("record.txt")});
  if (hashes_.is_wanted() && options_.hash_period_s > 0)
    call.words.insert(call.words.end(), {"--hash-period", base::format_number(options_.hash_period_s)});
  if (hashes_.is_wanted()) call.words.insert(call.words.end(), {"--hash-log", hashes_.world_part()});
  call.words.insert(call.words.end(), {"--rolling", options_.rolling});
  for (const auto& path : options_.resource_paths) call.words.insert(call.words.end(), {"--resource-path", path});
  call.words.insert(call.words.end(), hooks_.simulator_options.begin(), hooks_.simulator_options.end());
  auto started = start_program(hooks_.prefork, call);
  if (!started) return started.error();
  process_.emplace(std::move(*started));
  return wait_until("simulator", [&] { return is_in_memory(id) && control_.attach(id, process_->pid()).ok(); });
}

Result<void> RunSimulator::end() {
  if (!process_) return {};
  const bool was_running = process_->is_running();
  process_->terminate();
  const bool is_killed = !process_->wait(end_limit) || process_->exit_code() >= 128;
  const bool is_complete = !was_running || is_killed || process_->exit_code() == 0;  // what has ended before is known
  process_.reset();
  if (is_killed && !owner(id_)) remove_segments(id_);
  return is_complete ? Result<void>() : Error{"sim-server: " + telling_line(place_.file(log_name))};
}

Result<void> RunSimulator::check() {
  if (!process_ || process_->is_running()) return {};
  return Error{"sim-server " + process_->how_it_ended() + ": " + telling_line(place_.file(log_name))};
}

std::string RunSimulator::refusal() {
  constexpr int wrong_command_line = 2;  // or a file that it names
  const bool is_refused = process_ && !process_->is_running() && process_->exit_code() == wrong_command_line;
  return is_refused ? telling_line(place_.file(log_name)) : std::string();
}

std::vector<std::string> RunSimulator::notes() const {
  std::vector<std::string> notes;
  for (const auto& line : lines_of(place_.file(log_name))) {
    if (level_of(line) != LogLevel::info) notes.push_back(line);
  }
  return notes;
}

// Of the simulator with this server ID, whoever's it is.
std::optional<pid_t> RunSimulator::owner(std::uint32_t id) const { return is_in_memory(id) ? ShmSimulator::process_of(id) : std::nullopt; }

}  // namespace tools
