// The client side of ifaces: find, open, read, wait, command. An Iface belongs to one thread at a time.
//
//   auto laser = shm::Iface::open(0, shm::IfaceType::laser, "pioneer2dx::laser");
//   laser->subscribe();
//   while (laser->wait(last, 100ms) == shm::Wait::fresh) { auto scan = laser->laser_scan(); last = scan.sample->stamp.sequence; ... }
//
// When the server dies, restarts or removes the iface, wait() and status() say so (never an exception or a crash, the memory stays
// readable); reopen() attaches to the new one as soon as there is one.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "shm/iface_types.h"
#include "shm/segment.h"

namespace shm {

enum class Status {
  live,
  closed,  // the server removed the iface or ended in an orderly way, or a new server has taken its place
  dead,    // the server's process is gone
};

enum class Wait { fresh, timed_out, closed };

struct ScanView {
  const LaserSample* sample;
  std::span<const float> ranges, intensities;  // beam by beam, layer by layer
};
struct SonarView {
  const SonarSample* sample;
  std::span<const float> ranges;
};
struct BumperView {
  const BumperSample* sample;
  std::span<const Contact> contacts;  // those that are filled
};

// A frame of the ring that the writer leaves alone as long as this object lives; it may outlive its Iface.
class HeldFrame {
 public:
  HeldFrame(HeldFrame&& other) noexcept;
  HeldFrame& operator=(HeldFrame&& other) noexcept;
  ~HeldFrame();
  const FrameHead& head() const { return head_; }
  std::span<const std::byte> data() const { return data_; }
  std::uint64_t sequence() const { return head_.stamp.sequence; }

 private:
  friend class Iface;
  HeldFrame(std::shared_ptr<void> keeper, std::uint32_t* hold, const FrameHead& head, std::span<const std::byte> data);
  void release();
  std::shared_ptr<void> keeper_;  // the mapping and the lease
  std::uint32_t* hold_;
  FrameHead head_;  // a private copy
  std::span<const std::byte> data_;
};

class Iface {
 public:
  // Errors name what was looked for and what there is instead. This user's servers come first, then those of others that can be read.
  static base::Result<Iface> open(std::uint32_t server_id, IfaceType type, std::string_view name);
  Iface(Iface&&) noexcept;
  Iface& operator=(Iface&&) noexcept;
  ~Iface();  // unsubscribes; a robot that this handle commanded stops

  IfaceType type() const;
  const std::string& name() const;
  std::uint32_t server_id() const;
  const Segment& segment() const;

  // Constants. Info must be the type's own (LaserInfo for laser, ...).
  template <class Info>
  const Info& info() const {
    return *static_cast<const Info*>(info_bytes(sizeof(Info)));
  }
  std::span<const Pose> sonar_poses() const;

  // The sensor works as long as somebody has subscribed. Fails when all leases are taken or the server is gone.
  base::Result<void> subscribe();
  void unsubscribe();
  bool is_subscribed() const;

  // ---- samples ----
  // Copies the latest sample into this handle's buffer. False when there is none yet (or, against all odds, the writer was faster than
  // eight attempts). No system call.
  bool read();
  // The same with the oldest sample newer than `than` that the shared memory still has.
  bool read_after(std::uint64_t than);
  // For who reads many ifaces, one after the other: bring() a few before its turn asks the processor for the memory that read() looks at,
  // and expect(), still earlier, for that which bring() does. Neither waits, nor does anything else.
  void expect() const;
  void bring() const;
  // Only after read() was true. Valid until the next read(). Sample must be the type's own.
  template <class Sample>
  const Sample& sample() const {
    return *static_cast<const Sample*>(sample_bytes(sizeof(Sample)));
  }
  ScanView laser_scan() const;
  SonarView sonar_scan() const;
  BumperView bumper() const;
  std::span<const std::byte> sample_data() const;

  // ---- whatever the type: what the table (iface_types.h) says follows its info and its sample ----
  std::size_t count() const;   // elements in each array
  std::size_t filled() const;  // of a sample's, those that are true; at most count()
  std::span<const std::byte> info_data() const;
  const std::byte* info_followers(std::size_t array) const;
  const std::byte* sample_followers(std::size_t array) const;
  // The first array as elements of the type's own: all behind the info; of the sample those that are true.
  template <class Element>
  std::span<const Element> info_elements() const {
    return {reinterpret_cast<const Element*>(info_followers(0)), count()};
  }
  template <class Element>
  std::span<const Element> elements() const {
    return {reinterpret_cast<const Element*>(sample_followers(0)), filled()};
  }

  // Number of the latest sample or frame there is; 0 = none.
  std::uint64_t sequence() const;
  // Waits until there is one newer than `than`; for samples it has been read then. `closed` within a tenth of a second after a crash, at
  // once after an orderly end. A time-out of 0 just looks.
  Wait wait(std::uint64_t than, std::chrono::nanoseconds timeout);

  // ---- frames: need subscribe() ----
  // The latest one; nothing when there is none, or this handle holds RTMSIM_HOLDS frames already.
  std::optional<HeldFrame> hold();

  // ---- commands ----
  // The latest command of all clients counts. Missing values are 0. Rejects values that are not finite, and more than the iface has.
  // `duration`: simulated time after which the simulator ends the command by itself, counted from the first step that follows it; 0: none.
  base::Result<void> command(CommandKind kind, std::span<const double> values, std::chrono::nanoseconds duration = {});
  base::Result<void> command_velocity(double vx, double vy, double va);
  // True while this handle's command is the one in force.
  bool is_commanding() const;

  // ---- life ----
  Status status() const;
  // Attaches to the iface that has the name now, keeps a subscription. Fails like open(); then this handle stays as it was.
  base::Result<void> reopen();

 private:
  struct State;
  explicit Iface(std::shared_ptr<State> state);
  const void* info_bytes(std::size_t size) const;
  const void* sample_bytes(std::size_t size) const;
  std::shared_ptr<State> state_;
};

}  // namespace shm
