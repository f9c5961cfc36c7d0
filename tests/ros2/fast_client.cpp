// Calls a service of ROS 2 once in the form of rmw_fastrtps: fast_client DOMAIN SERVICE REQUEST_TYPE RESPONSE_TYPE HEX. Prints the reply as
// hexadecimal digits, with the CDR head. The request and the reply are plain messages, related by the identities of DDS samples.
#include <poll.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "dds/participant.h"
#include "names.h"

namespace {

constexpr std::chrono::seconds call_timeout{30};

template <class Done>
bool deliver_until(ros2::Participant& participant, Done done) {
  const auto end = std::chrono::steady_clock::now() + call_timeout;
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    pollfd waits{participant.descriptor(), POLLIN, 0};
    ::poll(&waits, 1, 100);
    participant.deliver();
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    const bool is_asked = argc == 2 && std::strcmp(argv[1], "--help") == 0;
    std::fprintf(is_asked ? stdout : stderr,
                 "usage: ros2_fast_client DOMAIN SERVICE REQUEST_TYPE RESPONSE_TYPE HEX    call a service once\n");
    return is_asked ? 0 : 2;
  }
  const std::string hex = argv[5];
  std::vector<char> request;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) request.push_back(static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  auto participant = ros2::Participant::open({static_cast<std::uint32_t>(std::atoi(argv[1])), ros2::Network::loopback});
  if (!participant) return 1;
  std::vector<std::uint8_t> reply;
  auto reader = (*participant)->make_reader({ros2::reply_on_wire(argv[2]), argv[4]}, [&](ros2::Received& received) {
    // Replies to others come here as well.
    if (received.related && received.related->sequence == 1) reply = received.bytes;
  });
  auto writer = (*participant)->make_writer({ros2::request_on_wire(argv[2]), argv[3]});
  if (!reader || !writer) return 1;
  if (!deliver_until(**participant, [&] { return !(*writer)->readers().empty() && !(*reader)->writers().empty(); })) {
    std::fprintf(stderr, "fast_client: no server of %s\n", argv[2]);
    return 1;
  }
  (*writer)->write(
      request.size(), [&](std::span<char> room) { std::memcpy(room.data(), request.data(), request.size()); },
      ros2::SampleIdentity{(*reader)->guid(), 0});
  if (!deliver_until(**participant, [&] { return !reply.empty(); })) {
    std::fprintf(stderr, "fast_client: no reply of %s\n", argv[2]);
    return 1;
  }
  for (const auto byte : reply) std::printf("%02x", byte);
  std::printf("\n");
  return 0;
}
