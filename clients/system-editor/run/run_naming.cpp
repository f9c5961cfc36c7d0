#include "run/run_naming.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>

#include "base/own_account.h"
#include "naming_tree.h"

namespace editor {
namespace {

constexpr std::chrono::milliseconds call_limit{1000};

// A port of the loopback that nobody listens on just now.
int free_port() {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  int port = 0;
  if (bind(listener, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
      getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) == 0)
    port = ntohs(address.sin_port);
  close(listener);
  return port;
}

}  // namespace

Result<void> RunNaming::start(CORBA::ORB_ptr orb, const RunSimulator::Wait& wait_until) {
  const int port = free_port();
  if (port == 0) return Error{"no free port on 127.0.0.1"};
  address_ = "127.0.0.1:" + std::to_string(port);
  auto started = ChildProcess::start({{"omniNames", "-start", std::to_string(port), "-datadir", place_.scratch("names"), "-errlog",
                                       place_.new_file("omninames.err"), "-ORBendPoint", "giop:tcp:127.0.0.1:" + std::to_string(port)},
                                      {{"LD_PRELOAD", base::own_account_door()}},
                                      place_.new_file("omninames.log")});
  if (!started) return started.error();
  process_.emplace(std::move(*started));
  return wait_until("naming service", [&] { return NamingTree::read(orb, address_, call_limit).ok(); });
}

Result<void> RunNaming::check() {
  if (!process_ || process_->is_running()) return {};
  return Error{"omniNames " + process_->how_it_ended() + ": " + telling_line(place_.file("omninames.log"))};
}

void RunNaming::set_running(bool is_to_run) const {
  if (process_) kill(process_->pid(), is_to_run ? SIGCONT : SIGSTOP);
}

}  // namespace editor
