#include "recording/recorder_line.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>

namespace recorder {

using base::Error;
using base::Result;

Result<std::pair<RecorderLine, base::FileHandle>> RecorderLine::make() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return Error{std::string("recorder: no line to it: ") + std::strerror(errno)};
  return std::pair(RecorderLine(base::FileHandle(ends[0])), base::FileHandle(ends[1]));
}

Result<void> RecorderLine::send(RecorderMessage message) {
  const auto octet = static_cast<unsigned char>(message);
  // A reader that is stopped lets a handful of packets of one byte wait; none is ever waited for.
  if (::send(end_.get(), &octet, 1, MSG_NOSIGNAL | MSG_DONTWAIT) == 1) return {};
  return Error{std::string("recorder: cannot receive messages: ") + std::strerror(errno)};
}

Result<std::optional<RecorderMessage>> RecorderLine::receive(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    pollfd event{end_.get(), POLLIN, 0};
    const int ready = ::poll(&event, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return std::optional<RecorderMessage>();
    unsigned char octet = 0;
    const auto size = ::recv(end_.get(), &octet, 1, MSG_DONTWAIT);
    if (size < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (size != 1) return Error{"the other side has closed the line"};
    constexpr auto last = static_cast<unsigned char>(RecorderMessage::hashes_ready);
    if (octet == 0 || octet > last) return Error{"the other side sends what is no message: " + std::to_string(octet)};
    return std::optional(static_cast<RecorderMessage>(octet));
  }
}

}  // namespace recorder
