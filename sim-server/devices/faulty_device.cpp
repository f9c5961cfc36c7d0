#include "devices/faulty_device.h"

#include <algorithm>
#include <cmath>

#include "devices/position2d.h"
#include "shm/iface_types.h"

namespace sim {
namespace {

// What the iface says of itself; 0: it works in every step.
std::chrono::nanoseconds period_of(shm::IfaceWriter& writer) {
  for (const auto& field : shm::row_of(writer.type()).info) {
    if (field.name != "rate" || field.kind != shm::Field::Kind::f64) continue;
    const double rate = *static_cast<const double*>(field.in(writer.segment().info().data()));
    return std::chrono::nanoseconds(rate > 0 ? std::llround(1e9 / rate) : 0);
  }
  return {};
}

bool is_of_drive(const FaultOrder& order) { return order.kind == "weak" || order.kind == "halted"; }

}  // namespace

base::Result<std::unique_ptr<Device>> FaultyDevice::make(std::unique_ptr<Device> device, const std::vector<FaultOrder>& orders,
                                                         std::uint64_t seed) {
  std::unique_ptr<FaultyDevice> faulty(new FaultyDevice(std::move(device)));
  faulty->period_ = period_of(faulty->iface());
  for (const FaultOrder& order : orders) {
    if (is_of_drive(order)) {
      faulty->drive_ = dynamic_cast<Position2d*>(faulty->device_.get());
      if (!faulty->drive_) return base::Error{"fault " + order.kind + " of " + order.iface + ": it is no position2d"};
      if (order.amount < 0 || order.amount > 1)
        return base::Error{"fault " + order.kind + " of " + order.iface + ": its amount must be from 0 to 1"};
      faulty->drive_faults_.push_back(order);
      continue;
    }
    auto fault = SensorFault::make(order, faulty->iface(), seed);
    if (!fault) return fault.error();
    faulty->sensor_faults_.push_back(std::move(*fault));
  }
  return std::unique_ptr<Device>(std::move(faulty));
}

void FaultyDevice::before_step(const Moment& moment) {
  if (drive_) {
    double strength = 1;
    bool is_halted = false;
    for (const FaultOrder& order : drive_faults_) {
      if (moment.time < order.from || moment.time >= order.until) continue;
      if (order.kind == "weak") strength *= order.amount;
      is_halted = is_halted || order.kind == "halted";
    }
    drive_->set_fault(strength, is_halted);
  }
  device_->before_step(moment);
}

// A sample that is left out is not measured either; the next one is due a period later.
bool FaultyDevice::wants_sample(const Moment& moment) {
  if (moment.time < silent_until_ || !device_->wants_sample(moment)) return false;
  bool is_left_out = false;
  for (SensorFault& fault : sensor_faults_) is_left_out = (fault.is_at(moment.time) && fault.leaves_out()) || is_left_out;
  if (is_left_out) silent_until_ = moment.time + period_;
  return !is_left_out;
}

void FaultyDevice::publish(const Moment& moment) {
  for (SensorFault& fault : sensor_faults_) {
    if (fault.is_at(moment.time)) fault.apply(iface());
  }
  device_->publish(moment);
}

void FaultyDevice::reset() {
  silent_until_ = std::chrono::nanoseconds(0);
  for (SensorFault& fault : sensor_faults_) fault.reset();
  device_->reset();
}

}  // namespace sim
