// The interfaces of Player that are served: a row for each says which ifaces it shows, what it serves and which class does it. Values; any
// thread.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "device.h"
#include "protocol/message.h"
#include "served.h"
#include "shm/iface_types.h"

namespace gateway {

struct DeviceKind {
  player::Interface interface;
  std::span<const shm::IfaceType> shows;  // the usual type first: its ifaces have the lower indexes
  ServedTable served;
  std::unique_ptr<Device> (*make)(const player::Address& address, std::uint32_t robot, Services services);
};

// In the order in which the devices of a robot are listed.
std::span<const DeviceKind> device_kinds();
// Nothing for interfaces that are not served.
const DeviceKind* find_kind(player::Interface interface);

// Interfaces that can show an iface of this type.
std::vector<player::Interface> interfaces_for(shm::IfaceType type);
bool can_show(player::Interface interface, shm::IfaceType type);

// Of the second iface of a device: the magnetometer of an imu, the other camera of a stereo, the true pose of the robot of a planner.
shm::IfaceType companion_type(player::Interface interface);

// Nothing for interfaces that are not served. What is attached must be of a type that the interface can show.
std::unique_ptr<Device> make_device(const player::Address& address, std::uint32_t robot, Services services);

// The table of docs/player.md, in Markdown.
std::string interface_table();

}  // namespace gateway
