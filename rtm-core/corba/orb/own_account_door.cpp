// A library to be loaded before others (LD_PRELOAD) into a server that is not ours, as omniNames: connections over TCP from other accounts
// end before the server has read anything, when there are too many the one that has been silent longest ends, and what comes in is handed
// on in whole GIOP messages (giop_gate.h): of fragments that it does not expect omniORB 4.2 keeps threads and connections for ever, which
// take all processors. base/own_account.h says where the library is. Who was rejected is told in lines to the file whose number is in
// RTMSIM_DOOR_LOG, to standard error without it; one a second at most.
#include <dlfcn.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "base/descriptors.h"
#include "base/guarded.h"
#include "base/peer_account.h"
#include "corba/orb/giop_gate.h"

namespace {

constexpr std::size_t max_threads = 2000;   // each connection has one
constexpr std::size_t reserved_files = 64;  // for what is no connection, and for those that are leaving

// So many at a time.
int max_connections() {
  static const int most = [] {
    const std::size_t allowed = base::raise_descriptor_limit();
    return static_cast<int>(std::clamp<std::size_t>(allowed > 2 * reserved_files ? allowed - reserved_files : allowed / 2, 8, max_threads));
  }();
  return most;
}

// The port of this end in network order; 0 for what is no TCP connection.
in_port_t own_port(int file) {
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  if (getsockname(file, reinterpret_cast<sockaddr*>(&own), &size) != 0) return 0;
  if (own.ss_family == AF_INET) return reinterpret_cast<const sockaddr_in&>(own).sin_port;
  return own.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(own).sin6_port : in_port_t{0};
}

// When there are too many connections to the port that `latest` has come to. Callers that still want something connect again. One thread at
// a time: the one that accepts.
void end_most_silent(int latest) {
  static int highest = 0;  // of all files that were connections; new files have the lowest number that is free
  highest = std::max(highest, latest);
  if (highest < max_connections()) return;
  const in_port_t port = own_port(latest);
  int count = 0, silent = -1;
  unsigned longest = 0;  // [ms]
  for (int file = 3; file <= highest; ++file) {
    tcp_info info{};
    socklen_t size = sizeof info;
    if (getsockopt(file, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 || info.tcpi_state != TCP_ESTABLISHED || own_port(file) != port)
      continue;
    ++count;
    if (file == latest || (silent >= 0 && info.tcpi_last_data_recv <= longest)) continue;
    silent = file;
    longest = info.tcpi_last_data_recv;
  }
  if (silent < 0 || count <= max_connections()) return;
  shutdown(silent, SHUT_RDWR);
  // Its thread closes it, which nobody announces. Without the wait new ones would come faster than old ones go, until there are no files
  // left.
  for (int waited = 0; waited < 200 && fcntl(silent, F_GETFD) != -1; ++waited) usleep(1000);
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

// Connections by their files, from when they come until they are closed: then the number is another file's.
class Gates {
 public:
  using Gate = std::shared_ptr<corba::GiopGate>;
  // False: there is no memory.
  bool begin(int file) try {
    auto gate = std::make_shared<corba::GiopGate>(limits(), in_progress_);
    (*gates_.lock())[file] = std::move(gate);
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
  void end(int file) { gates_.lock()->erase(file); }
  Gate of(int file) {
    auto gates = gates_.lock();
    const auto found = gates->find(file);
    return found == gates->end() ? nullptr : found->second;
  }

 private:
  static corba::GiopLimits limits() {
    corba::GiopLimits limits;
    limits.sample = limits.request;
    limits.direct = 0;  // no data port is here, whose samples would pass while they come
    limits.reads_ahead = false;
    return limits;
  }
  base::Guarded<std::map<int, Gate>, base::Rank::peers> gates_;
  std::atomic<std::size_t> in_progress_{0};
};

// Never destroyed: threads may still read at the very end.
Gates& gates() {
  static Gates& all = *new Gates;
  return all;
}

constexpr std::chrono::seconds longest_silence{30};  // within a message

ssize_t receive(int file, void* to, std::size_t size, int flags) {
  static const auto original = next<ssize_t (*)(int, void*, size_t, int)>("recv");
  return original(file, to, size, flags);
}

// Octets of a connection; 0 or less when there will be no more: of a message that has begun the next ones come within a time, whatever the
// socket does.
int read_from(int file, std::byte* to, std::size_t size, int flags, bool is_in_message) {
  if (!is_in_message) return static_cast<int>(receive(file, to, size, flags));
  const auto end = std::chrono::steady_clock::now() + longest_silence;
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0) return 0;
    pollfd waiting{file, POLLIN, 0};
    if (poll(&waiting, 1, static_cast<int>(left.count())) <= 0) continue;
    const auto got = receive(file, to, size, flags);
    if (got >= 0 || (errno != EINTR && errno != EAGAIN)) return static_cast<int>(got);
  }
}

// What the server reads of a connection with a gate. -1 with ECONNRESET when the gate ends it.
int read_through(corba::GiopGate& gate, int file, std::byte* to, std::size_t size, int flags) {
  bool has_asked = false;
  int got = -1;
  try {
    got = gate.receive(to, size, [&](std::byte* at, std::size_t room) {
      has_asked = true;
      return read_from(file, at, room, flags, gate.is_in_message());
    });
  } catch (const std::exception&) {  // no memory
    has_asked = false;
  }
  if (got < 0 && (!has_asked || !gate.problem().empty())) {
    shutdown(file, SHUT_RDWR);
    errno = ECONNRESET;
  }
  return got;
}

int log_file() {
  static const int file = [] {
    const char* text = getenv("RTMSIM_DOOR_LOG");
    return text == nullptr ? STDERR_FILENO : atoi(text);
  }();
  return file;
}

// One thread at a time: the one that accepts. A log that takes no more loses the line.
void tell_refused(std::optional<uid_t> account) {
  static std::optional<std::chrono::steady_clock::time_point> last;
  static std::size_t others = 0;
  const auto now = std::chrono::steady_clock::now();
  if (last && now - *last < std::chrono::seconds(1)) {
    ++others;
    return;
  }
  last = now;
  std::string line = "name server: " + (account ? "account " + std::to_string(*account) : std::string("another host or account")) +
                     " rejected: it serves account " + std::to_string(geteuid()) + " alone";
  if (const auto missed = std::exchange(others, 0); missed > 0) line += "; so were " + std::to_string(missed) + " others";
  line += '\n';
  pollfd room{log_file(), POLLOUT, 0};
  if (poll(&room, 1, 0) > 0) (void)!write(log_file(), line.data(), line.size());
}

// What the server gets of a connection that has come: nothing of one from another account, as if nobody had come after all.
int let_in(int connection) {
  const int error = errno;
  if (connection < 0) return connection;
  const auto refuse = [connection] {
    close(connection);
    errno = EAGAIN;
    return -1;
  };
  if (own_port(connection) != 0) {
    if (const auto account = base::peer_account(connection); !base::is_own_account(account)) {
      tell_refused(account);
      return refuse();
    }
    end_most_silent(connection);
    if (!gates().begin(connection)) return refuse();
  }
  errno = error;
  return connection;
}

[[gnu::constructor]] void raise_limit() { (void)max_connections(); }

}  // namespace

extern "C" __attribute__((visibility("default"))) int accept(int socket, sockaddr* address, socklen_t* size) {
  static const auto original = next<int (*)(int, sockaddr*, socklen_t*)>("accept");
  return let_in(original(socket, address, size));
}

extern "C" __attribute__((visibility("default"))) int accept4(int socket, sockaddr* address, socklen_t* size, int flags) {
  static const auto original = next<int (*)(int, sockaddr*, socklen_t*, int)>("accept4");
  return let_in(original(socket, address, size, flags));
}

extern "C" __attribute__((visibility("default"))) ssize_t recv(int socket, void* to, size_t size, int flags) {
  const auto gate = gates().of(socket);
  if (!gate || (flags & MSG_PEEK) != 0 || size == 0) return receive(socket, to, size, flags);
  return read_through(*gate, socket, static_cast<std::byte*>(to), size, flags);
}

extern "C" __attribute__((visibility("default"))) int close(int file) {
  static const auto original = next<int (*)(int)>("close");
  gates().end(file);
  return original(file);
}
