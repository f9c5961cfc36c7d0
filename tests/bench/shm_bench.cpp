// What shared memory costs, each number beside its limit or beside a bare version measured in the same run. Prints a table.
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <functional>
#include <thread>
#include <vector>

#include "shm/client.h"
#include "shm/lockstep.h"
#include "shm/server.h"
#include "support/usage.h"

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

double nanoseconds_since(Clock::time_point start) { return std::chrono::duration<double, std::nano>(Clock::now() - start).count(); }

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

void print(const char* what, double value, const char* unit, double limit, const char* limit_text) {
  std::printf("%-58s %10.3f %-6s %10.3f  %-28s %s\n", what, value, unit, limit, limit_text, value <= limit ? "ok" : "MISSED");
}

std::uint32_t server_id() { return 2'000'000 + static_cast<std::uint32_t>(getpid()); }

// Child processes that end with this one's wish.
class Children {
 public:
  void add(const std::function<void()>& body) {
    const pid_t pid = fork();
    if (pid == 0) {
      body();
      _exit(0);
    }
    pids_.push_back(pid);
  }
  void end() {
    for (const pid_t pid : pids_) kill(pid, SIGKILL);
    for (const pid_t pid : pids_) waitpid(pid, nullptr, 0);
    pids_.clear();
  }
  ~Children() { end(); }

 private:
  std::vector<pid_t> pids_;
};

shm::LaserInfo scan_of_3_kib() {
  shm::LaserInfo info{};
  info.beams = (3072 - sizeof(shm::LaserSample)) / 8;
  info.layers = 1;
  return info;
}

void bench_samples(shm::Server& server) {
  auto writer = server.create(shm::iface_spec(shm::IfaceType::laser, "laser", scan_of_3_kib())).value();
  auto reader = shm::Iface::open(server.id(), shm::IfaceType::laser, "laser").value();
  std::vector<double> publish, both, copy;
  std::vector<char> from(3072, 1), to(3072);
  for (int round = 0; round < 30; ++round) {
    constexpr int count = 20000;
    auto start = Clock::now();
    for (int i = 0; i < count; ++i) writer->publish(1ms);
    publish.push_back(nanoseconds_since(start) / count / 1000);
    start = Clock::now();
    for (int i = 0; i < count; ++i) {
      writer->publish(1ms);
      if (!reader.read()) std::abort();
    }
    both.push_back(nanoseconds_since(start) / count / 1000);
    start = Clock::now();
    for (int i = 0; i < count; ++i) {
      std::memcpy(to.data(), from.data(), from.size());
      asm volatile("" ::"r"(to.data()) : "memory");
      std::memcpy(from.data(), to.data(), from.size());
      asm volatile("" ::"r"(from.data()) : "memory");
    }
    copy.push_back(nanoseconds_since(start) / count / 1000);
  }
  print("publish 3 KiB, nobody waits", median(publish), "us", 0.3, "goal");
  print("publish + read 3 KiB", median(both), "us", 0.3, "goal");
  std::printf("%-58s %10.3f us\n", "  (two bare memcpy of 3 KiB)", median(copy));
}

void bench_frames(shm::Server& server) {
  shm::CameraInfo info{};
  info.width = 640;
  info.height = 480;
  info.format = RTMSIM_FORMAT_RGB8;
  auto writer = server.create(shm::camera_spec(shm::IfaceType::camera, "eye", info)).value();
  auto reader = shm::Iface::open(server.id(), shm::IfaceType::camera, "eye").value();
  if (!reader.subscribe()) std::abort();
  constexpr int count = 100000;
  const auto start = Clock::now();
  for (int i = 0; i < count; ++i) {
    if (!writer->begin_frame()) std::abort();
    writer->publish_frame(1ms, shm::identity_pose);
    if (!reader.hold()) std::abort();
  }
  print("begin + publish + hold a frame, without its pixels", nanoseconds_since(start) / count / 1000, "us", 1.0, "goal");
}

// From publish in this process to the return of wait() in another, measured by the reader and put into a second iface's samples.
void bench_wake_up(shm::Server& server) {
  auto ping = server.create(shm::iface_spec(shm::IfaceType::truth, "ping", shm::TruthInfo{})).value();
  auto* delays = static_cast<std::atomic<double>*>(mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  Children children;
  children.add([&, id = server.id()] {
    auto reader = shm::Iface::open(id, shm::IfaceType::truth, "ping").value();
    std::uint64_t last = 0;
    while (true) {
      if (reader.wait(last, 10s) != shm::Wait::fresh) continue;
      const double now = static_cast<double>(Clock::now().time_since_epoch().count());
      last = reader.sample<shm::TruthSample>().stamp.sequence;
      delays[0].store(now - reader.sample<shm::TruthSample>().pose.x);
    }
  });
  std::vector<double> all;
  for (int i = 0; i < 3000; ++i) {
    delays[0].store(-1);
    std::this_thread::sleep_for(300us);  // the reader sleeps again
    ping->sample<shm::TruthSample>().pose.x = static_cast<double>(Clock::now().time_since_epoch().count());
    ping->publish(1ms);
    while (delays[0].load() < 0) std::this_thread::yield();
    all.push_back(delays[0].load() / 1000);
  }
  print("wake-up of a waiting process, median", median(all), "us", 10, "goal");
}

// ---- barriers ----
// Each process keeps to a processor of its own choice on both sides: where the scheduler puts them makes either barrier up to five times
// slower, at random and for seconds on end.

void keep_to_processor(std::uint32_t index) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(index % std::max(1U, std::thread::hardware_concurrency()), &set);
  sched_setaffinity(0, sizeof set, &set);
}

