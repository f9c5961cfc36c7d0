// Plays the simulator to a system of a laser, an avoider and a drive: publishes scans and waits for the velocity command that answers each.
// Prints the median and the 90th percentile [us] from publication to command. With `bare` the same way is gone by the least that three
// processes can do: a wake-up from shared memory, two bare calls of the ORB with as many bytes, a command in shared memory.
//
//   latency_probe SERVER_ID COUNT          the processes of the system attach by themselves
//   latency_probe SERVER_ID COUNT bare     starts its own
#include <rtm/idl/DataPort_OpenRTMSkel.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <thread>
#include <vector>

#include "ports/support.h"
#include "shm/client.h"
#include "shm/server.h"
#include "support/usage.h"

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr const char* laser_name = "robot::laser";
constexpr const char* drive_name = "robot::position2d";
constexpr std::uint32_t beams = 181;
constexpr int warm_up = 50;
constexpr auto pause_between = 5ms;  // every process sleeps again before the next scan
constexpr auto longest_answer = 1s;  // then the scan counts as not answered
constexpr auto longest_run = 60s;

// ---- stages of the bare chain ----

class Drive : public POA_OpenRTM::InPortCdr, public PortableServer::RefCountServantBase {
 public:
  explicit Drive(std::uint32_t server) : robot_(shm::Iface::open(server, shm::IfaceType::position2d, drive_name).value()) {}
  OpenRTM::PortStatus put(const OpenRTM::CdrData&) override {
    const std::array<double, 3> velocity{0.1, 0, 0.2};
    static_cast<void>(robot_.command(shm::CommandKind::velocity, velocity));
    return OpenRTM::PORT_OK;
  }

 private:
  shm::Iface robot_;
};

class Forward : public POA_OpenRTM::InPortCdr, public PortableServer::RefCountServantBase {
 public:
  explicit Forward(OpenRTM::InPortCdr_ptr next) : next_(OpenRTM::InPortCdr::_duplicate(next)) { velocity_.length(44); }
  OpenRTM::PortStatus put(const OpenRTM::CdrData&) override { return next_->put(velocity_); }

 private:
  OpenRTM::InPortCdr_var next_;
  OpenRTM::CdrData velocity_;
};

OpenRTM::InPortCdr_var reference(corba::Orb& orb, const std::string& text) {
  const CORBA::Object_var object = orb.orb()->string_to_object(text.c_str());
  return OpenRTM::InPortCdr::_narrow(object);
}

template <class Servant>
int serve(corba::Orb& orb, Servant& servant) {
  const OpenRTM::InPortCdr_var mine = servant._this();
  const CORBA::String_var text = orb.orb()->object_to_string(mine);
  std::printf("%s\n", text.in());
  std::fflush(stdout);
  std::this_thread::sleep_for(longest_run);  // until it is killed
  return 0;
}

int read_and_send(corba::Orb& orb, std::uint32_t server, const std::string& next) {
  const auto target = reference(orb, next);
  auto laser = shm::Iface::open(server, shm::IfaceType::laser, laser_name).value();
  if (const auto done = laser.subscribe(); !done) throw std::runtime_error(done.error().message);
  OpenRTM::CdrData scan;
  scan.length(beams * 8 + 120);
  std::uint64_t last = 0;
  std::printf("ready\n");
  std::fflush(stdout);
  while (laser.wait(last, 1s) != shm::Wait::closed) {
    last = laser.sample<shm::Stamp>().sequence;
    target->put(scan);
  }
  return 0;
}

// ---- the simulator ----

