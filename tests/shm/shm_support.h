// What the tests of shared memory share: server ids that no other test process uses, made-up infos, helper processes.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "shm/client.h"
#include "shm/requests.h"
#include "shm/server.h"
#include "shm/words.h"

namespace shm::test {

using namespace std::chrono_literals;

// Differs from process to process and from call to call.
inline std::uint32_t fresh_server_id() {
  static std::atomic<std::uint32_t> next{0};
  return 1'000'000U + static_cast<std::uint32_t>(getpid() % 100'000) * 100 + next++ % 100;
}

inline LaserInfo laser_info(std::uint32_t beams = 181) {
  LaserInfo info{};
  info.beams = beams;
  info.layers = 1;
  info.min_angle = -1.5;
  info.max_angle = 1.5;
  info.angle_step = 3.0 / (beams - 1);
  info.max_range = 8;
  info.rate = 10;
  info.pose = identity_pose;
  set_text(info.model, "robot");
  return info;
}

inline CameraInfo camera_info(std::uint32_t width = 32, std::uint32_t height = 8) {
  CameraInfo info{};
  info.width = width;
  info.height = height;
  info.format = RTMSIM_FORMAT_MONO8;
  info.hfov = 1;
  return info;
}

inline SimulationInfo simulation_info() {
  SimulationInfo info{};
  info.step_ns = 1'000'000;
  set_text(info.world, "made up");
  return info;
}

// What the end of a server does to a segment that a test still needs.
inline void store_closed(const IfaceWriter& writer) { store(writer.segment().header().state, std::uint32_t{RTMSIM_STATE_CLOSED}); }

struct Fixture {
  std::uint32_t id = fresh_server_id();
  std::unique_ptr<Server> server = Server::start({.server_id = id, .access = {}}).value();

  std::unique_ptr<IfaceWriter> make(const IfaceSpec& spec) {
    auto writer = server->create(spec);
    if (!writer) throw std::runtime_error(writer.error().message);
    return std::move(*writer);
  }
  Iface open(IfaceType type, const std::string& name) {
    auto iface = Iface::open(id, type, name);
    if (!iface) throw std::runtime_error(iface.error().message);
    return std::move(*iface);
  }
  // Tends until the condition holds; false after a minute.
  bool tend_until(const std::function<bool()>& condition) const {
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      server->tend();
      std::this_thread::yield();
    }
    return true;
  }
};

// A child process that runs `body` and exits with its value. Made before the test starts threads of its own, or with care.
class Child {
 public:
  explicit Child(const std::function<int()>& body) : pid_(fork()) {
    if (pid_ == 0) _exit(body());
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (pid_ > 0) kill_now();
  }
  pid_t pid() const { return pid_; }
  void send(int signal) const { ::kill(pid_, signal); }
  void kill_now() {
    send(SIGKILL);
    wait();
  }
  int wait() {
    int status = 0;
    if (pid_ > 0) waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_;
};

}  // namespace shm::test