struct Bare {
  std::atomic<std::uint32_t> go{0};
  alignas(64) std::atomic<std::uint32_t> left{0};
};

long futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value) {
  return syscall(SYS_futex, &word, operation, value, nullptr, nullptr, 0);
}

class BareBarrier {
 public:
  explicit BareBarrier(std::uint32_t count) : count_(count) {
    shared_ = new (mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) Bare;
    for (std::uint32_t i = 0; i < count; ++i) {
      children_.add([shared = shared_, i] {
        keep_to_processor(i + 1);
        for (std::uint32_t seen = 0;;) {
          while (shared->go.load() == seen) futex(shared->go, FUTEX_WAIT, seen);
          ++seen;
          if (shared->left.fetch_sub(1) == 1) futex(shared->left, FUTEX_WAKE, 1);
        }
      });
    }
  }
  void tick() {
    shared_->left.store(count_);
    shared_->go.fetch_add(1);
    futex(shared_->go, FUTEX_WAKE, INT_MAX);
    for (std::uint32_t left = shared_->left.load(); left != 0; left = shared_->left.load()) futex(shared_->left, FUTEX_WAIT, left);
  }

 private:
  std::uint32_t count_;
  Bare* shared_;
  Children children_;
};

class OurBarrier {
 public:
  explicit OurBarrier(std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      children_.add([id = server_id() + 1, i] {
        keep_to_processor(i + 1);
        while (true) {
          auto participant = shm::Participant::join(id, {"p", 1, 1ms});
          if (!participant) {
            std::this_thread::sleep_for(1ms);
            continue;
          }
          shm::Tick tick;
          while (true) participant->wait(tick, 10s);
        }
      });
    }
    server_ = shm::Server::start({.server_id = server_id() + 1, .access = {}}).value();
    simulation_ = server_->create(shm::simulation_spec({})).value();
    barrier_ = std::make_unique<shm::Barrier>(*simulation_, *server_, shm::BarrierOptions{});
    while (barrier_->refresh() < count) std::this_thread::yield();
  }
  ~OurBarrier() { children_.end(); }
  void tick() { barrier_->tick(std::chrono::milliseconds(++now_), 0); }

 private:
  Children children_;
  std::unique_ptr<shm::Server> server_;
  std::unique_ptr<shm::IfaceWriter> simulation_;
  std::unique_ptr<shm::Barrier> barrier_;
  std::int64_t now_ = 0;
};

template <class Barrier>
double time_per_tick(Barrier& barrier, int ticks) {
  const auto start = Clock::now();
  for (int i = 0; i < ticks; ++i) barrier.tick();
  return nanoseconds_since(start) / ticks / 1000;
}

void bench_barrier(std::uint32_t count) {
  OurBarrier ours(count);
  BareBarrier bare(count);
  cpu_set_t all_processors;
  sched_getaffinity(0, sizeof all_processors, &all_processors);
  keep_to_processor(0);
  const int ticks = static_cast<int>(2000 / count);
  std::vector<double> our_times, bare_times, ratios;
  for (int round = 0; round < 101; ++round) {
    bare_times.push_back(time_per_tick(bare, ticks));
    our_times.push_back(time_per_tick(ours, ticks));
    ratios.push_back(our_times.back() / bare_times.back());
  }
  sched_setaffinity(0, sizeof all_processors, &all_processors);
  char text[80];
  std::snprintf(text, sizeof text, "barrier of %u: %.1f us, bare futex %.1f us", count, median(our_times), median(bare_times));
  print(text, median(ratios), "times", 1.3, "goal");
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "shm_bench\nMeasures shared memory and the lock step.");
  std::printf("%-58s %10s %-6s %10s\n", "shared memory", "measured", "", "limit");
  for (const std::uint32_t count : {1U, 4U, 16U}) bench_barrier(count);
  auto server = shm::Server::start({.server_id = server_id(), .access = {}}).value();
  bench_wake_up(*server);
  bench_samples(*server);
  bench_frames(*server);
}
