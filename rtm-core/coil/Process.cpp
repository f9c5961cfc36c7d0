#include "coil/Process.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>

namespace coil {

int launch_shell(const std::string& command) {
  // In the background of a shell that ends at once, so that nobody has to wait for the command to keep it from becoming a zombie.
  const std::string in_background = "( " + command + "\n) &";
  const char* const argv[] = {"sh", "-c", in_background.c_str(), nullptr};
  pid_t pid = 0;
  if (::posix_spawn(&pid, "/bin/sh", nullptr, nullptr, const_cast<char* const*>(argv), environ) != 0) return -1;
  int status = 0;
  return ::waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 0 : -1;
}

int create_process(const std::string& command, std::vector<std::string>& out) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return -1;
  std::string line;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
    if (c != '\n') {
      line += static_cast<char>(c);
      continue;
    }
    out.push_back(std::move(line));
    line.clear();
  }
  if (!line.empty()) out.push_back(std::move(line));
  return ::pclose(pipe) == 0 ? 0 : -1;
}

int daemonize() { return ::daemon(0, 0); }

}  // namespace coil
