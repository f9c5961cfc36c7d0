// The simulator side of an iface. An `IfaceWriter` belongs to the thread that publishes on it (one thread at a time; different writers may
// be in different threads); is_subscribed() can be called from any thread. Server::create (server.h) creates it.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "shm/iface_types.h"
#include "shm/segment.h"

namespace shm {

enum class CommandChange {
  none,   // as before
  fresh,  // a new command
  lost,   // the commanding client died or detached: stop. Reported once
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

  // How often somebody subscribed while nobody was. Any thread.
  std::uint32_t times_switched_on() const;

  // ---- samples: fill the private sample, then publish a copy of it ----
  template <class Sample>
  Sample& sample() {
    return *reinterpret_cast<Sample*>(staging());
  }
  // What follows the sample, by the table of types: arrays of count() elements.
  template <class Element>
  std::span<Element> followers(std::size_t array) {
    return {reinterpret_cast<Element*>(followers(array, sizeof(Element))), count()};
  }
  std::span<float> ranges() { return followers<float>(0); }        // laser, sonar
  std::span<float> intensities() { return followers<float>(1); }   // laser
  std::span<Contact> contacts() { return followers<Contact>(0); }  // bumper: as many as its capacity
  std::size_t count() const;
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
  // Publishes the slot of begin_frame. width, height, format and stride are those of the info; `size` bytes are used (0 = all). `unit`: of
  // thermal images [K].
  void publish_frame(std::chrono::nanoseconds sim_time, const Pose& pose, std::size_t size = 0, double unit = 0);
  std::uint64_t dropped() const;

  // ---- commands ----
  // The latest command of all clients wins. Values are finite and kind is known; anything else is not delivered.
  CommandChange poll_command(Command& command);
  // For ifaces that follow all their clients: each command since the last call, one for each client, the latest of all last. Returns false,
  // at the cost of one load, when there is none. `owner` names the client until it detaches.
  using TakeCommand = std::function<void(std::uint64_t owner, const Command& command)>;
  bool poll_commands(const TakeCommand& take);
  // Whether this client, as poll_commands named it, still holds a lease. `owners_change()` differs after each lease that was taken or
  // released.
  bool holds_lease(std::uint64_t owner) const;
  std::uint32_t owners_change() const;
  std::string client_name(std::uint64_t owner) const;  // of its program, for people
  // What has been commanded and not been taken yet is not delivered.
  void drop_command();
  // Pid of the client whose command is in force, 0 = none.
  pid_t commanding_pid() const;

  struct Impl;
  explicit IfaceWriter(std::shared_ptr<Impl> impl);

 private:
  std::byte* followers(std::size_t array, std::size_t size);
  std::byte* staging();
  std::shared_ptr<Impl> impl_;
};

}  // namespace shm
