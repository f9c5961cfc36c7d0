// What the clock of ros2-gateway is measured against: a process that is woken after each step, or in each tick of the lock step, and sends
// a packet of the same size to another process on this computer. Prints its processor time for a packet.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "common/source.h"
#include "common/watched_ifaces.h"
#include "shm/lockstep.h"
#include "support/usage.h"

namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr std::size_t packet_size = 144;

class Packets {
 public:
  Packets() : from_(::socket(AF_INET, SOCK_DGRAM, 0)), to_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address_;
    ::bind(to_, reinterpret_cast<const sockaddr*>(&address_), size);
    ::getsockname(to_, reinterpret_cast<sockaddr*>(&address_), &size);
    receiver_ = ::fork();
    if (receiver_ == 0) receive();
  }
  ~Packets() {
    ::sendto(from_, packet_.data(), 0, 0, reinterpret_cast<const sockaddr*>(&address_), sizeof address_);  // an empty one ends it
    ::waitpid(receiver_, nullptr, 0);
  }
  Packets(const Packets&) = delete;
  Packets& operator=(const Packets&) = delete;
  void send() {
    ::sendto(from_, packet_.data(), packet_.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&address_), sizeof address_);
    ++sent_;
  }
  int sent() const { return sent_; }

 private:
  [[noreturn]] void receive() {
    while (::recv(to_, packet_.data(), packet_.size(), 0) > 0) {
    }
    std::_Exit(0);
  }
  int from_, to_, sent_ = 0;
  pid_t receiver_ = -1;
  sockaddr_in address_{};
  std::array<char, packet_size> packet_{};
};

base::Result<void> send_ticks(std::uint32_t server, Packets& packets, Clock::time_point end) {
  auto participant = shm::Participant::join(server, {.name = "bare_clock", .period = 1ms});
  if (!participant) return participant.error();
  for (shm::Tick tick; Clock::now() < end; participant->finish()) {
    if (participant->wait(tick, 20ms) == shm::Participant::State::tick) packets.send();
  }
  return {};
}

base::Result<void> send_steps(std::uint32_t server, Packets& packets, Clock::time_point end) {
  const auto clock = gateway::Source::open(server, shm::IfaceType::simulation, "world", 0);
  if (!clock) return clock.error();
  if (auto read = (*clock)->add_reader(); !read) return read;
  gateway::WatchedIfaces watched;
  watched.replace({(*clock)->segment()});
  for (const std::uint32_t word = 0; Clock::now() < end; watched.sleep(word, 0, 20ms)) {
    if (watched.take_news()) packets.send();
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  test::answer_help(argc, argv, "bare_clock SERVER_ID SECONDS [lockstep]\nSends a packet after each step; prints its processor time.");
  if (argc < 3) return 2;
  Packets packets;
  const auto server = static_cast<std::uint32_t>(std::atoi(argv[1]));
  const auto end = Clock::now() + std::chrono::seconds(std::atoi(argv[2]));
  const auto done = argc > 3 ? send_ticks(server, packets, end) : send_steps(server, packets, end);
  if (!done) {
    std::fprintf(stderr, "bare_clock: %s\n", done.error().message.c_str());
    return 1;
  }
  timespec used{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  const double microseconds = static_cast<double>(used.tv_sec) * 1e6 + static_cast<double>(used.tv_nsec) / 1e3;
  std::printf("%d packets, %.2f us each\n", packets.sent(), microseconds / std::max(packets.sent(), 1));
  return 0;
}
