#include "name_service.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <thread>

#include "base/log.h"
#include "base/own_account.h"
#include "base/scratch_folder.h"
#include "base/text.h"

namespace {

struct Address {
  std::string host = "127.0.0.1";
  std::string port = "2809";
};

base::Result<Address> parse(const std::string& text) {
  Address address;
  const auto colon = text.rfind(':');
  const auto host = text.substr(0, colon);
  if (!host.empty() && host != "localhost") address.host = host;
  if (colon != std::string::npos) {
    const auto port = base::parse_integer(text.substr(colon + 1));
    if (!port || *port < 1 || *port > 65535) return base::Error{"name server " + base::in_quotes(text) + ": expected host:port"};
    address.port = std::to_string(*port);
  }
  return address;
}

// Asks with a GIOP 1.0 LocateRequest for the object key NameService; true when it is there.
bool is_naming_service(int socket) {
  constexpr char request[] = "GIOP\x01\x00\x01\x03\x13\x00\x00\x00\x01\x00\x00\x00\x0b\x00\x00\x00NameService";
  if (send(socket, request, sizeof request - 1, MSG_NOSIGNAL) != sizeof request - 1) return false;
  unsigned char reply[20];
  if (recv(socket, reply, sizeof reply, MSG_WAITALL) != sizeof reply) return false;
  constexpr unsigned char locate_reply = 4;
  const bool is_little_endian = (reply[6] & 1) != 0;
  const unsigned status = is_little_endian ? reply[16] : reply[19];  // 0 unknown, 1 here, 2 elsewhere
  return reply[7] == locate_reply && status != 0;
}

bool answers(const Address& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &found) != 0) return false;
  bool answered = false;
  for (const auto* at = found; at != nullptr && !answered; at = at->ai_next) {
    const int socket = ::socket(at->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (socket < 0) continue;
    const timeval timeout{1, 0};
    setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &timeout, sizeof timeout);  // also of connect
    answered = connect(socket, at->ai_addr, at->ai_addrlen) == 0 && is_naming_service(socket);
    close(socket);
  }
  freeaddrinfo(found);
  return answered;
}

constexpr const char* folder_prefix = "rtcd-names-";

// What the library in omniNames tells, until it and the keeper have gone.
void log_lines(int file) {
  std::array<char, 512> text;  // of whole lines: it writes them so, and they are short
  for (ssize_t got = 1; got > 0;) {
    got = read(file, text.data(), text.size());
    for (const auto& line : base::split_list(std::string_view(text.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))), '\n'))
      if (!line.empty()) base::log_text(base::Level::warn, "doors", line);
  }
  close(file);
}

// The keeper: a child of ours, because somebody has to remove the folder when we are killed. Signals of the terminal are not for it; it
// ends when the pipe from us closes or omniNames ends.
[[noreturn]] void keep(const Address& address, const std::string& folder, const std::string& door, int alive, int lines) {
  setpgid(0, 0);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) ::signal(number, SIG_IGN);
  const pid_t keeper = getpid();
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != keeper) _exit(127);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) ::signal(number, SIG_DFL);
    const int null = open("/dev/null", O_RDWR);
    for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(null, file);
    if (!door.empty()) setenv("LD_PRELOAD", door.c_str(), 1);
    setenv("RTMSIM_DOOR_LOG", std::to_string(fcntl(lines, F_DUPFD, STDERR_FILENO + 1)).c_str(), 1);  // this one stays open
    const auto end_point = "giop:tcp:" + address.host + ":" + address.port;
    execlp("omniNames", "omniNames", "-always", "-ignoreport", "-start", address.port.c_str(), "-datadir", folder.c_str(), "-ORBendPoint",
           end_point.c_str(), base::naming_options[0], base::naming_options[1], base::naming_options[2], base::naming_options[3],
           static_cast<char*>(nullptr));
    _exit(127);
  }
  for (bool running = child > 0; running;) {
    pollfd ends{alive, POLLIN, 0};
    constexpr int look = 500;  // [ms], at a child that ends on its own
    const int ready = poll(&ends, 1, look);
    if (ready > 0) {
      kill(child, SIGKILL);  // whatever state it is in; its data go with the folder
      waitpid(child, nullptr, 0);
      running = false;
    } else if (waitpid(child, nullptr, WNOHANG) == child) {
      running = false;
    }
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  _exit(0);
}

}  // namespace

base::Result<std::unique_ptr<NameService>> NameService::start_if_none(const std::string& text, bool is_open) {
  const auto address = parse(text);
  if (!address) return address.error();
  if (answers(*address)) return std::unique_ptr<NameService>();

  const auto door = is_open ? std::string() : base::own_account_door();
  if (!is_open && door.empty()) return base::Error{"name server: librtmsim_own_account.so is missing, which rejects other accounts"};
  auto folder = base::ScratchFolder::make(folder_prefix);
  if (!folder) return base::Error{"name server: " + folder.error().message};
  int ends[2], lines[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return base::Error{"name server: cannot create a pipe"};
  std::unique_ptr<NameService> service(new NameService);
  service->alive_ = ends[1];
  if (pipe2(lines, O_CLOEXEC) != 0) {
    close(ends[0]);
    return base::Error{"name server: cannot create a pipe"};
  }
  fcntl(lines[1], F_SETFL, O_NONBLOCK);  // a log that nobody reads keeps nobody waiting
  service->keeper_ = fork();
  if (service->keeper_ == 0) {
    close(ends[1]);
    close(lines[0]);
    keep(*address, folder->path(), door, ends[0], lines[1]);
  }
  close(ends[0]);
  close(lines[1]);
  if (service->keeper_ > 0) folder->give_away();
  service->log_ = std::thread([file = lines[0]] { log_lines(file); });

  constexpr std::chrono::seconds timeout{10};
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (std::chrono::steady_clock::now() < deadline) {
    if (answers(*address)) return service;
    if (waitpid(service->keeper_, nullptr, WNOHANG) == service->keeper_) {
      service->keeper_ = -1;
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));  // nothing tells when it is ready
  }
  return base::Error{"name server " + base::in_quotes(text) + ": omniNames does not start (is it installed, is the port free?)"};
}

NameService::~NameService() {
  if (alive_ >= 0) close(alive_);
  if (keeper_ > 0) waitpid(keeper_, nullptr, 0);
  if (log_.joinable()) log_.join();
}
