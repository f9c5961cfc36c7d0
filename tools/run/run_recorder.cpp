#include "run/run_recorder.h"

#include <signal.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>

#include "base/text.h"

namespace editor {

namespace {

// What waits in its queue is written first.
constexpr std::chrono::seconds recorder_limit{40};

}  // namespace

std::string RunRecorder::said() const {
  std::ifstream in(log_);
  return {std::istreambuf_iterator<char>(in), {}};
}

// The line may come after others: what the ORB has to say of a component.
bool RunRecorder::has_begun() const {
  const auto lines = base::split_list(said(), '\n');
  return std::ranges::any_of(lines, [](const std::string& line) { return line.starts_with("recording "); });
}

base::Result<void> RunRecorder::start(const RecorderCall& call, const Wait& wait_until) {
  log_ = place_.new_file("recorder.log");
  file_ = call.file;
  is_ring_ = call.last_s > 0;
  ProgramCall program{{own_program("rtse-recorder"), "--ns", call.server, "record", "--all", "-s", call.simulator, "-o", call.file,
                       "--attach", "system.xml=" + call.system},
                      {},
                      log_};
  if (call.last_s > 0) program.words.insert(program.words.end(), {"--last", base::format_number(call.last_s)});
  takes_hashes_ = !call.hashes.empty();
  if (takes_hashes_) program.words.insert(program.words.end(), {"--hashes", call.hashes});
  for (const auto& [key, value] : call.notes) program.words.insert(program.words.end(), {"--note", key + "=" + value});
  auto started = ChildProcess::start(program);
  if (!started) return started.error();
  process_.emplace(std::move(*started));
  const auto ready = wait_until("recorder", [&] { return has_begun() || !process_->is_running(); });
  if (!ready) return ready;
  if (process_->is_running()) return {};
  const auto lines = base::split_list(said(), '\n');
  return base::Error{"recording " + base::in_quotes(call.file) + ": " + (lines.empty() ? process_->how_it_ended() : lines.back())};
}

base::Result<void> RunRecorder::look_again(const Wait& wait_until) {
  constexpr std::string_view mark = "looked again";
  const auto looks = [&] {
    const auto text = said();
    std::size_t count = 0;
    for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1)) ++count;
    return count;
  };
  if (!process_ || !process_->is_running()) return {};
  const auto before = looks();
  ::kill(process_->pid(), SIGUSR1);
  return wait_until("recorder", [&] { return looks() > before || !process_->is_running(); });
}

bool RunRecorder::await_word(const char* word) {
  const auto deadline = std::chrono::steady_clock::now() + recorder_limit;
  while (said().find(word) == std::string::npos) {
    if (!process_->is_running() || std::chrono::steady_clock::now() > deadline) return false;
    process_->wait(std::chrono::milliseconds(5));  // its end comes by itself, its words must be looked for
  }
  return true;
}

void RunRecorder::end() {
  if (!process_) return;
  if (process_->is_running()) process_->terminate();
  if (takes_hashes_) {
    (void)await_word("waiting for hashes");
  } else {
    (void)process_->wait(recorder_limit);
  }
}

base::Result<void> RunRecorder::finish() {
  if (!process_) return {};
  if (takes_hashes_ && process_->is_running()) ::kill(process_->pid(), SIGTERM);  // a second time, which says that they are there
  const bool has_ended = process_->wait(recorder_limit);
  const bool is_good = has_ended && process_->exit_code() == 0;
  const auto lines = base::split_list(said(), '\n');
  const std::string how = has_ended ? process_->how_it_ended() : "does not end";
  const bool was_killed = has_ended && process_->exit_code() >= 128;
  process_.reset();
  if (is_good) return {};
  // A recorder that ends by itself says what is where.
  if (was_killed && is_ring_)
    return base::Error{"recorder: " + how + "; what came before is in pieces of the ring, rtse recording repair " + file_ +
                       " puts it together"};
  if (was_killed) return base::Error{"recorder: " + how + "; what came before is in the file"};
  return base::Error{"recorder: " + how + (lines.empty() ? "" : ": " + lines.back())};
}

}  // namespace editor
