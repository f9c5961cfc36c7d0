#include "base/peer_account.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <utility>

namespace base {
namespace {

class Socket {
 public:
  explicit Socket(int value) : value_(value) {}
  Socket(Socket&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  ~Socket() { close(); }
  void close() {
    if (value_ >= 0) ::close(std::exchange(value_, -1));
  }
  int value() const { return value_; }

 private:
  int value_;
};

struct Place {
  sockaddr_storage address{};
  socklen_t size = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
};

Place place(int family, const char* host, std::uint16_t port) {
  Place place;
  if (family == AF_INET) {
    auto& v4 = reinterpret_cast<sockaddr_in&>(place.address);
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port);
    EXPECT_EQ(::inet_pton(AF_INET, host, &v4.sin_addr), 1);
    place.size = sizeof v4;
  } else {
    auto& v6 = reinterpret_cast<sockaddr_in6&>(place.address);
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(port);
    EXPECT_EQ(::inet_pton(AF_INET6, host, &v6.sin6_addr), 1);
    place.size = sizeof v6;
  }
  return place;
}

std::uint16_t port_of(int socket) {
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&bound), &size);
  return ntohs(bound.ss_family == AF_INET ? reinterpret_cast<sockaddr_in&>(bound).sin_port
                                          : reinterpret_cast<sockaddr_in6&>(bound).sin6_port);
}

Socket listening(int family, const char* host) {
  Socket socket(::socket(family, SOCK_STREAM, 0));
  const int off = 0;
  if (family == AF_INET6) ::setsockopt(socket.value(), IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
  const Place any = place(family, host, 0);
  EXPECT_EQ(::bind(socket.value(), any.get(), any.size), 0);
  EXPECT_EQ(::listen(socket.value(), 5), 0);
  return socket;
}

Socket connected(int family, const char* host, std::uint16_t port) {
  Socket socket(::socket(family, SOCK_STREAM, 0));
  const Place there = place(family, host, port);
  EXPECT_EQ(::connect(socket.value(), there.get(), there.size), 0);
  return socket;
}

TEST(PeerAccount, of_our_own_connections_is_ours_whatever_the_kind_of_address) {
  struct Case {
    int server_family, client_family;
    const char *server, *client;
  };
  for (const auto& one : {Case{AF_INET, AF_INET, "127.0.0.1", "127.0.0.1"}, Case{AF_INET6, AF_INET6, "::1", "::1"},
                          Case{AF_INET6, AF_INET, "::", "127.0.0.1"}, Case{AF_INET, AF_INET6, "127.0.0.1", "::ffff:127.0.0.1"}}) {
    const Socket server = listening(one.server_family, one.server);
    const Socket client = connected(one.client_family, one.client, port_of(server.value()));
    const Socket accepted(::accept(server.value(), nullptr, nullptr));
    EXPECT_EQ(peer_account(accepted.value()), ::geteuid()) << one.client << " at " << one.server;
    const TcpEnd theirs{one.client, port_of(client.value())}, ours{one.client, port_of(server.value())};
    EXPECT_EQ(account_of(theirs, ours), ::geteuid()) << one.client << " at " << one.server;
    EXPECT_EQ(account_by_tables(theirs, ours), ::geteuid()) << one.client << " at " << one.server;
  }
}

TEST(PeerAccount, of_a_peer_that_has_closed_is_nobodys) {
  const Socket server = listening(AF_INET, "127.0.0.1");
  Socket client = connected(AF_INET, "127.0.0.1", port_of(server.value()));
  const TcpEnd theirs{"127.0.0.1", port_of(client.value())}, ours{"127.0.0.1", port_of(server.value())};
  const Socket accepted(::accept(server.value(), nullptr, nullptr));
  EXPECT_EQ(::send(client.value(), "x", 1, 0), 1);
  client.close();
  EXPECT_EQ(peer_account(accepted.value()), std::nullopt);
  EXPECT_EQ(account_by_tables(theirs, ours), std::nullopt);
}

TEST(PeerAccount, of_what_is_no_connection_here_is_nobodys) {
  const Socket server = listening(AF_INET, "127.0.0.1");
  EXPECT_EQ(peer_account(server.value()), std::nullopt);
  EXPECT_EQ(peer_account(-1), std::nullopt);
  const std::uint16_t port = port_of(server.value());
  // Somebody listens there, but nothing is connected.
  EXPECT_EQ(account_of({"127.0.0.1", port}, {"127.0.0.1", 1}), std::nullopt);
  EXPECT_EQ(account_by_tables({"127.0.0.1", port}, {"127.0.0.1", 1}), std::nullopt);
  EXPECT_EQ(account_of({"example.org", port}, {"127.0.0.1", 1}), std::nullopt);
  EXPECT_EQ(account_of({"::1", port}, {"127.0.0.1", port}), std::nullopt);
}

TEST(PeerAccount, of_another_account_is_that_one) {
  constexpr uid_t other = 65534;
  if (::geteuid() != 0) GTEST_SKIP() << "only root can be somebody else";
  const Socket server = listening(AF_INET, "127.0.0.1");
  const std::uint16_t port = port_of(server.value());
  int go_on[2];
  ASSERT_EQ(::pipe(go_on), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(go_on[1]);
    if (::setuid(other) != 0) ::_exit(1);
    const Socket client(::socket(AF_INET, SOCK_STREAM, 0));
    const Place there = place(AF_INET, "127.0.0.1", port);
    if (::connect(client.value(), there.get(), there.size) != 0) ::_exit(1);
    char byte = 0;
    ::_exit(::read(go_on[0], &byte, 1) == 0 ? 0 : 1);  // until the parent has looked, or is gone
  }
  ::close(go_on[0]);
  const Socket accepted(::accept(server.value(), nullptr, nullptr));
  sockaddr_in from{};
  socklen_t size = sizeof from;
  EXPECT_EQ(::getpeername(accepted.value(), reinterpret_cast<sockaddr*>(&from), &size), 0);
  EXPECT_EQ(peer_account(accepted.value()), other);
  EXPECT_EQ(account_by_tables({"127.0.0.1", ntohs(from.sin_port)}, {"127.0.0.1", port}), other);
  ::close(go_on[1]);
  int status = 1;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST(PeerAccount, root_and_oneself_are_ones_own) {
  EXPECT_TRUE(is_own_account(::geteuid()));
  EXPECT_TRUE(is_own_account(0));
  EXPECT_FALSE(is_own_account(::geteuid() + 1));
  EXPECT_FALSE(is_own_account(std::nullopt));
}

}  // namespace
}  // namespace base
