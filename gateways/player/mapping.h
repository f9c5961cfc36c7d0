// The devices of each port: one robot per port in world order, or the mapping of a file. Values; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "joint_group.h"
#include "protocol/message.h"
#include "shm/iface_types.h"

namespace gateway {

struct DevicePlan {
  player::Address address;
  shm::IfaceType type = shm::IfaceType::laser;
  std::string iface;
  std::string companion;  // the iface that it shows besides, of companion_type(); empty: none
  JointGroup group{};     // of a joints iface
};

inline constexpr std::string_view no_robot = "no robot";

struct PortPlan {
  std::uint16_t port = 0;  // 0: any free one
  std::string name;        // of the robots, for people
  std::vector<DevicePlan> devices;
};

// An iface as the simulator lists it, in world order.
struct ListedIface {
  shm::IfaceType type;
  std::string name;
  std::string model;
  std::vector<JointGroup> groups{};  // of a joints iface: what its joints are, without joints that nothing drives
};
// From the reply to a ListRequest. Ifaces of types that are not known are left out.
base::Result<std::vector<ListedIface>> parse_list(std::string_view json);

// A mapping file as written, or a configuration file of Player: see docs/player.md.
struct ConfiguredDevice {
  player::Address address;
  std::optional<shm::IfaceType> type;  // nothing: the first that the interface can show
  std::string iface;
  std::string companion;            // as in DevicePlan
  std::string model;                // where no iface has the name: the one of this model that the interface shows, by its number
  std::size_t which = 0;            // from 0
  std::vector<std::string> joints;  // empty: those that the simulator lists for the interface, else all
};
struct ConfiguredPort {
  std::uint16_t port = 0;
  std::vector<std::string> robots;
  std::vector<ConfiguredDevice> devices;
};
// Errors name the file, the line and what was expected. What a configuration file of Player asks for and is not served is logged.
base::Result<std::vector<ConfiguredPort>> read_config(const std::string& path);

// One port for each model of the world that has devices, from `first_port` (0: any free ones) on; one port without robot when there is
// none. simulation:0 is on each.
std::vector<PortPlan> plan_by_world(const std::vector<ListedIface>& ifaces, std::uint16_t first_port);
// The same in the order of ports that are open already and were given to these robots: each keeps its port, new ones come at the end, and
// what is gone leaves a port without devices. A port without robot is free for the first new one.
std::vector<PortPlan> keep_ports(std::vector<PortPlan> plans, const std::vector<std::string>& robots, std::uint16_t first_port);
// What of the file is there. Devices that are not are left out and, with `missing`, named.
std::vector<PortPlan> plan_by_config(const std::vector<ConfiguredPort>& ports, const std::vector<ListedIface>& ifaces,
                                     std::vector<std::string>& missing);

}  // namespace gateway
