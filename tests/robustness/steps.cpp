// Kills at every store: steps SECONDS [SEED]. A process is led through one deed in shared memory (a sample or a frame is published, a
// command given, a request asked) instruction by instruction. Wherever an instruction has changed the segment, readers look at it; then, as
// far as the time goes and in random order, another process is led as far and killed there. Readers get whole samples, the server of
// commands and requests goes on, its slots and leases come back, and the next server gets the id. Exit code 77 where nothing may be traced.
#include <sys/prctl.h>
#include <sys/ptrace.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

#include "shm/request_board.h"
#include "shm/shm_support.h"
#include "support/usage.h"

namespace shm::test {
namespace {

using Clock = std::chrono::steady_clock;
using Deed = std::function<void()>;

constexpr int skipped = 77;

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "steps: %s\n", what.c_str());
  std::exit(1);
}

void require(bool holds, const std::string& what) {
  if (!holds) fail(what);
}

// A process that stands before its deed, or in the middle of it. Gone with its owner.
class Stepped {
 public:
  explicit Stepped(const std::function<Deed()>& prepare) : child_([&] { return live(prepare); }) {
    if (wait_for_stop() != SIGSTOP) fail("a process has not come to its deed");
  }
  // False when the deed was done.
  bool step() {
    if (ptrace(PTRACE_SINGLESTEP, child_.pid(), nullptr, nullptr) != 0) fail(std::string("single step: ") + std::strerror(errno));
    const int signal = wait_for_stop();
    if (signal != SIGTRAP && signal != SIGSTOP) fail("a deed ends by signal " + std::to_string(signal));
    return signal == SIGTRAP;
  }
  void kill_now() { child_.kill_now(); }

 private:
  static int live(const std::function<Deed()>& prepare) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) return skipped;
    const Deed deed = prepare();
    raise(SIGSTOP);
    deed();
    raise(SIGSTOP);
    return 0;
  }
  int wait_for_stop() {
    int status = 0;
    if (waitpid(child_.pid(), &status, __WALL) != child_.pid()) fail("a process is gone");
    if (WIFEXITED(status) && WEXITSTATUS(status) == skipped) {
      std::printf("steps: no process may be traced here\n");
      std::exit(skipped);
    }
    return WIFSTOPPED(status) ? WSTOPSIG(status) : 0;
  }

  Child child_;
};

std::vector<std::byte> copy_of(const Segment& segment) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&segment.header());
  return {bytes, bytes + segment.facts().total_size};
}

// After how many instructions the segment was another one than before; `look` is called at each.
std::vector<int> stores_of(Stepped& stepped, const Segment& segment, const std::function<void()>& look) {
  std::vector<int> stores;
  auto before = copy_of(segment);
  for (int count = 1; stepped.step(); ++count) {
    if (std::memcmp(&segment.header(), before.data(), before.size()) == 0) continue;
    before = copy_of(segment);
    stores.push_back(count);
    look();
  }
  return stores;
}

struct Plan {
  Clock::time_point end;
  std::mt19937& random;
};

// `killed_at` for the instructions, in random order, until all were tried or the time is up.
void try_all(const char* what, std::vector<int> stores, const Plan& plan, const std::function<void(int store)>& killed_at) {
  require(!stores.empty(), std::string(what) + ": no store was seen");
  std::shuffle(stores.begin(), stores.end(), plan.random);
  std::size_t done = 0;
  for (; done < stores.size() && (done == 0 || Clock::now() < plan.end); ++done) killed_at(stores[done]);
  std::printf("%s: killed at %zu of %zu stores\n", what, done, stores.size());
  std::fflush(stdout);
}

void lead(Stepped& stepped, int instructions) {
  for (int i = 0; i < instructions; ++i) {
    if (!stepped.step()) return;
  }
}

// ---- a publication: the process is the server

struct Publisher {
  explicit Publisher(std::uint32_t id) : fixture{id, Server::start({.server_id = id, .access = {}}).value()} {}
  Fixture fixture;
  std::unique_ptr<IfaceWriter> laser = fixture.make(iface_spec(IfaceType::laser, "laser", laser_info()));
  std::unique_ptr<IfaceWriter> camera = fixture.make(camera_spec(IfaceType::camera, "eye", camera_info()));

  void scan(int number) {
    std::fill(laser->ranges().begin(), laser->ranges().end(), static_cast<float>(number));
    laser->publish(std::chrono::nanoseconds(number));
  }
  void frame(int number) {
    const auto data = camera->begin_frame();
    if (!data) std::abort();
    std::fill(data->begin(), data->end(), std::byte{static_cast<unsigned char>(number)});
    camera->publish_frame(std::chrono::nanoseconds(number), identity_pose);
  }
};

void look_at_scan(Iface& laser) {
  require(laser.read(), "a reader gets no sample");
  const auto scan = laser.laser_scan();
  const auto number = static_cast<float>(scan.sample->stamp.sequence);
  require(std::all_of(scan.ranges.begin(), scan.ranges.end(), [&](float range) { return range == number; }), "a sample is torn");
}

void look_at_frame(Iface& camera) {
  const auto frame = camera.hold();
  require(frame.has_value(), "a reader gets no frame");
  const auto number = std::byte{static_cast<unsigned char>(frame->sequence())};
  require(std::all_of(frame->data().begin(), frame->data().end(), [&](std::byte octet) { return octet == number; }), "a frame is torn");
}

