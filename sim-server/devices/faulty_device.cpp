#include "devices/faulty_device.h"

#include <algorithm>
#include <cmath>

#include "devices/drives/drive.h"
#include "devices/joints/joints_device.h"
#include "shm/iface_types.h"

namespace sim {

FaultyDevice::FaultyDevice(std::unique_ptr<Device> device, std::uint64_t seed)
    : device_(std::move(device)),
      seed_(seed),
      drive_(dynamic_cast<Drive*>(device_.get())),
      joints_(dynamic_cast<JointsDevice*>(device_.get())),
      sensor_(dynamic_cast<Sensor*>(device_.get())) {}

// What stands behind the name of the iface.
base::Result<std::optional<std::size_t>> FaultyDevice::joint_of(const FaultOrder& order) {
  const std::string& name = iface().name();
  if (joints_ == nullptr || order.iface.size() <= name.size() + 2) return std::optional<std::size_t>();
  const auto joint = joints_->find(std::string_view(order.iface).substr(name.size() + 2));
  if (joint) return std::optional(*joint);
  return base::Error{"fault " + std::string(shm::row_of(order.kind).name) + " of " + name + ": " + joint.error().message};
}

base::Result<void> FaultyDevice::add(const FaultOrder& order) {
  const auto& row = shm::row_of(order.kind);
  const auto joint = joint_of(order);
  if (!joint) return joint.error();
  if (row.is_of_drive) {
    if (drive_ == nullptr && joints_ == nullptr)
      return base::Error{"fault " + std::string(row.name) + " of " + order.iface + ": it is no position2d or position3d and has no joints"};
    entries_.push_back({order, std::nullopt, *joint});
    return {};
  }
  auto fault = SensorFault::make(order, iface(), seed_, *joint);
  if (!fault) return fault.error();
  entries_.push_back({order, std::move(*fault), *joint});
  return {};
}

base::Result<void> FaultyDevice::replace(const FaultOrder& order, std::chrono::nanoseconds now) {
  const auto older = entries_.size();
  if (const auto added = add(order); !added) return added;
  const auto first_new = entries_.begin() + static_cast<std::ptrdiff_t>(older);
  entries_.erase(std::remove_if(entries_.begin(), first_new,
                                [&](const Entry& entry) {
                                  return entry.order.until <= now ||
                                         (entry.order.kind == order.kind && entry.order.iface == order.iface && entry.order.is_at(now));
                                }),
                 first_new);
  return {};
}

std::size_t FaultyDevice::end(const std::function<bool(const FaultOrder&)>& which) {
  return std::erase_if(entries_, [&](const Entry& entry) { return which(entry.order); });
}

std::vector<FaultOrder> FaultyDevice::orders() const {
  std::vector<FaultOrder> orders;
  for (const Entry& entry : entries_) orders.push_back(entry.order);
  return orders;
}

void FaultyDevice::weaken(const Moment& moment) {
  for (std::size_t i = 0; i < (joints_ != nullptr ? joints_->size() : 1); ++i) {
    double strength = 1;
    bool is_halted = false;
    for (const auto& [order, fault, joint] : entries_) {
      if (fault || !order.is_at(moment.time) || joint.value_or(i) != i) continue;
      if (order.kind == shm::FaultKind::weak) strength *= order.amount;
      is_halted = is_halted || order.kind == shm::FaultKind::halted;
    }
    if (drive_ != nullptr) drive_->set_fault(strength, is_halted);
    if (joints_ != nullptr) joints_->set_fault(i, strength, is_halted);
  }
}

void FaultyDevice::before_step(const Moment& moment) {
  if (drive_ != nullptr || joints_ != nullptr) weaken(moment);
  device_->before_step(moment);
}

// A sample that is left out is not measured either. What keeps samples sees all that are due: it does not depend on subscribers.
bool FaultyDevice::wants_sample(const Moment& moment) {
  const auto is_any = [&](const auto& of_fault) {
    return std::ranges::any_of(entries_,
                               [&](Entry& entry) { return entry.fault && entry.order.is_at(moment.time) && of_fault(*entry.fault); });
  };
  if (sensor_ != nullptr) sensor_->measure_always(is_any([](const SensorFault& fault) { return fault.keeps_samples(); }));
  return device_->wants_sample(moment) && !is_any([&](const SensorFault& fault) { return fault.leaves_out(moment.time); });
}

void FaultyDevice::publish(const Moment& moment) {
  for (auto& [order, fault, joint] : entries_) {
    if (fault && order.is_at(moment.time)) fault->apply(iface(), moment.time);
  }
  device_->publish(moment);
}

// By copies: a sample that somebody looks at while time stands still changes nothing in those that come later.
void FaultyDevice::show(const Moment& moment) {
  if (sensor_ == nullptr) return device_->show(moment);
  const auto is_off = [&](const Entry& entry) { return entry.order.kind == shm::FaultKind::off && entry.order.is_at(moment.time); };
  if (std::ranges::any_of(entries_, is_off)) return;
  sensor_->show_changed(moment, [&](shm::IfaceWriter& writer) {
    for (const auto& [order, fault, joint] : entries_) {
      if (fault && order.is_at(moment.time)) SensorFault(*fault).apply(writer, moment.time);
    }
  });
}

void FaultyDevice::reset() {
  for (Entry& entry : entries_) {
    if (entry.fault) entry.fault->reset();
  }
  device_->reset();
}

}  // namespace sim
