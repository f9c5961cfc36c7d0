#include "base/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "base/guarded.h"
#include "base/interrupt.h"
#include "base/text.h"

namespace base {
namespace {

constexpr std::chrono::milliseconds ending_limit{5000};
constexpr std::chrono::milliseconds killing_limit{5000};  // the kernel takes its time only when memory or a disk is stuck

int code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

// Between fork and exec only what is safe there: everything is made before.
[[noreturn]] void become(char* const* words, char* const* environment, int input, int output, const char* folder, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);  // the parent died before the line above
  setpgid(0, 0);                        // an interrupt from the terminal is ours to hand on
  const bool is_there = *folder == '\0' || chdir(folder) == 0;
  dup2(input >= 0 ? input : open("/dev/null", O_RDONLY), 0);
  dup2(output, 1);
  dup2(output, 2);
  for (int number = 1; number < NSIG; ++number) signal(number, SIG_DFL);  // what we ignore is no business of others
  close_range(3, ~0U, 0);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  if (is_there) execvpe(words[0], words, environment);
  const char* text = "cannot be started\n";
  static_cast<void>(!write(2, text, std::strlen(text)));
  _exit(127);
}

}  // namespace

Result<ChildProcess> ChildProcess::start(const ProgramCall& call) {
  expect_no_data_held();
  const bool collects = call.output.empty();
  const int output = collects                    ? memfd_create("output", MFD_CLOEXEC)
                     : call.output == own_output ? fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3)  // opened anew it would have a place of its own
                                                 : open(call.output.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (output < 0) return Error{"program " + call.words[0] + ": its output file " + in_quotes(call.output) + " cannot be written"};
  std::vector<std::string> variables;
  for (char** entry = environ; *entry; ++entry) {
    const std::string text = *entry;
    if (!call.environment.contains(text.substr(0, text.find('=')))) variables.push_back(text);
  }
  for (const auto& [key, value] : call.environment) variables.push_back(key + "=" + value);
  std::vector<char*> words;
  std::vector<char*> environment;
  for (const auto& word : call.words) words.push_back(const_cast<char*>(word.c_str()));
  for (auto& variable : variables) environment.push_back(variable.data());
  words.push_back(nullptr);
  environment.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) become(words.data(), environment.data(), call.input, output, call.folder.c_str(), parent);
  if (!collects || child < 0) close(output);
  if (child < 0) return Error{"program " + call.words[0] + ": no process can be made"};
  setpgid(child, child);  // as it does itself: whoever comes first
  return ChildProcess(child, collects ? output : -1, std::filesystem::path(call.words[0]).filename().string(), call.ends_as_group);
}

ChildProcess ChildProcess::made_elsewhere(pid_t pid, int watched, int collected, std::string program, bool ends_as_group) {
  ChildProcess made(pid, collected, std::move(program), ends_as_group);
  made.watched_ = watched;
  return made;
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      started_(other.started_),
      ends_as_group_(other.ends_as_group_),
      is_told_(other.is_told_),
      watched_(std::exchange(other.watched_, -1)),
      collected_(std::exchange(other.collected_, -1)),
      exit_code_(other.exit_code_),
      program_(std::move(other.program_)) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  if (this == &other) return *this;
  end();
  pid_ = std::exchange(other.pid_, -1);
  started_ = other.started_;
  ends_as_group_ = other.ends_as_group_;
  is_told_ = other.is_told_;
  watched_ = std::exchange(other.watched_, -1);
  collected_ = std::exchange(other.collected_, -1);
  exit_code_ = other.exit_code_;
  program_ = std::move(other.program_);
  return *this;
}

ChildProcess::~ChildProcess() { end(); }

bool ChildProcess::is_running() { return !wait(std::chrono::milliseconds(0)); }

// Takes note of its end, if it has ended, and ends what it has left behind in its process group.
bool ChildProcess::reap() {
  if (watched_ >= 0) return reap_watched();
  siginfo_t info{};
  if (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != pid_) return false;
  kill(-pid_, SIGKILL);  // while its number cannot belong to anybody else
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  exit_code_ = code_of(status);
  return true;
}

// Who has made it has taken note and ended what it has left behind; when that one has died, the kernel has ended both.
bool ChildProcess::reap_watched() {
  pollfd event{watched_, POLLIN, 0};
  if (poll(&event, 1, 0) <= 0) return false;
  int status = SIGKILL;
  static_cast<void>(!read(watched_, &status, sizeof status));
  close(std::exchange(watched_, -1));
  pid_ = -1;
  exit_code_ = code_of(status);
  return true;
}

