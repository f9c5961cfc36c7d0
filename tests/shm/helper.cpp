// A process for the fault tests to kill: one program with a part to play. `shm_helper PART SERVER_ID [NAME PHASE PERIOD_US]`
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "shm/client.h"
#include "shm/lockstep.h"
#include "shm/request_board.h"
#include "shm/server.h"
#include "shm/shm_support.h"
#include "support/usage.h"

namespace shm::test {
namespace {

using namespace std::chrono_literals;

// Publishes as fast as it can until it is killed.
int serve(std::uint32_t id) {
  auto server = Server::start({.server_id = id, .access = {}});
  if (!server) return std::fprintf(stderr, "%s\n", server.error().message.c_str()), 1;
  auto simulation = (*server)->create(simulation_spec(simulation_info()));
  if (!simulation) return std::fprintf(stderr, "%s\n", simulation.error().message.c_str()), 1;
  auto laser = (*server)->create(iface_spec(IfaceType::laser, "laser", laser_info()));
  auto camera = (*server)->create(camera_spec(IfaceType::camera, "eye", camera_info()));
  if (!laser || !camera) return std::fprintf(stderr, "no ifaces\n"), 1;
  RequestBoard board(**simulation, **server);
  Barrier barrier(**simulation, **server, {});
  for (std::uint64_t n = 1;; ++n) {
    (*server)->tend();
    for (const auto& asked : board.poll()) board.reply(asked.ticket, {});
    std::fill((*laser)->ranges().begin(), (*laser)->ranges().end(), static_cast<float>(n % 1024));
    std::fill((*laser)->intensities().begin(), (*laser)->intensities().end(), static_cast<float>(n % 1024));
    (*laser)->publish(std::chrono::milliseconds(n));
    if (auto data = (*camera)->begin_frame()) {
      std::fill(data->begin(), data->end(), std::byte{static_cast<unsigned char>(n)});
      (*camera)->publish_frame(std::chrono::milliseconds(n), identity_pose);
    }
    (*simulation)->publish(std::chrono::milliseconds(n));
    barrier.tick(std::chrono::milliseconds(n), n);
  }
}

template <class Open>
auto open_at_last(Open open) {
  while (true) {
    if (auto opened = open()) return std::move(opened).value();
    std::this_thread::sleep_for(1ms);
  }
}

// Reads for ever; exit code 3 for a torn sample or frame.
int read(std::uint32_t id) {
  auto laser = open_at_last([&] { return Iface::open(id, IfaceType::laser, "laser"); });
  auto camera = open_at_last([&] { return Iface::open(id, IfaceType::camera, "eye"); });
  while (!laser.subscribe() || !camera.subscribe()) std::this_thread::sleep_for(1ms);
  std::uint64_t last = 0;
  while (true) {
    const Wait outcome = laser.wait(last, 50ms);
    if (outcome == Wait::closed && laser.reopen()) last = 0;
    if (outcome == Wait::fresh) {
      const auto scan = laser.laser_scan();
      last = scan.sample->stamp.sequence;
      if (std::any_of(scan.ranges.begin(), scan.ranges.end(), [&](float r) { return r != scan.ranges[0]; })) return 3;
    }
    if (auto frame = camera.hold()) {
      const auto data = frame->data();
      if (std::any_of(data.begin(), data.end(), [&](std::byte b) { return b != data[0]; })) return 3;
    } else if (camera.status() != Status::live) {
      (void)camera.reopen();
    }
  }
}

int hold(std::uint32_t id) {
  auto camera = open_at_last([&] { return Iface::open(id, IfaceType::camera, "eye"); });
  if (!camera.subscribe()) return 1;
  std::vector<HeldFrame> held;
  while (true) {
    if (auto frame = camera.hold()) held.push_back(std::move(*frame));
    if (held.size() == max_holds) pause();
  }
}

int command(std::uint32_t id) {
  auto base = open_at_last([&] { return Iface::open(id, IfaceType::position2d, "base"); });
  for (double n = 1;; ++n) {
    if (!base.command_velocity(n, n, n)) return 1;
  }
}

int ask(std::uint32_t id) {
  auto requester = open_at_last([&] { return Requester::open(id); });
  const std::string text(3 * text_piece, 'x');
  while (true) (void)requester.ask(SpawnRequest{text, false, "box", false, identity_pose}, 10s);
}

int participate(std::uint32_t id, const char* name, std::uint32_t phase, std::chrono::nanoseconds period) {
  while (true) {
    auto participant = open_at_last([&] { return Participant::join(id, {name, phase, period}); });
    Tick tick;
    while (true) {
      const auto state = participant.wait(tick, 10s);
      if (state == Participant::State::closed || state == Participant::State::dropped) break;
    }
  }
}

// Looks at a laser once in each of its periods, so slowly that the simulator could be far ahead. Says for each tick its time, that of the
// sample that it sees at the end of it and that of the clock then [ms].
int observe(std::uint32_t id, const char* name, std::chrono::nanoseconds period, int ticks) {
  auto laser = open_at_last([&] { return Iface::open(id, IfaceType::laser, name); });
  auto simulation = open_at_last([&] { return Iface::open(id, IfaceType::simulation, "world"); });
  if (!laser.subscribe()) return 1;
  auto participant = Participant::join(id, {.name = "observer", .period = period, .observes = true});
  if (!participant) return 1;
  const auto ms = [](std::int64_t ns) { return static_cast<int>(ns / 1'000'000); };
  Tick tick;
  for (int n = 0; n < ticks;) {
    const auto state = participant->wait(tick, 60s);
    if (state != Participant::State::tick) return 1;
    const auto slow = std::chrono::steady_clock::now() + 5ms;  // of work
    while (std::chrono::steady_clock::now() < slow || !simulation.read()) {
    }
    if (!laser.read()) return 1;
    std::printf("%d %d %d\n", ms(tick.now.count()), ms(laser.sample<LaserSample>().stamp.sim_time_ns),
                ms(simulation.sample<SimulationSample>().stamp.sim_time_ns));
    ++n;
  }
  return 0;
}

// One request as a foreign client may write it, whatever our own tools would do: screenshot PATH, spawn-path PATH, spawn-text SDF. Says
// the status and the message or, of a picture, its first octets.
int ask_once(std::uint32_t id, const std::string& what, const std::string& text) {
  auto requester = Requester::open(id);
  if (!requester) return 1;
  Request request = PauseRequest{};
  if (what == "screenshot") {
    ScreenshotRequest screenshot;
    screenshot.path = text;
    request = screenshot;
  } else {
    request = SpawnRequest{text, what == "spawn-path", "", false, identity_pose};
  }
  const auto reply = requester->ask(request, 60s);
  if (!reply) return 1;
  std::printf("%u %s %s\n", static_cast<unsigned>(reply->status), reply->message.c_str(),
              reply->text.substr(std::min<std::size_t>(1, reply->text.size()), 3).c_str());
  return 0;
}

// Writes random words all over the segments of a server, except for the words that hold the layout.
int scribble(std::uint32_t id) {
  std::uint64_t random = static_cast<std::uint64_t>(getpid());
  std::vector<Segment> segments;
  for (const auto& found : find_segments(id)) {
    if (auto segment = Segment::open(found.name)) segments.push_back(std::move(*segment));
  }
  if (segments.empty()) return 1;
  while (true) {
    for (const auto& segment : segments) {
      random = random * 6364136223846793005U + 1442695040888963407U;
      const std::size_t words = segment.facts().total_size / 8;
      const std::size_t start = random % 3 == 0 ? 0 : 64;  // now and then the layout too
      auto* memory = reinterpret_cast<std::uint64_t*>(&segment.header());
      const std::size_t range = random % 2 == 0 ? words : std::min<std::size_t>(words, 2048);
      const std::uint64_t value = (random >> 20) % 4 == 0 ? ~std::uint64_t{0} : (random >> 20) % 4 == 1 ? (random >> 50) : random;
      store(memory[start + (random >> 33) % (range - start)], value, std::memory_order_relaxed);
    }
  }
}

}  // namespace
}  // namespace shm::test

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv,
                      "shm_helper serve|read|hold|command|ask|ask-once|scribble|participate|observe SERVER_ID [ARGUMENT]...\nIs the second "
                      "process of shared-memory tests.");
  if (argc < 3) return 2;
  alarm(280);  // nothing is left behind, whatever becomes of the test
  const std::string part = argv[1];
  const auto id = static_cast<std::uint32_t>(std::atoi(argv[2]));
  using namespace shm::test;
  if (part == "serve") return serve(id);
  if (part == "read") return read(id);
  if (part == "hold") return hold(id);
  if (part == "command") return command(id);
  if (part == "ask") return ask(id);
  if (part == "ask-once" && argc == 5) return ask_once(id, argv[3], argv[4]);
  if (part == "scribble") return scribble(id);
  if (part == "participate" && argc == 6) {
    return participate(id, argv[3], static_cast<std::uint32_t>(std::atoi(argv[4])), std::chrono::microseconds(std::atoi(argv[5])));
  }
  if (part == "observe" && argc == 6) return observe(id, argv[3], std::chrono::milliseconds(std::atoi(argv[4])), std::atoi(argv[5]));
  return 2;
}
