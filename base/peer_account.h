// The account of the other end of a TCP connection within this machine, from the socket tables of the kernel. Servers on loopback use it to
// accept their own account only. Any thread; no state.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>

namespace base {

// An address in numbers ("127.0.0.1", "::1"; an IPv4 address as IPv6 shows it counts as that IPv4 address) and a port.
struct TcpEnd {
  std::string host;
  std::uint16_t port = 0;
};

// The account that opened the socket at `theirs`, which is connected with our own socket at `ours`. Nothing when no process of this machine
// (of this network namespace) holds it: it is on another host, or closed already. Some 10 us; where the kernel has no sock_diag the tables
// in /proc/net are read instead, which takes longer the more connections there are.
std::optional<uid_t> account_of(const TcpEnd& theirs, const TcpEnd& ours);
// The same by the tables alone; for tests of that way.
std::optional<uid_t> account_by_tables(const TcpEnd& theirs, const TcpEnd& ours);
// The same for the peer of a connected socket; nothing for sockets of other kinds.
std::optional<uid_t> peer_account(int socket);

// True when the peer is of this process's account, or root, which can do everything anyway.
bool is_own_account(std::optional<uid_t> account);

}  // namespace base