void publication(const char* what, IfaceType type, const char* name, void (Publisher::*publish)(int), void (*look)(Iface&),
                 const Plan& plan) {
  const std::uint32_t id = fresh_server_id();
  const auto prepare = [&]() -> Deed {
    auto publisher = std::make_shared<Publisher>(id);
    (publisher.get()->*publish)(1);
    return [publisher, publish] { (publisher.get()->*publish)(2); };
  };
  const auto open = [&] {
    auto reader = Iface::open(id, type, name);
    require(reader.ok() && reader->subscribe().ok(), std::string(what) + ": no server took the id");
    return std::move(*reader);
  };
  std::vector<int> stores;
  {
    Stepped stepped(prepare);
    Iface reader = open();
    stores = stores_of(stepped, reader.segment(), [&] { look(reader); });
    look(reader);
  }
  try_all(what, std::move(stores), plan, [&](int store) {
    Stepped stepped(prepare);
    Iface reader = open();
    lead(stepped, store);
    stepped.kill_now();
    look(reader);
    for (auto than = reader.sequence();;) {
      const Wait outcome = reader.wait(than, 10s);
      if (outcome == Wait::closed) break;
      require(outcome == Wait::fresh, std::string(what) + ": a reader is not told that the server is dead");
      than = reader.sequence();
    }
  });
  remove_stale(id, id);
}

// ---- commands and requests: the process is a client of this server

class ServerProcess {
 public:
  explicit ServerProcess(std::uint32_t id) : id_(id), child_([id] { return serve(id); }) {
    const auto end = Clock::now() + 60s;
    while (!Iface::open(id, IfaceType::position2d, "base")) {
      require(Clock::now() < end, "the server does not start");
      std::this_thread::sleep_for(1ms);
    }
  }
  ~ServerProcess() {
    child_.kill_now();
    remove_stale(id_, id_);
  }
  void stop() const { child_.send(SIGSTOP); }
  void go_on() const { child_.send(SIGCONT); }
  void require_alive() const {
    int status = 0;
    require(waitpid(child_.pid(), &status, WNOHANG) == 0, "the server has ended");
  }

 private:
  static int serve(std::uint32_t id) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    Fixture fixture{id, Server::start({.server_id = id, .access = {}}).value()};
    auto simulation = fixture.make(simulation_spec(simulation_info(), 4, 4));
    RequestBoard board(*simulation, *fixture.server);
    auto base = fixture.make(iface_spec(IfaceType::position2d, "base", Position2dInfo{}));
    for (;;) {
      fixture.server->tend();
      for (const auto& asked : board.poll()) board.reply(asked.ticket, {});
      Command command{};
      const bool is_fresh = base->poll_command(command) == CommandChange::fresh;
      if (is_fresh && (command.values[0] != command.values[1] || command.values[0] != command.values[2])) return 3;
      board.wait(Clock::now() + 1ms);
    }
  }

  const std::uint32_t id_;
  Child child_;
};

// `deed`: of a client that stands before it. `others_do` proves that the server goes on.
void client(const char* what, std::uint32_t id, const ServerProcess& server, IfaceType type, const char* name,
            const std::function<Deed()>& deed, const std::function<void()>& others_do, const Plan& plan) {
  auto watched = Iface::open(id, type, name);
  require(watched.ok(), "the server is not there");
  std::vector<int> stores;
  {
    Stepped stepped(deed);
    server.stop();  // what changes is the client's work
    stores = stores_of(stepped, watched->segment(), [] {});
    server.go_on();
  }
  try_all(what, std::move(stores), plan, [&](int store) {
    Stepped stepped(deed);
    lead(stepped, store);
    stepped.kill_now();
    others_do();
    server.require_alive();
  });
}

void command(const Plan& plan) {
  const std::uint32_t id = fresh_server_id();
  const ServerProcess server(id);
  const auto deed = [id]() -> Deed {
    auto base = std::make_shared<Iface>(Iface::open(id, IfaceType::position2d, "base").value());
    if (!base->command_velocity(1, 1, 1)) std::abort();
    return [base] { (void)base->command_velocity(2, 2, 2); };
  };
  const auto others_do = [id] {
    auto base = Iface::open(id, IfaceType::position2d, "base");
    require(base.ok(), "command: nobody else gets to the robot");
    const auto end = Clock::now() + 60s;
    while (!base->command_velocity(3, 3, 3)) {
      require(Clock::now() < end, "command: the leases of the dead are not given back");
      std::this_thread::sleep_for(1ms);
    }
  };
  client("command", id, server, IfaceType::position2d, "base", deed, others_do, plan);
}

void request(const Plan& plan) {
  const std::uint32_t id = fresh_server_id();
  const ServerProcess server(id);
  const auto deed = [id]() -> Deed {
    auto requester = std::make_shared<Requester>(Requester::open(id).value());
    return [requester] { (void)requester->ask(SpawnRequest{std::string(2000, 'x'), false, "box", false, identity_pose}, 20ms); };
  };
  const auto others_do = [id] {
    auto requester = Requester::open(id);
    require(requester.ok(), "request: nobody else gets to the server");
    const auto reply = requester->ask(StatsRequest{}, 60s);
    require(reply.ok(), "request: another client is not answered: " + (reply.ok() ? "" : reply.error().message));
  };
  client("request", id, server, IfaceType::simulation, "world", deed, others_do, plan);
}

}  // namespace
}  // namespace shm::test

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "campaign_steps SECONDS [SEED]\nRuns random participants of a lock step, for the robustness tests.");
  using namespace shm::test;
  if (argc < 2) return 2;
  const double seconds = std::atof(argv[1]);
  const unsigned seed = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : std::random_device()();
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const auto plan = [&] { return Plan{Clock::now() + std::chrono::milliseconds(static_cast<int>(seconds * 250)), random}; };
  publication("sample", shm::IfaceType::laser, "laser", &Publisher::scan, &look_at_scan, plan());
  publication("frame", shm::IfaceType::camera, "eye", &Publisher::frame, &look_at_frame, plan());
  command(plan());
  request(plan());
  return 0;
}