// Until the process ends, the handle can be read, a signal comes or the time is up.
void ChildProcess::wait_for_event(int handle, std::chrono::milliseconds limit) const {
  const int process = watched_ >= 0 ? -1 : static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  pollfd events[2] = {{watched_ >= 0 ? watched_ : process, POLLIN, 0}, {handle, POLLIN, 0}};
  poll(events, 2, static_cast<int>(std::min<std::int64_t>(limit.count() + 1, 60'000)));
  if (process >= 0) close(process);
}

bool ChildProcess::wait(std::chrono::milliseconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (pid_ < 0 || reap()) return true;
    if (left.count() < 0) return false;
    wait_for_event(-1, left);
  }
}

Ending ChildProcess::wait_or_interrupt(std::chrono::milliseconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (pid_ < 0 || reap()) return Ending::ended;
    if (is_interrupted()) return Ending::interrupted;
    if (left.count() < 0) return Ending::timed_out;
    wait_for_event(interrupt_handle(), left);
  }
}

void ChildProcess::terminate() {
  if (pid_ > 0 && watched_ >= 0 && reap_watched()) return;  // its number may belong to another one already
  if (pid_ <= 0 || std::exchange(is_told_, true)) return;
  const pid_t whom = ends_as_group_ ? -pid_ : pid_;
  kill(whom, SIGTERM);
  kill(whom, SIGCONT);  // one that was stopped hears of it, too
}

std::string ChildProcess::how_it_ended() const {
  if (exit_code_ < 128) return "ended with exit code " + std::to_string(exit_code_);
  return "was killed by signal " + std::to_string(exit_code_ - 128) + " (" + strsignal(exit_code_ - 128) + ")";
}

std::string ChildProcess::said() const {
  std::string text;
  char buffer[4096];
  for (off_t at = 0; collected_ >= 0;) {
    const auto count = pread(collected_, buffer, sizeof buffer, at);
    if (count <= 0) break;
    text.append(buffer, static_cast<std::size_t>(count));
    at += count;
  }
  return text;
}

void ChildProcess::end() {
  if (pid_ >= 0) {
    terminate();
    if (!wait(ending_limit)) {
      kill(pid_, SIGKILL);
      wait(killing_limit);
    }
  }
  if (collected_ >= 0) close(std::exchange(collected_, -1));
}

Result<std::string> output_of(const ChildProcess& ended) {
  auto text = ended.said();
  if (ended.exit_code() == 0) return text;
  auto lines = split_list(text, '\n');
  return Error{lines.empty() ? "program " + ended.program() + ": " + ended.how_it_ended() : lines.back()};
}

Result<std::string> output_of(const ProgramCall& call, std::chrono::milliseconds limit) {
  auto started = ChildProcess::start(call);
  return started ? output_of(*started, limit) : started.error();
}

Result<std::string> output_of(ChildProcess& started, std::chrono::milliseconds limit) {
  switch (started.wait_or_interrupt(limit)) {
    case Ending::ended:
      return output_of(started);
    case Ending::interrupted:
      return Error{"interrupted"};
    case Ending::timed_out:
      break;
  }
  return Error{"program " + started.program() + ": did not end within " + std::to_string(limit.count() / 1000) + " s"};
}

ProgramCall shell_call(const std::string& line, const std::string& record, const std::string& server_id, const std::string& naming) {
  std::error_code ignored;  // without a folder of ours the path is as it was
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path().string();
  const char* path = std::getenv("PATH");
  const std::string usual = path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin";
  return {{"sh", "-c", line},
          {{"PATH", folder.empty() ? usual : folder + ":" + usual},
           {"RTMSIM_RECORD", record},
           {"RTMSIM_SERVER_ID", server_id},
           {"RTCTREE_NAMESERVERS", naming}},
          ""};
}

std::string own_program(const std::string& name) {
  std::error_code error;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  // Where packages of others may have a program of that name, ours has a name of its own too (docs/packages.md).
  for (const auto& own : {name + ".rtm-sim", name}) {
    if (const auto beside = folder / own; std::filesystem::exists(beside, error)) return beside.string();
  }
  return name;
}

}  // namespace base
