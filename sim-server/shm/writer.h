// The server's side of ifaces. `Server` stands for one server id: any thread. An `IfaceWriter` belongs to the thread that publishes on it
// (one thread at a time; different writers in different threads are fine); is_subscribed() may be called from any thread.
//
//   auto server = shm::Server::start({.server_id = 0});
//   auto laser = (*server)->create(shm::laser_spec("pioneer2dx::laser", info));
//   each tick:  if ((*laser)->is_subscribed()) { fill (*laser)->sample<LaserSample>() and ranges(); (*laser)->publish(sim_time); }
//   often:      (*server)->tend();
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "base/result.h"
#include "shm/layout.h"
#include "shm/process_watch.h"
#include "shm/segment.h"

namespace shm {

struct IfaceSpec {
  IfaceType type = IfaceType::laser;
  std::string name;
  std::vector<std::byte> info;
  Geometry geometry;
};

// Specs of all types. Counts and sizes are taken from the infos; a count that is not plausible (0 beams, more than 2^24 values, frames
// above 1 GiB) makes create() fail.
IfaceSpec simulation_spec(const SimulationInfo& info, std::uint32_t request_slots = 32, std::uint32_t participants = 256);
IfaceSpec laser_spec(const std::string& name, const LaserInfo& info);
IfaceSpec sonar_spec(const std::string& name, const SonarInfo& info, std::span<const Pose> poses);  // info.count is set to poses.size()
IfaceSpec position2d_spec(const std::string& name, const Position2dInfo& info);
IfaceSpec position3d_spec(const std::string& name, const Position3dInfo& info);
// type: camera, depth or points. stride and frame_size are computed when 0.
IfaceSpec camera_spec(IfaceType type, const std::string& name, const CameraInfo& info, std::uint32_t slots = 4);
IfaceSpec imu_spec(const std::string& name, const ImuInfo& info);
IfaceSpec gps_spec(const std::string& name, const GpsInfo& info);
IfaceSpec bumper_spec(const std::string& name, const BumperInfo& info);
// type: force_torque, altimeter, magnetometer or air_pressure.
IfaceSpec meter_spec(IfaceType type, const std::string& name, const MeterInfo& info);
IfaceSpec truth_spec(const std::string& name, const TruthInfo& info);

// Copies text into a fixed field, cut at its end and always terminated.
template <std::size_t size>
void set_text(char (&field)[size], std::string_view text) {
  const std::size_t length = text.size() < size ? text.size() : size - 1;
  for (std::size_t i = 0; i < size; ++i) field[i] = i < length ? text[i] : '\0';
}

enum class CommandChange {
  none,   // as before
  fresh,  // a new command
  lost,   // the commander died or detached: stop. Said once
};

class IfaceWriter {
 public:
  ~IfaceWriter();  // closes: readers see it at once
  IfaceWriter(const IfaceWriter&) = delete;
  IfaceWriter& operator=(const IfaceWriter&) = delete;

  IfaceType type() const;
  const std::string& name() const;
  const Segment& segment() const;

  // True while a living client wants samples. One load when nothing changed.
  bool is_subscribed() const;
  // True while somebody is subscribed and nothing has been published since the first of them came. Any thread.
  bool owes_sample() const;

  // ---- samples: fill the private sample, then publish a copy of it ----
  template <class Sample>
  Sample& sample() {
    return *reinterpret_cast<Sample*>(staging());
  }
  std::span<float> ranges();       // laser, sonar
  std::span<float> intensities();  // laser
  std::span<Contact> contacts();   // bumper: as many as its capacity
  // Never waits, never allocates, no system call unless a reader sleeps. Fills in the stamp.
  void publish(std::chrono::nanoseconds sim_time, bool is_valid = true);
  // Stamped into every sample.
  void set_resets(std::uint32_t resets);
  // Number of the last sample or frame published.
  std::uint64_t sequence() const;

  // ---- frames ----
  // Data of a free slot to draw into, or nothing when clients hold all of them (counted as dropped). Stays reserved until published or the
  // next begin_frame.
  std::optional<std::span<std::byte>> begin_frame();
  // Publishes the slot of begin_frame. width, height, format and stride are those of the info; `size` bytes are used (0 = all).
  void publish_frame(std::chrono::nanoseconds sim_time, const Pose& pose, std::size_t size = 0);
  std::uint64_t dropped() const;

  // ---- commands ----
  // The latest command of all clients wins. Values are finite and kind is known; anything else is not delivered.
  CommandChange poll_command(Command& command);
  // Pid of the client whose command is in force, 0 = none.
  pid_t commander() const;

  struct Impl;
  explicit IfaceWriter(std::shared_ptr<Impl> impl);

 private:
  std::byte* staging();
  std::shared_ptr<Impl> impl_;
};

struct ServerOptions {
  std::uint32_t server_id = 0;
  Access access;
};

class Server {
 public:
  // Removes what a dead server of this id left behind. Fails when a living one has it.
  static base::Result<std::unique_ptr<Server>> start(const ServerOptions& options);
  ~Server();  // writers must be gone by then

  // The name must be free among this server's ifaces of that type. Make the simulation iface first: of several servers that start at the
  // same time with the same id, the one that gets it is the server.
  base::Result<std::unique_ptr<IfaceWriter>> create(const IfaceSpec& spec);

  // Renews heartbeats and takes leases of dead clients back. Cheap when called often: does its work at most ten times a second, or at once
  // after a death.
  void tend();
  // Names of the segments that another process has cut short since the last call (cut_guard.h): nobody can use them until the server
  // starts anew. One load when there are none.
  std::vector<std::string> take_cuts();
  ProcessWatch& watch();
  std::uint32_t id() const;

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Parses "0660" and a group's name or number, for --shm-mode and --shm-group.
base::Result<Access> parse_access(const std::string& mode, const std::string& group);

}  // namespace shm
