// Identity of a process, whether it is running, and detection of shared memory of processes that have exited. Any thread.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>

#include "base/file_handle.h"
#include "shm/layout.h"

namespace shm {

// Tells processes apart.
using ProcessKey = std::tuple<std::int32_t, std::uint32_t, std::uint64_t>;
inline ProcessKey key_of(const ProcessMark& mark) { return {mark.pid, mark.pid_namespace, mark.start_time}; }

// Of the calling process; read again after a fork.
ProcessMark own_mark();
// Name of the calling program, for people.
const std::string& own_program();
// 16 bytes that differ from boot to boot.
const std::array<std::uint8_t, 16>& boot_id();

// False when the process has ended (zombies have) or its pid belongs to another one now. A process of another pid namespace can't be
// judged and counts as alive. A start time of 0 means unknown: then the pid alone decides.
bool is_alive(const ProcessMark& mark);

// The same question for those who ask again and again: one system call that no file is opened for. All of this process who ask for one and
// the same process share a descriptor.
class ProcessLife {
 public:
  static std::shared_ptr<const ProcessLife> of(const ProcessMark& mark);
  explicit ProcessLife(const ProcessMark& mark);  // use of()
  bool is_alive() const;

 private:
  ProcessMark mark_;
  base::FileHandle pidfd_;  // none: the kernel would not give one, or the process can't be judged
};

// (pid << 32) | number; the number is unique in this process. Never 0.
std::uint64_t make_owner();
constexpr pid_t owner_pid(std::uint64_t owner) { return static_cast<pid_t>(owner >> 32); }

// CLOCK_MONOTONIC, Unix time [ns].
std::int64_t monotonic_ns();
std::int64_t wall_ns();

}  // namespace shm
