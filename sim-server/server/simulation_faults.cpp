// Faults of devices: the devices that support faults, and the active faults.
#include <algorithm>

#include "devices/faulty_device.h"
#include "server/simulation.h"

namespace sim {
namespace {

// True for the iface itself, or a joint of it: arm::joints::elbow is of arm::joints.
bool is_of(std::string_view name, std::string_view iface_name) {
  return name == iface_name || (name.starts_with(iface_name) && name.substr(iface_name.size()).starts_with("::"));
}

// Ifaces of type truth have the names of other ifaces, and no faults.
bool is_named(Device& device, std::string_view iface_name) {
  const auto type = device.iface().type();
  return is_of(iface_name, device.iface().name()) && type != shm::IfaceType::truth &&
         (device.iface().name() == iface_name || type == shm::IfaceType::joints);
}

base::Error no_iface(const FaultOrder& fault) {
  return base::Error{"fault " + std::string(shm::row_of(fault.kind).name) + ": the world has no iface " + fault.iface};
}

// Wraps the device, unless it is wrapped already.
FaultyDevice& with_faults(std::unique_ptr<Device>& device, std::uint64_t seed) {
  auto* faulty = dynamic_cast<FaultyDevice*>(device.get());
  if (faulty != nullptr) return *faulty;
  auto made = std::make_unique<FaultyDevice>(std::move(device), seed);
  faulty = made.get();
  device = std::move(made);
  return *faulty;
}

}  // namespace

// Checks the faults of the options.
base::Result<void> Simulation::check_faults() const {
  for (const FaultOrder& fault : options_.faults) {
    if (!can_have_faults(fault.iface)) return no_iface(fault);
  }
  return {};
}

// Adds the faults of the options.
base::Result<void> Simulation::add_first_faults(std::unique_ptr<Device>& device) const {
  for (const FaultOrder& fault : options_.faults) {
    if (!is_named(*device, fault.iface)) continue;
    if (const auto added = with_faults(device, options_.seed).add(fault); !added) return added;
  }
  return {};
}

// Restores the faults of the options, and ends all others.
base::Result<void> Simulation::restore_faults() {
  for (auto& device : devices_) {
    auto* faulty = dynamic_cast<FaultyDevice*>(device.get());
    if (faulty == nullptr) continue;
    faulty->end([](const FaultOrder&) { return true; });
    for (const FaultOrder& fault : options_.faults) {
      if (!is_named(*device, fault.iface)) continue;
      if (const auto added = faulty->add(fault); !added) return added;
    }
  }
  return {};
}

bool Simulation::can_have_faults(std::string_view name) const {
  return std::ranges::any_of(devices_, [&](const auto& device) { return is_named(*device, name); });
}

base::Result<void> Simulation::add_fault(const FaultOrder& fault) {
  const auto place = std::ranges::find_if(devices_, [&](const auto& device) { return is_named(*device, fault.iface); });
  if (place == devices_.end()) return no_iface(fault);
  FaultyDevice& device = with_faults(*place, options_.seed);
  sort_devices();  // the device may be a new wrapper
  return device.replace(fault, time_);
}

std::size_t Simulation::end_faults(std::string_view iface_name, std::optional<shm::FaultKind> kind) {
  std::size_t count = 0;
  for (const auto& device : devices_) {
    auto* faulty = dynamic_cast<FaultyDevice*>(device.get());
    if (faulty == nullptr || !(iface_name.empty() || is_named(*device, iface_name))) continue;
    count += faulty->end([&](const FaultOrder& order) {
      const bool is_meant = iface_name.empty() || is_of(order.iface, iface_name);
      return is_meant && (!kind || order.kind == *kind) && order.until > time_;
    });
  }
  return count;
}

std::vector<FaultOrder> Simulation::faults() const {
  std::vector<FaultOrder> faults;
  for (const auto& device : devices_) {
    const auto* faulty = dynamic_cast<const FaultyDevice*>(device.get());
    if (faulty == nullptr) continue;
    for (const FaultOrder& order : faulty->orders()) {
      if (order.until > time_) faults.push_back(order);
    }
  }
  return faults;
}

}  // namespace sim
