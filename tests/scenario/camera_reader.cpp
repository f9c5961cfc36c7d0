// A program that looks at a camera, for tests: camera_reader SERVER_ID TYPE NAME [HELD MILLISECONDS]. Each frame is a line "frame SEQUENCE
// SIM_TIME_NS CRC32 RESETS DROPPED"; the crc is taken when the frame comes, and again before it lets go: "torn" if they differ. HELD: so
// many frames are kept before the first goes, and it sleeps so long after each. When the server goes away it says "gone", and "back" when
// it has found it again. Ends when its input does.
#include <poll.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <thread>

#include "shm/client.h"
#include "shm/words.h"
#include "support/usage.h"

namespace {

std::uint32_t crc32(std::span<const std::byte> bytes) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int bit = 0; bit < 8; ++bit) c = (c & 1) != 0 ? 0xEDB88320U ^ (c >> 1) : c >> 1;
      made[i] = c;
    }
    return made;
  }();
  std::uint32_t c = 0xFFFFFFFFU;
  for (const auto byte : bytes) c = table[(c ^ static_cast<std::uint32_t>(byte)) & 0xff] ^ (c >> 8);
  return c ^ 0xFFFFFFFFU;
}

bool input_has_ended() {
  pollfd input{0, POLLIN, 0};
  if (poll(&input, 1, 0) <= 0) return false;
  char byte = 0;
  return (input.revents & POLLIN) == 0 || std::fread(&byte, 1, 1, stdin) == 0;
}

struct Kept {
  shm::HeldFrame frame;
  std::uint32_t crc;
};

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(
      argc, argv, "camera_reader SERVER_ID TYPE IFACE [FRAMES_TO_HOLD [PAUSE_MS]]\nReads the frames of a camera for the tests of cameras.");
  if (argc < 4) return 2;
  const std::size_t keep = argc > 4 ? static_cast<std::size_t>(std::atoi(argv[4])) : 1;
  const std::chrono::milliseconds pause(argc > 5 ? std::atoi(argv[5]) : 0);
  const auto type = shm::parse_type(argv[2]);
  if (!type) return 2;
  auto iface = shm::Iface::open(static_cast<std::uint32_t>(std::atoi(argv[1])), *type, argv[3]);
  if (!iface || !iface->subscribe()) return 1;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  std::puts("looks");
  std::deque<Kept> kept;
  std::uint64_t last = 0;
  while (!input_has_ended()) {
    const auto what = iface->wait(last, std::chrono::milliseconds(50));
    if (what == shm::Wait::closed) {
      kept.clear();
      last = 0;
      std::puts("gone");
      while (!iface->reopen() && !input_has_ended()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      std::puts("back");
    }
    if (what != shm::Wait::fresh) continue;
    auto frame = iface->hold();
    if (!frame) continue;
    last = frame->sequence();
    const auto crc = crc32(frame->data());
    std::printf("frame %llu %lld %u %u %llu\n", static_cast<unsigned long long>(last),
                static_cast<long long>(frame->head().stamp.sim_time_ns), crc, frame->head().stamp.resets,
                static_cast<unsigned long long>(shm::load(iface->segment().header().dropped)));
    kept.push_back({std::move(*frame), crc});
    if (kept.size() < keep) continue;
    std::this_thread::sleep_for(pause);
    if (crc32(kept.front().frame.data()) != kept.front().crc) std::puts("torn");
    kept.pop_front();
  }
  return 0;
}
