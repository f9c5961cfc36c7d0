#include "base/peer_account.h"

#include <arpa/inet.h>
#include <linux/inet_diag.h>
#include <linux/netlink.h>
#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>

#include "base/file_handle.h"
#include "base/guarded.h"

namespace base {
namespace {

// An address in the order of the network; IPv4 uses the first word.
struct End {
  std::array<std::uint32_t, 4> address{};
  std::uint16_t port = 0;  // in the order of the network
  int family = AF_UNSPEC;
};

bool is_mapped(const in6_addr& address) { return IN6_IS_ADDR_V4MAPPED(&address); }

End end_of(const in_addr& address, std::uint16_t port) { return {{address.s_addr}, port, AF_INET}; }

End end_of(const in6_addr& address, std::uint16_t port) {
  End end{{}, port, AF_INET6};
  std::memcpy(end.address.data(), &address, sizeof address);
  if (is_mapped(address)) end = {{end.address[3]}, port, AF_INET};
  return end;
}

std::optional<End> parse(const TcpEnd& text) {
  in_addr v4;
  in6_addr v6;
  const std::string host = text.host.substr(0, text.host.find('%'));
  if (::inet_pton(AF_INET, host.c_str(), &v4) == 1) return end_of(v4, htons(text.port));
  if (::inet_pton(AF_INET6, host.c_str(), &v6) == 1) return end_of(v6, htons(text.port));
  return std::nullopt;
}

std::optional<End> end_of(const sockaddr_storage& address) {
  if (address.ss_family == AF_INET) {
    const auto& v4 = reinterpret_cast<const sockaddr_in&>(address);
    return end_of(v4.sin_addr, v4.sin_port);
  }
  if (address.ss_family == AF_INET6) {
    const auto& v6 = reinterpret_cast<const sockaddr_in6&>(address);
    return end_of(v6.sin6_addr, v6.sin6_port);
  }
  return std::nullopt;
}

// A socket that no process holds any more is shown with inode 0, and as root's in some kernels.
std::optional<uid_t> owner(uid_t account, std::uint64_t inode) { return inode != 0 ? std::optional(account) : std::nullopt; }

// ---- sock_diag: one question, one answer ----

struct Found {
  bool is_there = false;
  std::optional<uid_t> account;
};

bool is_question_sent(int netlink, const End& local, const End& remote) {
  struct {
    nlmsghdr head;
    inet_diag_req_v2 body;
  } question{};
  question.head.nlmsg_len = sizeof question;
  question.head.nlmsg_type = SOCK_DIAG_BY_FAMILY;
  question.head.nlmsg_flags = NLM_F_REQUEST;
  question.body.sdiag_family = static_cast<__u8>(local.family);
  question.body.sdiag_protocol = IPPROTO_TCP;
  question.body.idiag_states = ~0U;
  question.body.id.idiag_sport = local.port;
  question.body.id.idiag_dport = remote.port;
  std::memcpy(question.body.id.idiag_src, local.address.data(), sizeof question.body.id.idiag_src);
  std::memcpy(question.body.id.idiag_dst, remote.address.data(), sizeof question.body.id.idiag_dst);
  question.body.id.idiag_cookie[0] = question.body.id.idiag_cookie[1] = INET_DIAG_NOCOOKIE;
  return ::send(netlink, &question, sizeof question, 0) == static_cast<ssize_t>(sizeof question);
}

Found ask_kernel(int netlink, const End& local, const End& remote) {
  if (!is_question_sent(netlink, local, remote)) return {};
  alignas(nlmsghdr) std::array<char, 4096> answer;
  // The answer is there when the question has been taken.
  const ssize_t size = ::recv(netlink, answer.data(), answer.size(), MSG_DONTWAIT);
  const auto* head = reinterpret_cast<const nlmsghdr*>(answer.data());
  if (size < static_cast<ssize_t>(NLMSG_LENGTH(sizeof(inet_diag_msg))) || head->nlmsg_type != SOCK_DIAG_BY_FAMILY) return {};
  const auto* body = static_cast<const inet_diag_msg*>(NLMSG_DATA(head));
  // Where nothing is connected, the one that listens is shown.
  if (body->id.idiag_sport != local.port || body->id.idiag_dport != remote.port) return {};
  return {true, owner(body->idiag_uid, body->idiag_inode)};
}

// ---- the tables in /proc/net ----

std::string in_table(const End& end, bool is_v6) {
  const auto mapped = std::array<std::uint32_t, 4>{0, 0, htonl(0xffff), end.address[0]};
  const auto& words = is_v6 && end.family == AF_INET ? mapped : end.address;
  char text[48];
  std::string all;
  for (std::size_t i = 0; i < (is_v6 ? 4U : 1U); ++i) {
    std::snprintf(text, sizeof text, "%08X", words[i]);
    all += text;
  }
  std::snprintf(text, sizeof text, ":%04X", ntohs(end.port));
  return all + text;
}

std::optional<uid_t> look_up(const char* table, bool is_v6, const End& local, const End& remote) {
  std::ifstream file(table);
  const std::string wanted = " " + in_table(local, is_v6) + " " + in_table(remote, is_v6) + " ";
  for (std::string line; std::getline(file, line);) {
    const auto at = line.find(wanted);
    if (at == std::string::npos) continue;
    std::istringstream rest(line.substr(at + wanted.size()));
    std::string state, queues, timer, retransmits, timeout;
    uid_t account = 0;
    std::uint64_t inode = 0;
    if (rest >> state >> queues >> timer >> retransmits >> account >> timeout >> inode) return owner(account, inode);
  }
  return std::nullopt;
}

std::optional<uid_t> look_up(const End& local, const End& remote) {
  if (local.family == AF_INET) {
    if (const auto found = look_up("/proc/net/tcp", false, local, remote)) return found;
  }
  return look_up("/proc/net/tcp6", true, local, remote);
}

std::optional<uid_t> account_of(const End& theirs, const End& ours) {
  expect_no_data_held();
  if (theirs.family != ours.family) return std::nullopt;
  const FileHandle netlink(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_SOCK_DIAG));
  if (netlink.get() >= 0) {
    if (const Found found = ask_kernel(netlink.get(), theirs, ours); found.is_there) return found.account;
    // A kernel that can be asked at all knows our own end: then the other one is not here.
    if (ask_kernel(netlink.get(), ours, theirs).is_there) return std::nullopt;
  }
  return look_up(theirs, ours);
}

}  // namespace

std::optional<uid_t> account_of(const TcpEnd& theirs, const TcpEnd& ours) {
  const auto their_end = parse(theirs), our_end = parse(ours);
  return their_end && our_end ? account_of(*their_end, *our_end) : std::nullopt;
}

std::optional<uid_t> account_by_tables(const TcpEnd& theirs, const TcpEnd& ours) {
  const auto their_end = parse(theirs), our_end = parse(ours);
  return their_end && our_end && their_end->family == our_end->family ? look_up(*their_end, *our_end) : std::nullopt;
}

std::optional<uid_t> peer_account(int socket) {
  sockaddr_storage peer{}, own{};
  socklen_t peer_size = sizeof peer, own_size = sizeof own;
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&peer), &peer_size) != 0 ||
      ::getsockname(socket, reinterpret_cast<sockaddr*>(&own), &own_size) != 0)
    return std::nullopt;
  const auto theirs = end_of(peer), ours = end_of(own);
  return theirs && ours ? account_of(*theirs, *ours) : std::nullopt;
}

bool is_own_account(std::optional<uid_t> account) { return account && (*account == ::geteuid() || *account == 0); }

}  // namespace base
