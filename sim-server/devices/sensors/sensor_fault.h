// An injected fault of a sensor: changes a measurement before it is published. The device itself does not know of it. The stepping thread
// only.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "rays/noise.h"
#include "shm/fault_kinds.h"
#include "shm/writer.h"

namespace sim {

// What somebody asks for, of a sensor or a drive.
struct FaultOrder {
  std::string iface;  // or a joint of one: arm::joints::elbow
  shm::FaultKind kind = shm::FaultKind::off;
  double amount = 0;
  std::chrono::nanoseconds from{}, until = std::chrono::nanoseconds::max();  // simulated

  bool is_at(std::chrono::nanoseconds now) const { return now >= from && now < until; }
};
// As base/fault_text.h has it, with an iface as LAST; AMOUNT empty: the usual one.
base::Result<FaultOrder> parse_fault_order(const std::string& text);

class SensorFault {
 public:
  using Kind = shm::FaultKind;
  // Fails when a sensor of the type cannot have it. `joint`: of a joints iface, this one alone.
  static base::Result<SensorFault> make(const FaultOrder& order, const shm::IfaceWriter& writer, std::uint64_t seed,
                                        std::optional<std::size_t> joint = std::nullopt);

  // Whether the sample of this simulated time is to be left out.
  bool leaves_out(std::chrono::nanoseconds time) const;
  // Whether it changes a sample by those before it.
  bool keeps_samples() const { return kind_ == Kind::stuck || kind_ == Kind::latency; }
  // Changes the sample of this time, which waits to be published.
  void apply(shm::IfaceWriter& writer, std::chrono::nanoseconds time);
  void reset() { kept_.clear(); }

 private:
  SensorFault(const FaultOrder& order, RandomStream random, std::optional<std::size_t> joint)
      : kind_(order.kind), amount_(order.amount), random_(std::move(random)), joint_(joint) {}
  std::span<std::byte> measured(shm::IfaceWriter& writer) const;
  void exchange(shm::IfaceWriter& writer);
  void disturb(shm::IfaceWriter& writer, RandomStream random) const;
  void lose_beams(shm::IfaceWriter& writer, RandomStream random) const;

  Kind kind_;
  double amount_;
  RandomStream random_;
  std::optional<std::size_t> joint_;
  std::deque<std::vector<std::byte>> kept_;  // stuck: one; latency: those that are late
};

}  // namespace sim