class Probe {
 public:
  explicit Probe(std::uint32_t id) : server_(shm::Server::start({.server_id = id, .access = {}}).value()) {
    world_ = server_->create(shm::simulation_spec(shm::SimulationInfo{})).value();
    shm::LaserInfo info{};
    info.beams = beams;
    info.layers = 1;
    info.min_angle = -1.57;
    info.max_angle = 1.57;
    info.max_range = 8;
    info.rate = 100;
    laser_ = server_->create(shm::iface_spec(shm::IfaceType::laser, laser_name, info)).value();
    drive_ = server_->create(shm::iface_spec(shm::IfaceType::position2d, drive_name, shm::Position2dInfo{})).value();
  }

  // Times from publication to command [us] of `count` scans.
  std::vector<double> measure(int count) {
    std::vector<double> times;
    const auto end = Clock::now() + longest_run;
    for (int i = 0; static_cast<int>(times.size()) < count + warm_up; ++i) {
      if (Clock::now() > end) throw std::runtime_error("only " + std::to_string(times.size()) + " scans were answered");
      server_->tend();
      world_->publish(i * pause_between);
      drive_->publish(i * pause_between);
      std::this_thread::sleep_for(pause_between);
      shm::Command command;
      while (drive_->poll_command(command) == shm::CommandChange::fresh) continue;  // an answer that came too late
      if (!laser_->is_subscribed()) continue;
      std::ranges::fill(laser_->ranges(), 2.0F + static_cast<float>(i % 10));
      const auto start = Clock::now();
      laser_->publish(i * pause_between);
      while (Clock::now() - start < (times.empty() ? pause_between : longest_answer)) {
        if (drive_->poll_command(command) == shm::CommandChange::fresh) {
          times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
          break;
        }
        sched_yield();  // gives the processor to whoever works on the answer
      }
    }
    times.erase(times.begin(), times.begin() + warm_up);
    std::ranges::sort(times);
    return times;
  }

 private:
  std::unique_ptr<shm::Server> server_;
  std::unique_ptr<shm::IfaceWriter> world_;
  std::unique_ptr<shm::IfaceWriter> laser_;
  std::unique_ptr<shm::IfaceWriter> drive_;
};

std::string first_line(support::Process& process) {
  if (!process.wait_for_output("\n")) throw std::runtime_error("a stage of the bare chain does not start: " + process.output());
  const auto text = process.output();
  return text.substr(0, text.find('\n'));
}

void run(const char* self, const std::string& id, int count, bool is_bare) {
  Probe probe(static_cast<std::uint32_t>(std::stoul(id)));
  std::vector<std::unique_ptr<support::Process>> chain;
  if (is_bare) {
    std::string next;
    for (const char* stage : {"drive", "forward", "read"}) {
      chain.push_back(std::make_unique<support::Process>(std::vector<std::string>{self, id, stage, next}));
      next = first_line(*chain.back());
    }
  }
  const auto times = probe.measure(count);
  std::printf("%.1f %.1f\n", times[times.size() / 2], times[times.size() * 9 / 10]);
}

}  // namespace

int main(int argc, char** argv) try {
  ::test::answer_help(argc, argv,
                      "latency_probe SERVER_ID COUNT [bare]\nPlays the simulator to a laser, an avoider and a drive; prints the delay from "
                      "scan to command [us].");
  if (argc < 3) return std::fprintf(stderr, "usage: latency_probe SERVER_ID COUNT [bare]\n"), 2;
  const std::string what = argv[2];
  if (what != "drive" && what != "forward" && what != "read") {
    run(argv[0], argv[1], std::stoi(what), argc > 3);
    return 0;
  }
  const auto orb = ports::start_orb();
  const auto server = static_cast<std::uint32_t>(std::stoul(argv[1]));
  const std::string next = argc > 3 ? argv[3] : "";
  if (what == "read") return read_and_send(*orb, server, next);
  if (what == "drive") {
    ports::Local<Drive> drive(server);
    return serve(*orb, drive);
  }
  ports::Local<Forward> forward(reference(*orb, next));
  return serve(*orb, forward);
} catch (const std::exception& error) {
  std::fprintf(stderr, "latency_probe: %s\n", error.what());
  return 1;
}
