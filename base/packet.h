// Packets over a local socket of type SOCK_SEQPACKET that carry file descriptors. Any thread; no state.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "base/file_handle.h"

namespace base {

inline constexpr std::size_t max_files_in_packet = 4;

// Sends one packet with up to max_files_in_packet descriptors, which the caller still owns. `flags`: of sendmsg, which never raises
// SIGPIPE. False: it was not sent whole; errno says why.
bool send_packet(int socket, std::span<const std::byte> bytes, std::span<const int> files, int flags = 0);

struct ReceivedPacket {
  std::size_t size = 0;
  std::vector<FileHandle> files;  // closed on exec. The kernel closes those beyond the limit
};
// Into `space`; what does not fit is lost. `flags` of recvmsg. Nothing: the other end is closed, or no packet can be read (errno).
std::optional<ReceivedPacket> receive_packet(int socket, std::span<std::byte> space, int flags = 0);

}  // namespace base
