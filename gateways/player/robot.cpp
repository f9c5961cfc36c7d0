#include "robot.h"

#include <algorithm>
#include <utility>

#include "device_kinds.h"

namespace gateway {

void Robot::arrange(const PortPlan& plan, const FindSource& find_source) {
  name_ = plan.name;
  std::vector<std::unique_ptr<Device>> before = std::exchange(devices_, {});
  for (const DevicePlan& wanted : plan.devices) {
    const auto known = std::find_if(before.begin(), before.end(), [&](const auto& one) { return one && one->address() == wanted.address; });
    auto device = known != before.end() ? std::move(*known) : make_device(wanted.address, port_, services_);
    if (!device) continue;
    device->choose(wanted.group);
    if (auto source = find_source(wanted.type, wanted.iface)) {
      auto companion = wanted.companion.empty() ? nullptr : find_source(companion_type(wanted.address.interface), wanted.companion);
      device->attach(std::move(source), std::move(companion));
    } else {
      device->detach();
    }
    devices_.push_back(std::move(device));
  }
  for (auto& device : before) {
    if (!device || !device->is_used()) continue;
    device->detach();
    devices_.push_back(std::move(device));
  }
}

void Robot::detach() {
  for (const auto& device : devices_) device->detach();
}

Device* Robot::find(const player::Address& address) const {
  const auto found = std::find_if(devices_.begin(), devices_.end(), [&](const auto& one) { return one->address() == address; });
  return found == devices_.end() ? nullptr : found->get();
}

std::vector<player::Address> Robot::devices() const {
  std::vector<player::Address> shown;
  for (const auto& device : devices_) {
    if (device->source()) shown.push_back(device->address());
  }
  return shown;
}

std::vector<std::string> Robot::shown() const {
  std::vector<std::string> words;
  for (const auto& device : devices_) {
    if (!device->source()) continue;
    words.push_back(player::to_text(device->address()) + "=" + device->source()->iface().name());
    if (device->companion()) words.back() += "+" + device->companion()->iface().name();
  }
  return words;
}

void Robot::leave(Client& client) {
  for (const auto& device : devices_) device->leave(client);
}

}  // namespace gateway
