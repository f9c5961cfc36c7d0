#include "child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/id.h"
#include "base/text.h"

namespace editor {
namespace {

using base::Error;
using base::Result;

constexpr std::chrono::milliseconds ending_limit{5000};

int code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

// Between fork and exec only what is safe there: everything is made before.
[[noreturn]] void become(char* const* words, char* const* environment, int output, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);  // the parent died before the line above
  setpgid(0, 0);                        // an interrupt from the terminal is ours to hand on
  const int null = open("/dev/null", O_RDONLY);
  dup2(null, 0);
  dup2(output, 1);
  dup2(output, 2);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execvpe(words[0], words, environment);
  const char* text = "cannot be started\n";
  static_cast<void>(!write(2, text, std::strlen(text)));
  _exit(127);
}

}  // namespace

Result<ChildProcess> ChildProcess::start(const ProgramCall& call) {
  const auto file = call.output.empty() ? "/dev/null" : call.output.c_str();
  const int output = open(file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (output < 0) return Error{"program " + call.words[0] + ": its output file " + base::in_quotes(file) + " cannot be written"};
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
  if (child == 0) become(words.data(), environment.data(), output, parent);
  close(output);
  if (child < 0) return Error{"program " + call.words[0] + ": no process can be made"};
  return ChildProcess(child, std::filesystem::path(call.words[0]).filename().string());
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), exit_code_(other.exit_code_), program_(std::move(other.program_)) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  if (this == &other) return *this;
  end();
  pid_ = std::exchange(other.pid_, -1);
  exit_code_ = other.exit_code_;
  program_ = std::move(other.program_);
  return *this;
}

ChildProcess::~ChildProcess() { end(); }

bool ChildProcess::is_running() { return !wait(std::chrono::milliseconds(0)); }

bool ChildProcess::wait(std::chrono::milliseconds limit) {
  if (pid_ < 0) return true;
  const int handle = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  if (handle >= 0) {
    pollfd ended{handle, POLLIN, 0};
    poll(&ended, 1, static_cast<int>(limit.count()));
    close(handle);
  }
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return false;
  pid_ = -1;
  exit_code_ = code_of(status);
  return true;
}

void ChildProcess::terminate() {
  if (pid_ > 0) kill(pid_, SIGTERM);
}

void ChildProcess::end() {
  if (pid_ < 0) return;
  terminate();
  if (wait(ending_limit)) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

Result<std::string> output_of(const ProgramCall& call, std::chrono::milliseconds limit) {
  const auto file = std::filesystem::temp_directory_path() / ("rtse-" + base::make_uuid());
  auto with_file = call;
  with_file.output = file.string();
  auto started = ChildProcess::start(with_file);
  if (!started) return started.error();
  const bool ended = started->wait(limit);
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  std::filesystem::remove(file);
  if (!ended) return Error{"program " + started->program() + ": did not end within " + std::to_string(limit.count() / 1000) + " s"};
  if (started->exit_code() == 0) return text.str();
  auto last = base::split_list(text.str(), '\n');
  return Error{last.empty() ? "program " + started->program() + ": failed with exit code " + std::to_string(started->exit_code())
                            : last.back()};
}

std::string own_program(const std::string& name) {
  std::error_code error;
  const auto beside = std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / name;
  return std::filesystem::exists(beside, error) ? beside.string() : name;
}

}  // namespace editor
