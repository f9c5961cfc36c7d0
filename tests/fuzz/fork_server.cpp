#include "fuzz/fork_server.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "asset-reader/serve.h"
#include "base/packet.h"
#include "fuzz/memory_budget.h"
#include "reader/protocol.h"

namespace fuzz {
namespace {

[[noreturn]] void be_reader(int socket, std::size_t memory) {
  ::dup2(socket, sim::reader_socket);
  ::close_range(sim::reader_socket + 1, ~0U, 0);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO}) {
    const int nothing = ::open("/dev/null", standard == STDIN_FILENO ? O_RDONLY : O_WRONLY);
    ::dup2(nothing, standard);
    if (nothing > sim::reader_socket) ::close(nothing);
  }
  limit_memory(memory);
  ::_exit(sim::serve_assets());
}

[[noreturn]] void serve(int control, std::size_t memory) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  auto* reader = static_cast<pid_t*>(::mmap(nullptr, sizeof(pid_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  for (std::byte space{}; reader != MAP_FAILED;) {
    const auto packet = base::receive_packet(control, std::span(&space, 1));
    if (!packet || packet->files.empty()) break;
    *reader = -1;
    const pid_t between = ::fork();
    if (between == 0) {
      const pid_t pid = ::fork();
      if (pid == 0) be_reader(packet->files.front().get(), memory);
      *reader = pid;
      ::_exit(0);
    }
    while (between > 0 && ::waitpid(between, nullptr, 0) < 0 && errno == EINTR) {
    }
    if (::send(control, reader, sizeof *reader, MSG_NOSIGNAL) != sizeof *reader) break;
  }
  ::_exit(0);
}

}  // namespace

ForkServer::ForkServer(std::size_t memory) {
  int ends[2] = {-1, -1};
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return;
  server_ = ::fork();
  if (server_ == 0) {
    ::close(ends[0]);  // else it would never see the end
    serve(ends[1], memory);
  }
  ::close(ends[1]);
  control_ = ends[0];
}

ForkServer::~ForkServer() {
  ::close(control_);
  if (server_ > 0) ::waitpid(server_, nullptr, 0);
}

base::Result<pid_t> ForkServer::start(int socket) {
  pid_t pid = -1;
  constexpr std::byte start{};
  if (!base::send_packet(control_, std::span(&start, 1), std::span(&socket, 1)) || ::recv(control_, &pid, sizeof pid, 0) != sizeof pid ||
      pid <= 0)
    return base::Error{"the fork server starts no reader: " + std::generic_category().message(errno)};
  return pid;
}

}  // namespace fuzz
