// A child process of a test: started with its output collected, killed and reaped by the destructor, and by the kernel when the test dies.
// One thread at a time.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace support {

// What a watchdog grants: far more than anything takes, also on a loaded machine or under a sanitizer.
inline constexpr std::chrono::seconds watchdog{60};

class Process {
 public:
  // arguments[0] is the program, looked for in PATH when it has no slash. `environment`: NAME=value, added to the test's own.
  // stdout and stderr are collected together.
  explicit Process(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {},
                   const std::string& folder = {}) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
    std::vector<char*> argv;
    for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    std::vector<std::string> all = environment;
    for (char** entry = environ; *entry != nullptr; ++entry) {
      const std::string_view text(*entry);
      const auto name = text.substr(0, text.find('=') + 1);
      bool replaced = false;
      for (const auto& added : environment) replaced = replaced || added.starts_with(name);
      if (!replaced) all.emplace_back(text);
    }
    std::vector<char*> envp;
    for (const auto& entry : all) envp.push_back(const_cast<char*>(entry.c_str()));
    envp.push_back(nullptr);
    const pid_t parent = getpid();
    pid_ = fork();
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != parent) _exit(127);
      sigset_t none;
      sigemptyset(&none);
      sigprocmask(SIG_SETMASK, &none, nullptr);
      dup2(ends[1], STDOUT_FILENO);
      dup2(ends[1], STDERR_FILENO);
      const int null = open("/dev/null", O_RDONLY);
      dup2(null, STDIN_FILENO);
      if (!folder.empty() && chdir(folder.c_str()) != 0) _exit(127);
      execvpe(argv[0], argv.data(), envp.data());
      _exit(127);
    }
    close(ends[1]);
    reader_ = std::thread([this, from = ends[0]] { read_all(from); });
  }

  ~Process() {
    kill();
    reader_.join();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const {
    if (!status_) ::kill(pid_, number);
  }
  bool running() { return !poll_status(); }

  // The exit code, 128 + n for signal n; nothing if it still runs when the time is over.
  std::optional<int> wait(std::chrono::milliseconds timeout = watchdog) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (!poll_status() && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return status_;
  }

  // SIGKILL; waits until it is gone.
  void kill() {
    if (poll_status()) return;
    ::kill(pid_, SIGKILL);
    ::kill(pid_, SIGCONT);
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    status_ = 128 + SIGKILL;
  }

  // SIGTERM, then the exit code; SIGKILL after the watchdog time.
  std::optional<int> stop() {
    signal(SIGTERM);
    const auto status = wait();
    if (!status) kill();
    return status;
  }

  // All of it when the process has ended (unless children of it keep the pipe open).
  std::string output() const {
    std::unique_lock lock(mutex_);
    if (status_) changed_.wait_for(lock, std::chrono::seconds(1), [&] { return closed_; });
    return output_;
  }

  // True as soon as the output contains the text; false when the process's output ends or the time is over before that.
  bool wait_for_output(std::string_view text, std::chrono::milliseconds timeout = watchdog) {
    std::unique_lock lock(mutex_);
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    changed_.wait_until(lock, deadline, [&] { return closed_ || output_.find(text) != std::string::npos; });
    return output_.find(text) != std::string::npos;
  }

 private:
  bool poll_status() {
    int status = 0;
    if (!status_ && waitpid(pid_, &status, WNOHANG) == pid_) {
      status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    return status_.has_value();
  }

  void read_all(int from) {
    char buffer[4096];
    for (;;) {
      const auto size = read(from, buffer, sizeof buffer);
      if (size < 0 && errno == EINTR) continue;
      const std::scoped_lock lock(mutex_);
      if (size <= 0) {
        closed_ = true;
        break;
      }
      output_.append(buffer, static_cast<std::size_t>(size));
      changed_.notify_all();
    }
    changed_.notify_all();
    close(from);
  }

  pid_t pid_ = -1;
  std::optional<int> status_;
  std::thread reader_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::string output_;
  bool closed_ = false;
};

}  // namespace support
