// A sensor that is out of order on purpose. It changes what the sensor has measured before it is published; the device itself knows nothing
// of it. The stepping thread only.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "base/result.h"
#include "rays/noise.h"
#include "shm/writer.h"

namespace sim {

// What somebody asks for, of a sensor or a drive.
struct FaultOrder {
  std::string iface;
  std::string kind;  // of a sensor: off, stuck, bias, noise, missing, latency, dropout; of a drive: weak, halted
  double amount = 0;
  std::chrono::nanoseconds from{}, until = std::chrono::nanoseconds::max();  // simulated
};
// "KIND:FROM:FOR:AMOUNT:IFACE", seconds; FOR 0: to the end.
base::Result<FaultOrder> parse_fault_order(const std::string& text);

class SensorFault {
 public:
  enum class Kind { off, stuck, bias, noise, missing, latency, dropout };
  // Fails when a sensor of the type cannot have it.
  static base::Result<SensorFault> make(const FaultOrder& order, const shm::IfaceWriter& writer, std::uint64_t seed);

  bool is_at(std::chrono::nanoseconds now) const { return now >= from_ && now < until_; }
  // Asked once for each sample that is due: whether it is to be left out.
  bool leaves_out();
  // Changes the sample that waits to be published.
  void apply(shm::IfaceWriter& writer);
  void reset();

 private:
  SensorFault(Kind kind, const FaultOrder& order, RandomStream random)
      : kind_(kind), amount_(order.amount), from_(order.from), until_(order.until), random_(std::move(random)) {}
  void exchange(shm::IfaceWriter& writer);
  void disturb(shm::IfaceWriter& writer);
  void lose_beams(shm::IfaceWriter& writer);

  Kind kind_;
  double amount_;
  std::chrono::nanoseconds from_, until_;
  RandomStream random_;
  std::deque<std::vector<std::byte>> kept_;  // stuck: one; latency: those that are late
};

}  // namespace sim
