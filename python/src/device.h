// An iface of a simulator, as Python sees it: a sensor that is read, a drive or joints that are commanded.
//
// It subscribes when it is made, so the sensor works from then on. When the iface has been removed and made again, as by deleting a model
// and spawning it, the next call attaches to the new one. Errors, waits, threads and fork: as in simulator.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "python/src/fields.h"
#include "python/src/simulator.h"

namespace python {

class Device {
 public:
  // `type`: of iface_types.h. `simulator` must live longer; Python keeps it.
  Device(Simulator& simulator, const std::string& type, const std::string& name);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  py::dict info();
  // All fields of the latest sample, or head of the latest frame with "image". Waits for the first one, at most `timeout`.
  py::dict read(Simulator::Seconds timeout);
  // One field of it.
  py::object value(const std::string& field, Simulator::Seconds timeout);
  // Ranges (beams), (layers, beams) or (transducers) [m]; an image.
  py::array array(Simulator::Seconds timeout);
  // Waits for a sample newer than `than`. False: none came.
  bool wait(std::uint64_t than, Simulator::Seconds timeout);
  std::uint64_t sequence();

  void command(shm::CommandKind kind, const std::vector<double>& values, Simulator::Seconds duration);
  void velocity(double a, double b, double c, Simulator::Seconds duration);  // three values of a position2d
  bool is_commanding();

  const std::string& name() const { return name_; }
  std::string type() const { return std::string(shm::to_text(type_)); }
  void close();

 private:
  shm::Iface& iface();
  // The iface with its sample.
  shm::Iface& fresh(Simulator::Seconds timeout);
  shm::HeldFrame frame(Simulator::Seconds timeout);
  void wait_for_first(Simulator::Seconds timeout);
  shm::Wait wait_without_gil(std::uint64_t than, std::chrono::nanoseconds timeout);

  Simulator& simulator_;
  shm::IfaceType type_;
  std::string name_;
  std::optional<shm::Iface> iface_;
  const pid_t owner_;
  bool is_waiting_ = false;  // without the GIL
};

}  // namespace python
