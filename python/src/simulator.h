// The connection of Python to a simulator: requests, time and steps.
//
// Errors: the exceptions of errors.h. Waits: each has a timeout; while it waits, the GIL is released, and Python's signal handlers run ten
// times a second, so Ctrl-C raises KeyboardInterrupt. It pauses the simulator: no further step is made. A request with a text (spawn) is
// answered, or times out, before.
// Threads: with the GIL. A second thread that calls while a first one waits gets an Error.
// Fork: the child's copy does nothing when it is destroyed, so the parent's connection stays open.
#pragma once

#include <pybind11/pybind11.h>
#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "python/src/errors.h"
#include "shm/request_board.h"

namespace python {

namespace py = pybind11;

class Simulator {
 public:
  using Seconds = std::chrono::duration<double>;

  explicit Simulator(std::uint32_t server_id);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  // `how`: called when the simulator has exited, and returns the line that says how. None: a general line.
  void on_death(py::object how) { how_it_died_ = std::move(how); }

  // The timeout of a step is that without progress: simulated time must go on within it.
  void begin_steps(std::int64_t count);
  double end_steps(Seconds timeout);  // simulated time [s]
  double step(std::int64_t count, Seconds timeout) {
    begin_steps(count);
    return end_steps(timeout);
  }
  shm::Reply ask(const shm::Request& request, Seconds timeout);
  // Before samples are read: if the world has been changed since the last step, the sensors show it as it is now.
  void show_changes(Seconds timeout);

  double time();  // [s]
  std::uint64_t steps();
  bool is_paused();
  std::uint64_t seed();
  double step_size();  // [s]
  std::string world();
  std::string world_file();
  std::uint32_t server_id();
  pid_t pid();
  bool is_alive();
  bool is_shared();
  void check_alive();
  // Afterwards each call fails. Several times is allowed.
  void close();

 private:
  class Busy;
  shm::Requester& line();
  const shm::SimulationSample& clock();
  const shm::SimulationInfo& info();
  [[noreturn]] void fail(const std::string& message);
  void pause_after_interrupt();
  std::string late_participants();

  std::unique_ptr<shm::Requester> requester_;
  py::object how_it_died_ = py::none();
  const pid_t owner_;
  bool is_busy_ = false;
  bool is_changed_ = false;  // by a request, without a step that followed
};

}  // namespace python
