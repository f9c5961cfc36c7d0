// A library to be loaded before others (LD_PRELOAD) into a server that is not ours, as omniNames: connections over TCP from other accounts
// end before the server has read anything. base/own_account.h says where it is.
#include <dlfcn.h>
#include <sys/socket.h>

#include <cerrno>

#include "base/peer_account.h"

namespace {

// The server sees a connection that its peer has closed at once: it knows how to deal with that.
void close_to_others(int connection) {
  const int error = errno;
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  const bool is_tcp =
      getsockname(connection, reinterpret_cast<sockaddr*>(&own), &size) == 0 && (own.ss_family == AF_INET || own.ss_family == AF_INET6);
  if (is_tcp && !base::is_own_account(base::peer_account(connection))) shutdown(connection, SHUT_RDWR);
  errno = error;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" __attribute__((visibility("default"))) int accept(int socket, sockaddr* address, socklen_t* size) {
  static const auto original = next<int (*)(int, sockaddr*, socklen_t*)>("accept");
  const int connection = original(socket, address, size);
  if (connection >= 0) close_to_others(connection);
  return connection;
}

extern "C" __attribute__((visibility("default"))) int accept4(int socket, sockaddr* address, socklen_t* size, int flags) {
  static const auto original = next<int (*)(int, sockaddr*, socklen_t*, int)>("accept4");
  const int connection = original(socket, address, size, flags);
  if (connection >= 0) close_to_others(connection);
  return connection;
}
