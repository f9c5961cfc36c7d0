#include "base/packet.h"

#include <sys/socket.h>

#include <cassert>
#include <cerrno>
#include <cstring>

namespace base {

bool send_packet(int socket, std::span<const std::byte> bytes, std::span<const int> files, int flags) {
  assert(files.size() <= max_files_in_packet);
  iovec part{const_cast<std::byte*>(bytes.data()), bytes.size()};
  alignas(cmsghdr) char control[CMSG_SPACE(max_files_in_packet * sizeof(int))] = {};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  if (!files.empty()) {
    message.msg_control = control;
    message.msg_controllen = CMSG_SPACE(files.size_bytes());
    cmsghdr* head = CMSG_FIRSTHDR(&message);
    head->cmsg_level = SOL_SOCKET;
    head->cmsg_type = SCM_RIGHTS;
    head->cmsg_len = CMSG_LEN(files.size_bytes());
    std::memcpy(CMSG_DATA(head), files.data(), files.size_bytes());
  }
  ssize_t count = 0;
  do count = ::sendmsg(socket, &message, MSG_NOSIGNAL | flags);
  while (count < 0 && errno == EINTR);
  return count == static_cast<ssize_t>(bytes.size());
}

std::optional<ReceivedPacket> receive_packet(int socket, std::span<std::byte> space, int flags) {
  iovec part{space.data(), space.size()};
  alignas(cmsghdr) char control[CMSG_SPACE(max_files_in_packet * sizeof(int))] = {};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  ssize_t count = 0;
  do count = ::recvmsg(socket, &message, MSG_CMSG_CLOEXEC | flags);
  while (count < 0 && errno == EINTR);
  ReceivedPacket packet;
  for (cmsghdr* head = CMSG_FIRSTHDR(&message); count >= 0 && head != nullptr; head = CMSG_NXTHDR(&message, head)) {
    if (head->cmsg_level != SOL_SOCKET || head->cmsg_type != SCM_RIGHTS) continue;
    for (std::size_t at = CMSG_LEN(0); at + sizeof(int) <= head->cmsg_len; at += sizeof(int)) {
      int file = -1;
      std::memcpy(&file, reinterpret_cast<const char*>(head) + at, sizeof file);
      packet.files.emplace_back(file);
    }
  }
  if (count <= 0) return std::nullopt;
  packet.size = static_cast<std::size_t>(count);
  return packet;
}

}  // namespace base
