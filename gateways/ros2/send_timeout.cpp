// Fast DDS sets the send timeout of a socket before each packet: a system call that has no effect, because its sockets never block (see
// participant.cpp), and takes a tenth of the time of a message of /clock. The program's definition takes precedence over that of the C
// library.
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

extern "C" int setsockopt(int socket, int level, int name, const void* value, socklen_t size) noexcept {
  if (level == SOL_SOCKET && name == SO_SNDTIMEO) return 0;
  return static_cast<int>(::syscall(SYS_setsockopt, socket, level, name, value, size));
}
