#include "run/run_recorder.h"

#include <chrono>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/text.h"

namespace tools {

using recorder::RecorderMessage;

namespace {

// What waits in its queue is written first.
constexpr std::chrono::seconds recorder_limit{40};
constexpr std::chrono::milliseconds no_wait{0};  // the caller waits
constexpr std::chrono::seconds exit_limit{1};    // after the end of its line

}  // namespace

std::string RunRecorder::said() const {
  std::ifstream in(log_);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Whether it has sent this, or never will: one that stops by itself, because its disk is full, does nothing else any more.
bool RunRecorder::has_told(RecorderMessage message, std::chrono::milliseconds timeout) {
  if (has_stopped_) return true;
  const auto received = line_->receive(timeout);
  if (!received) return process_->wait(exit_limit), true;
  has_begun_ = has_begun_ || *received == RecorderMessage::recording;
  has_stopped_ = *received == RecorderMessage::stopped;
  return *received == message || has_stopped_;
}

bool RunRecorder::tell(RecorderMessage message) {
  if (!process_->is_running()) return false;
  if (line_->send(message)) return true;
  process_->terminate();
  return false;
}

base::Result<void> RunRecorder::start(const RecorderCall& call, const Wait& wait_until) {
  log_ = place_.new_file("recorder.log");
  file_ = call.file;
  is_ring_ = call.last_s > 0;
  base::ProgramCall program{{base::own_program("rtse-recorder"), "--ns", call.server, "record", "--all", "-s", call.simulator, "-o",
                             call.file, "--controlled", "--attach", "system.xml=" + call.system},
                            {},
                            log_};
  if (!call.script.empty()) program.words.insert(program.words.end(), {"--attach", "script.yaml=" + call.script});
  if (call.last_s > 0) program.words.insert(program.words.end(), {"--last", base::format_number(call.last_s)});
  takes_hashes_ = !call.hashes.empty();
  if (takes_hashes_) program.words.insert(program.words.end(), {"--hashes", call.hashes});
  for (const auto& [key, value] : call.notes) program.words.insert(program.words.end(), {"--note", key + "=" + value});
  auto line = recorder::RecorderLine::make();
  if (!line) return line.error();
  program.input = line->second.get();
  auto started = base::ChildProcess::start(program);
  if (!started) return started.error();
  line_.emplace(std::move(line->first));
  process_.emplace(std::move(*started));
  line->second = base::FileHandle();  // theirs alone
  const auto ready = wait_until("recorder", [&] { return has_told(RecorderMessage::recording, no_wait); });
  if (!ready) return ready;
  if (process_->is_running()) return {};
  const auto lines = base::split_list(said(), '\n');
  return base::Error{"recording " + base::in_quotes(call.file) + ": " + (lines.empty() ? process_->how_it_ended() : lines.back())};
}

base::Result<void> RunRecorder::look_again(const Wait& wait_until) {
  if (!process_ || !tell(RecorderMessage::look_again)) return {};
  return wait_until("recorder", [&] { return has_told(RecorderMessage::looked, no_wait); });
}

void RunRecorder::end() {
  if (!process_) return;
  if (!has_begun_) process_->terminate();  // it reads no message yet
  if (!tell(RecorderMessage::stop)) return;
  if (takes_hashes_) {
    (void)has_told(RecorderMessage::stopped, recorder_limit);
  } else {
    (void)process_->wait(recorder_limit);
  }
}

base::Result<void> RunRecorder::finish() {
  if (!process_) return {};
  if (takes_hashes_) (void)tell(RecorderMessage::hashes_ready);
  const bool has_ended = process_->wait(recorder_limit);
  const bool is_good = has_ended && process_->exit_code() == 0;
  const auto lines = base::split_list(said(), '\n');
  const std::string how = has_ended ? process_->how_it_ended() : "does not end";
  const bool was_killed = has_ended && process_->exit_code() >= 128;
  process_.reset();
  if (is_good) return {};
  // A recorder that ends by itself says what is where.
  if (was_killed && is_ring_)
    return base::Error{"recorder: " + how + "; earlier samples are in the segments of the ring: rtse recording repair " + file_ +
                       " puts it together"};
  if (was_killed) return base::Error{"recorder: " + how + "; earlier samples are in the file"};
  return base::Error{"recorder: " + how + (lines.empty() ? "" : ": " + lines.back())};
}

}  // namespace tools
