#include "run/run_naming.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

#include "base/own_account.h"
#include "run/stopped_process.h"
#include "system/remote.h"

namespace tools {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto silence_limit = 8s;  // much more than a busy machine needs for a small answer
constexpr auto ask_limit = 4s;

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

Result<void> answers(CORBA::ORB_ptr orb, const std::string& server, std::chrono::milliseconds limit) {
  const CallLimit limited(limit);
  return remote("name server " + server, [&] {
    const CORBA::Object_var object = orb->string_to_object(("corbaloc::" + server + "/NameService").c_str());
    (void)object->_non_existent();
  });
}

}  // namespace

Result<void> RunNaming::start(CORBA::ORB_ptr orb, const RunSimulator::Wait& wait_until) {
  const int port = free_port();
  if (port == 0) return Error{"no free port on 127.0.0.1"};
  orb_ = CORBA::ORB::_duplicate(orb);
  address_ = "127.0.0.1:" + std::to_string(port);
  auto started =
      base::ChildProcess::start({{"omniNames", "-start", std::to_string(port), "-datadir", place_.scratch("names"), "-errlog",
                                  place_.new_file("omninames.err"), "-ORBendPoint", "giop:tcp:" + address_, base::naming_options[0],
                                  base::naming_options[1], base::naming_options[2], base::naming_options[3]},
                                 {{"LD_PRELOAD", base::own_account_door()}},
                                 place_.new_file("omninames.log")});
  if (!started) return started.error();
  process_.emplace(std::move(*started));
  return wait_until("name server", [&] { return answers(orb_, address_, 1000ms).ok(); });
}

void RunNaming::end() {
  if (process_ && !ask()) kill(process_->pid(), SIGKILL);
  process_.reset();
}

void RunNaming::set_running(bool is_to_run) {
  if (!process_ || is_stopped_ == !is_to_run) return;
  kill(process_->pid(), is_to_run ? SIGCONT : SIGSTOP);
  is_stopped_ = !is_to_run;
  is_silent_ = false;
  silent_since_.reset();
}

void RunNaming::answered(bool has_answered) {
  if (has_answered) {
    silent_since_.reset();
  } else if (!silent_since_) {
    silent_since_ = Clock::now();
  }
}

Result<void> RunNaming::check() {
  if (!process_) return {};
  if (!process_->is_running()) return Error{"omniNames " + process_->how_it_ended() + ": " + telling_line(place_.file("omninames.log"))};
  if (silent_since_ && !is_stopped_ && Clock::now() - *silent_since_ > silence_limit) return silence();
  return has_been_stopped() ? Result<void>(silence()) : Result<void>();
}

// For as long as anything else of the run may hang.
bool RunNaming::has_been_stopped() {
  if (is_stopped_ || !is_stopped(process_->pid())) {
    stopped_since_.reset();
    return false;
  }
  if (!stopped_since_) stopped_since_ = Clock::now();
  return Clock::now() - *stopped_since_ > std::min<std::chrono::duration<double>>(hang_timeout_, silence_limit);
}

Result<void> RunNaming::ask() {
  if (!process_ || !process_->is_running() || is_stopped_) return {};
  if (!is_silent_ && answers(orb_, address_, ask_limit)) return {};
  is_silent_ = true;  // one wait is enough
  return silence();
}

Error RunNaming::silence() const {
  return {"name server " + address_ + " (omniNames, pid " + std::to_string(process_->pid()) + "): does not answer (hung, or stopped?)"};
}

}  // namespace tools
