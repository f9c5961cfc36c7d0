// run --like: the run of a recording, by rtse run itself.
#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "base/child_process.h"
#include "base/interrupt.h"
#include "base/text.h"
#include "recording/ring.h"
#include "rtse/command.h"
#include "rtse/recorder/recorder_commands.h"
#include "run/recorded_run.h"

namespace recorder {

namespace {

using editor::Console;
using editor::Session;

struct LikeOptions {
  std::string file;
  std::vector<std::string> more;  // options of rtse run
};

bool has(const LikeOptions& options, const std::string& name) {
  for (const auto& word : options.more) {
    if (word == name || word.starts_with(name + "=")) return true;
  }
  return false;
}

// What the user says counts before what was recorded.
std::vector<std::string> words_of(Console& console, const LikeOptions& options, const RecordedRun& run) {
  const auto call = run.options();
  std::vector<std::string> words = {editor::own_program("rtse")};
  if (console.json()) words.emplace_back("--json");
  words.insert(words.end(), {"run", call.system});
  const auto give = [&](const char* name, const char* other, const std::string& value) {
    if (!has(options, name) && !has(options, other)) words.insert(words.end(), {name, value});
  };
  give("--world", "-w", call.world);
  give("--duration", "-d", base::format_number(call.duration_s));
  give("--seed", "--seeds", std::to_string(call.seed));
  if (call.one_process_each && !has(options, "--one-process-each")) words.emplace_back("--one-process-each");
  for (const auto& command : call.start) words.insert(words.end(), {"--start", command});
  if (!call.start.empty()) words.insert(words.end(), {"--start-folder", call.start_folder});
  if (!call.run_file.empty()) words.insert(words.end(), {"--run-file", call.run_file});
  for (const auto& property : call.properties) words.insert(words.end(), {"--property", property});
  for (const auto& path : call.module_paths) words.insert(words.end(), {"--module-path", path});
  for (const auto& path : call.resource_paths) words.insert(words.end(), {"--resource-path", path});
  words.insert(words.end(), options.more.begin(), options.more.end());
  return words;
}

void run_like(Console& console, const LikeOptions& options) {
  const auto run = RecordedRun::unpack(options.file);
  if (!run) return console.fail(run.error());
  if (const auto lost = run->lost(); !lost.empty()) console.warn(lost);
  auto words = words_of(console, options, *run);
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  editor::catch_interrupts();  // the run gets them, too, and takes its processes down
  pid_t child = 0;
  if (const int failed = ::posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), environ); failed != 0)
    return console.fail({"program " + words[0] + ": cannot be started: " + std::strerror(failed)});
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) console.set_failed();
}

}  // namespace

void add_run_like(base::Command& app, editor::Chosen& chosen) {
  auto* command = app.add_subcommand("run", "Make a recorded run again; all options of rtse run besides");
  auto options = std::make_shared<LikeOptions>();
  command->add_option("--like", options->file, "A recording of rtse run --record")->required()->check(check_recording);
  command->allow_extras();
  command->fallthrough(false);
  command->callback([&chosen, options, command] {
    options->more = command->remaining();
    chosen.needs_orb = false;
    chosen.work = [options](const Session&, Console& console) { run_like(console, *options); };
  });
}

}  // namespace recorder
