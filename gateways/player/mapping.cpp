#include "mapping.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "base/log.h"
#include "base/plain_file.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "base/yaml_keys.h"
#include "device_kinds.h"
#include "player_cfg.h"

namespace gateway {
namespace {

constexpr std::string_view simulation_iface = "world";

// Gives out the indexes of the devices of one port.
class Numbering {
 public:
  explicit Numbering(std::vector<DevicePlan>& devices) : devices_(devices) {
    for (const DevicePlan& one : devices) taken_.insert(one.address);
  }
  void add(player::Interface interface, const ListedIface& iface) {
    player::Address address{interface, 0};
    while (!taken_.insert(address).second) ++address.index;
    devices_.push_back({address, iface.type, iface.name, {}});
  }
  // A device for each group of joints.
  void add_groups(player::Interface interface, const ListedIface& iface) {
    for (const JointGroup& group : iface.groups) {
      if (group.interface != interface) continue;
      add(interface, iface);
      devices_.back().group = group;
    }
  }

 private:
  std::vector<DevicePlan>& devices_;
  std::set<player::Address> taken_;
};

std::string robot_of(const ListedIface& iface) { return iface.model.substr(0, iface.model.find("::")); }

// Joints that nothing drives, as those of casters and doors, are no device.
bool is_device(const ListedIface& iface) {
  if (iface.type == shm::IfaceType::joints) return !iface.groups.empty();
  return iface.type != shm::IfaceType::simulation && !interfaces_for(iface.type).empty();
}

// Several interfaces show what depth cameras see; their points are not shown twice.
bool has_points(const ListedIface& depth, const std::vector<ListedIface>& ifaces) {
  return std::any_of(ifaces.begin(), ifaces.end(),
                     [&](const ListedIface& one) { return one.type == shm::IfaceType::points && one.name == depth.name; });
}

std::vector<ListedIface> ifaces_of(const std::string& robot, shm::IfaceType type, const std::vector<ListedIface>& ifaces) {
  std::vector<ListedIface> found;
  for (const ListedIface& iface : ifaces) {
    if (iface.type == type && robot_of(iface) == robot) found.push_back(iface);
  }
  return found;
}

// The two cameras of each multicamera sensor that has two, the left one first.
std::vector<std::pair<ListedIface, ListedIface>> stereo_pairs(const std::string& robot, const std::vector<ListedIface>& ifaces) {
  std::vector<std::pair<std::string, std::vector<ListedIface>>> sensors;
  for (const ListedIface& iface : ifaces_of(robot, shm::IfaceType::camera, ifaces)) {
    const std::string sensor = iface.name.substr(0, iface.name.rfind("::"));
    if (sensor == iface.model || iface.name.ends_with("_map")) continue;  // a camera alone, or the maps of a segmentation camera
    const auto known = std::ranges::find(sensors, sensor, &std::pair<std::string, std::vector<ListedIface>>::first);
    (known == sensors.end() ? sensors.emplace_back(sensor, std::vector<ListedIface>()) : *known).second.push_back(iface);
  }
  std::vector<std::pair<ListedIface, ListedIface>> pairs;
  for (auto& [sensor, eyes] : sensors) {
    if (eyes.size() != 2) continue;
    if (eyes[1].name.find("left", sensor.size()) != std::string::npos) std::swap(eyes[0], eyes[1]);
    pairs.emplace_back(eyes[0], eyes[1]);
  }
  return pairs;
}

// Those that show more than one robot has, or show again what another device shows: on ports that name them.
constexpr auto named_only = std::to_array<player::Interface>(
    {player::Interface::simulation, player::Interface::map, player::Interface::vectormap, player::Interface::planner,
     player::Interface::opaque, player::Interface::dio, player::Interface::graphics2d, player::Interface::graphics3d});
bool is_named_only(player::Interface interface) { return std::ranges::find(named_only, interface) != named_only.end(); }
// Of these, what shows the whole world.
bool is_of_world(player::Interface interface) {
  return interface != player::Interface::simulation && can_show(interface, shm::IfaceType::simulation);
}

// All devices of a model, each interface numbered in world order. The first magnetometer is part of the first imu, and so on; those that
// are left are devices of their own.
void add_robot(const std::string& robot, const std::vector<ListedIface>& ifaces, std::vector<DevicePlan>& devices) {
  const auto imus = ifaces_of(robot, shm::IfaceType::imu, ifaces), magnetometers = ifaces_of(robot, shm::IfaceType::magnetometer, ifaces);
  Numbering numbering(devices);
  for (const DeviceKind& kind : device_kinds()) {
    if (is_named_only(kind.interface)) continue;
    if (kind.interface == player::Interface::stereo) {
      for (const auto& [left, right] : stereo_pairs(robot, ifaces)) {
        numbering.add(kind.interface, left);
        devices.back().companion = right.name;
      }
      continue;
    }
    for (const shm::IfaceType type : kind.shows) {
      std::size_t count = 0;
      for (const ListedIface& iface : ifaces_of(robot, type, ifaces)) {
        const std::size_t which = count++;
        if (type == shm::IfaceType::magnetometer && which < imus.size()) continue;
        if (kind.interface == player::Interface::pointcloud3d && type == shm::IfaceType::depth && has_points(iface, ifaces)) continue;
        if (type == shm::IfaceType::joints) {
          numbering.add_groups(kind.interface, iface);
          continue;
        }
        numbering.add(kind.interface, iface);
        if (type == shm::IfaceType::imu && which < magnetometers.size()) devices.back().companion = magnetometers[which].name;
      }
    }
  }
}

void add_simulation(std::vector<DevicePlan>& devices) {
  const player::Address address{player::Interface::simulation, 0};
  if (std::none_of(devices.begin(), devices.end(), [&](const DevicePlan& one) { return one.address == address; }))
    devices.push_back({address, shm::IfaceType::simulation, std::string(simulation_iface), {}});
}

// ---- the file ----

// Thrown by the readers below, caught in read_config.
struct Wrong {
  YAML::Mark mark;
  std::string what;
};

std::string text_of(const YAML::Node& node, const char* what) {
  if (!node.IsScalar()) throw Wrong{node.Mark(), std::string("expected ") + what};
  return node.as<std::string>();
}

std::uint16_t port_of(const YAML::Node& node) {
  const auto text = text_of(node, "a port");
  const auto port = base::parse_integer(text);
  if (!port || *port < 0 || *port > 65535) throw Wrong{node.Mark(), "port must be a number from 0 to 65535, got " + base::in_quotes(text)};
  return static_cast<std::uint16_t>(*port);
}

// An interface that Player has but not this gateway is no misspelling.
std::string why_not_served(const std::string& name) {
  std::vector<std::string> served;
  for (const DeviceKind& kind : device_kinds()) served.emplace_back(player::to_text(kind.interface));
  if (player::is_interface_name(name))
    return base::in_quotes(name) + " is an interface of Player that is not served here; served are " + base::join(served, ", ");
  const auto meant = base::suggestion(name, served);
  return base::in_quotes(name) + " is no interface of Player" + (meant.empty() ? "; expected one of " + base::join(served, ", ") : meant);
}

player::Address address_of(const YAML::Node& node) {
  const auto text = text_of(node, "INTERFACE:INDEX");
  const auto colon = text.find(':');
  const auto name = text.substr(0, colon);
  const auto interface = player::parse_interface(name);
  if (!interface && !name.empty()) throw Wrong{node.Mark(), why_not_served(name)};
  const auto index = colon == std::string::npos ? std::optional<std::int64_t>(0) : base::parse_integer(text.substr(colon + 1));
  if (!interface || *interface == player::Interface::player || !index || *index < 0 || *index > 65535)
    throw Wrong{node.Mark(), "expected INTERFACE:INDEX as in laser:0, got " + base::in_quotes(text)};
  return {*interface, static_cast<std::uint16_t>(*index)};
}

ConfiguredDevice device_of(const YAML::Node& key, const YAML::Node& value) {
  ConfiguredDevice device;
  device.address = address_of(key);
  const bool is_stereo = device.address.interface == player::Interface::stereo;
  const bool is_pair = (is_stereo || device.address.interface == player::Interface::imu) && value.IsSequence() && value.size() == 2;
  if (is_stereo && !is_pair)
    throw Wrong{value.Mark(), "stereo: expected a left and a right camera, as in [mast::eyes::left, mast::eyes::right]"};
  const bool has_joints = can_show(device.address.interface, shm::IfaceType::joints) && value.IsSequence() && value.size() > 1;
  device.iface = text_of(is_pair || has_joints ? value[0] : value, "the name of an iface");
  for (std::size_t i = 1; has_joints && i < value.size(); ++i) device.joints.push_back(text_of(value[i], "the name of a joint"));
  if (is_pair) device.companion = text_of(value[1], "the name of a second iface");
  // "sonar:pioneer::sonar": one colon ends a type, two separate names.
  const auto colon = device.iface.find(':');
  if (colon != std::string::npos && device.iface.compare(colon, 2, "::") != 0) {
    device.type = shm::parse_type(device.iface.substr(0, colon));
    if (!device.type || !can_show(device.address.interface, *device.type))
      throw Wrong{value.Mark(),
                  player::to_text(device.address) + " can't show an iface of type " + base::in_quotes(device.iface.substr(0, colon))};
    device.iface.erase(0, colon + 1);
  }
  return device;
}

ConfiguredPort configured_port(const YAML::Node& node) {
  if (!node.IsMap()) throw Wrong{node.Mark(), "expected a port with robots or devices"};
  ConfiguredPort port;
  bool has_port = false;
  for (const auto& entry : node) {
    const auto key = text_of(entry.first, "port, robots or devices");
    if (key == "port") {
      port.port = port_of(entry.second);
      has_port = true;
    } else if (key == "robots") {
      if (!entry.second.IsSequence()) throw Wrong{entry.second.Mark(), "robots: expected a list of models"};
      for (const auto& robot : entry.second) port.robots.push_back(text_of(robot, "the name of a model"));
    } else if (key == "devices") {
      if (!entry.second.IsMap()) throw Wrong{entry.second.Mark(), "devices: expected INTERFACE:INDEX: iface"};
      for (const auto& device : entry.second) {
        port.devices.push_back(device_of(device.first, device.second));
        const auto& address = port.devices.back().address;
        if (std::count_if(port.devices.begin(), port.devices.end(), [&](const auto& one) { return one.address == address; }) > 1)
          throw Wrong{device.first.Mark(), player::to_text(address) + " appears twice"};
      }
    } else {
      throw Wrong{entry.first.Mark(), "expected port, robots or devices, got " + base::in_quotes(key)};
    }
  }
  if (!has_port) throw Wrong{node.Mark(), "port is missing"};
  return port;
}

std::vector<ConfiguredPort> configured_ports(const YAML::Node& root) {
  if (!root.IsMap() || root.size() != 1 || !root["ports"] || !root["ports"].IsSequence())
    throw Wrong{root.Mark(), "expected a list called ports and nothing else"};
  std::vector<ConfiguredPort> ports;
  for (const auto& node : root["ports"]) {
    ports.push_back(configured_port(node));
    const auto number = ports.back().port;
    if (number != 0 && std::count_if(ports.begin(), ports.end(), [&](const auto& one) { return one.port == number; }) > 1)
      throw Wrong{node.Mark(), "port " + std::to_string(number) + " appears twice"};
  }
  if (ports.empty()) throw Wrong{root.Mark(), "there is no port"};
  return ports;
}

}  // namespace

namespace {

// What the simulator calls groups of joints.
constexpr auto joint_groups = std::to_array<std::pair<std::string_view, player::Interface>>({
    {"array", player::Interface::actarray},
    {"chain", player::Interface::limb},
    {"gripper", player::Interface::gripper},
    {"pan_tilt", player::Interface::ptz},
});

std::vector<JointGroup> groups_of(const nlohmann::json& iface) {
  std::vector<JointGroup> groups;
  for (const auto& one : iface.value("groups", nlohmann::json::array())) {
    const auto kind = std::ranges::find(joint_groups, one.value("kind", ""), &std::pair<std::string_view, player::Interface>::first);
    if (kind != joint_groups.end() && can_show(kind->second, shm::IfaceType::joints))
      groups.push_back({kind->second, one.value("joints", std::vector<std::string>()), one.value("field_of_view", 0.0)});
  }
  return groups;
}

// What the file names, else what the simulator has found.
JointGroup group_of(const ConfiguredDevice& device, const ListedIface& iface) {
  const auto found = std::ranges::find(iface.groups, device.address.interface, &JointGroup::interface);
  JointGroup group = found == iface.groups.end() ? JointGroup{.interface = device.address.interface} : *found;
  if (!device.joints.empty() && device.joints != group.joints) group = {device.address.interface, device.joints, 0};
  return group;
}

}  // namespace

base::Result<std::vector<ListedIface>> parse_list(std::string_view json) {
  const auto list = nlohmann::json::parse(json, nullptr, false);
  if (!list.is_object() || !list.contains("ifaces")) return base::Error{"the simulator's list of ifaces can't be read"};
  std::vector<ListedIface> ifaces;
  for (const auto& one : list["ifaces"]) {
    const auto type = shm::parse_type(one.value("type", ""));
    if (type) ifaces.push_back({*type, one.value("name", ""), one.value("model", ""), groups_of(one)});
  }
  return ifaces;
}

base::Result<std::vector<ConfiguredPort>> read_config(const std::string& path) {
  if (const auto problem = base::file_problem(path); !problem.empty())
    return base::Error{"mapping " + base::in_quotes(path) + ": " + problem};
  try {
    if (is_of_player(path)) {
      std::vector<std::string> notes;
      auto ports = read_player_config(path, notes);
      for (const std::string& note : notes) base::log(base::Level::warn, "player-gateway", "{}", note);
      return ports;
    }
    const auto root = yaml::load_file(path);
    return configured_ports(root);
  } catch (const Wrong& wrong) {
    return base::Error{path + ":" + std::to_string(wrong.mark.line + 1) + ": " + wrong.what};
  } catch (const YAML::BadFile&) {
    return base::Error{"mapping " + base::in_quotes(path) + " cannot be read"};
  } catch (const YAML::Exception& wrong) {
    return base::Error{path + ":" + std::to_string(wrong.mark.line + 1) + ": " + wrong.msg};
  }
}

std::vector<PortPlan> plan_by_world(const std::vector<ListedIface>& ifaces, std::uint16_t first_port) {
  std::vector<std::string> robots;
  for (const ListedIface& iface : ifaces) {
    if (is_device(iface) && std::find(robots.begin(), robots.end(), robot_of(iface)) == robots.end()) robots.push_back(robot_of(iface));
  }
  std::vector<PortPlan> ports;
  for (const std::string& robot : robots) {
    const std::size_t port = first_port == 0 ? 0 : first_port + ports.size();
    if (port > 65535) break;
    ports.push_back({static_cast<std::uint16_t>(port), robot, {}});
    add_robot(robot, ifaces, ports.back().devices);
  }
  if (ports.empty()) ports.push_back({first_port, std::string(no_robot), {}});
  for (PortPlan& port : ports) add_simulation(port.devices);
  return ports;
}

std::vector<PortPlan> keep_ports(std::vector<PortPlan> plans, const std::vector<std::string>& robots, std::uint16_t first_port) {
  std::vector<PortPlan> kept;
  for (const std::string& robot : robots) {
    const auto found = std::find_if(plans.begin(), plans.end(), [&](const PortPlan& one) { return one.name == robot; });
    if (found == plans.end()) {
      kept.push_back({0, robot, {}});
      continue;
    }
    kept.push_back(std::move(*found));
    plans.erase(found);
  }
  for (PortPlan& plan : plans) {
    if (plan.name == no_robot) continue;  // the last robot is gone
    const auto unused = std::find_if(kept.begin(), kept.end(), [](const PortPlan& one) { return one.name == no_robot; });
    const std::size_t port = first_port == 0 ? 0 : first_port + kept.size();
    if (unused != kept.end()) {
      *unused = std::move(plan);
    } else if (port <= 65535) {
      plan.port = static_cast<std::uint16_t>(port);
      kept.push_back(std::move(plan));
    }
  }
  return kept;
}

namespace {
bool is_there(shm::IfaceType type, const std::string& name, const std::vector<ListedIface>& ifaces) {
  return std::any_of(ifaces.begin(), ifaces.end(), [&](const ListedIface& one) { return one.type == type && one.name == name; });
}

// Of a configuration file of Player, which cannot name two cameras.
bool is_stereo_of_model(const ConfiguredDevice& device) {
  return device.address.interface == player::Interface::stereo && device.companion.empty();
}

// Where the robot is by the world.
std::string truth_of(const ListedIface& drive, const std::vector<ListedIface>& ifaces) {
  return is_there(shm::IfaceType::truth, drive.model, ifaces) ? drive.model : robot_of(drive);
}

// Those of a model that an interface shows, in the order in which its devices are numbered.
std::vector<const ListedIface*> candidates(const std::string& model, player::Interface interface, const std::vector<ListedIface>& ifaces) {
  std::vector<const ListedIface*> found;
  const DeviceKind* kind = find_kind(interface);
  for (const shm::IfaceType type : kind->shows) {
    for (const ListedIface& iface : ifaces) {
      if (iface.type != type || robot_of(iface) != model) continue;
      const bool is_group = type == shm::IfaceType::joints;
      const auto groups = std::ranges::count(iface.groups, interface, &JointGroup::interface);
      found.insert(found.end(), is_group ? static_cast<std::size_t>(groups) : 1, &iface);
    }
  }
  return found;
}

// By its name, also with parts behind it that no iface has; else by its model and number. Null: not there.
const ListedIface* find_iface(const ConfiguredDevice& device, const std::vector<ListedIface>& ifaces) {
  std::string name = device.iface;
  while (!name.empty()) {
    const auto found = std::find_if(ifaces.begin(), ifaces.end(), [&](const ListedIface& one) {
      return one.name == name && (device.type ? one.type == *device.type : can_show(device.address.interface, one.type));
    });
    if (found != ifaces.end()) return &*found;
    const auto end = name.rfind("::");
    name.resize(device.model.empty() || end == std::string::npos ? 0 : end);
  }
  if (device.model.empty() || device.address.interface == player::Interface::simulation) return nullptr;
  const auto all = candidates(device.model, device.address.interface, ifaces);
  return device.which < all.size() ? all[device.which] : nullptr;
}

// "laser:0 of port 6665".
std::string of_port(const ConfiguredDevice& device, const ConfiguredPort& port) {
  return player::to_text(device.address) + " of port " + std::to_string(port.port);
}

// Why no iface of this name is one of these types: it is of another type, or not there.
std::string why_not_found(const std::string& name, std::span<const shm::IfaceType> wanted, const std::vector<ListedIface>& ifaces) {
  std::vector<std::string> types, expected;
  for (const ListedIface& one : ifaces) {
    if (one.name == name) types.emplace_back(shm::to_text(one.type));
  }
  for (const shm::IfaceType type : wanted) expected.emplace_back(shm::to_text(type));
  if (types.empty()) {
    std::vector<std::string> names;
    for (const ListedIface& one : ifaces) {
      if (std::ranges::find(wanted, one.type) != wanted.end()) names.push_back(one.name);
    }
    return "no " + (expected.size() == 1 ? expected.front() : "iface") + " " + base::in_quotes(name) + base::suggestion(name, names);
  }
  return "iface " + base::in_quotes(name) + " is of type " + base::join(types, ", ") + "; expected " + base::join(expected, ", ");
}

std::string why_missing(const ConfiguredDevice& device, const std::vector<ListedIface>& ifaces) {
  const bool is_of_model = !device.model.empty() && (device.iface.empty() || device.iface == device.model);
  if (is_of_model) return "no such device of model " + base::in_quotes(device.model);
  if (device.type) return why_not_found(device.iface, std::span(&*device.type, 1), ifaces);
  return why_not_found(device.iface, find_kind(device.address.interface)->shows, ifaces);
}
}  // namespace

std::vector<PortPlan> plan_by_config(const std::vector<ConfiguredPort>& ports, const std::vector<ListedIface>& ifaces,
                                     std::vector<std::string>& missing) {
  std::vector<PortPlan> plans;
  for (const ConfiguredPort& port : ports) {
    PortPlan plan{port.port, base::join(port.robots, " "), {}};
    for (const ConfiguredDevice& device : port.devices) {
      const ListedIface* found = find_iface(device, ifaces);
      const auto pairs = is_stereo_of_model(device) ? stereo_pairs(device.model, ifaces) : decltype(stereo_pairs("", ifaces))();
      if (device.iface == simulation_iface && is_of_world(device.address.interface)) {
        plan.devices.push_back({device.address, shm::IfaceType::simulation, device.iface, {}});  // which is in no list
      } else if (device.which < pairs.size()) {
        const auto& [left, right] = pairs[device.which];
        plan.devices.push_back({device.address, left.type, left.name, right.name});
      } else if (found != nullptr && !is_stereo_of_model(device)) {
        plan.devices.push_back({device.address, found->type, found->name, device.companion, group_of(device, *found)});
        if (device.address.interface == player::Interface::planner) plan.devices.back().companion = truth_of(*found, ifaces);
        const auto type = companion_type(device.address.interface);
        if (!device.companion.empty() && !is_there(type, device.companion, ifaces))
          missing.push_back(of_port(device, port) + ": " + why_not_found(device.companion, std::span(&type, 1), ifaces));
      } else if (device.address.interface != player::Interface::simulation) {
        missing.push_back(of_port(device, port) + ": " + why_missing(device, ifaces));
      }
    }
    for (const std::string& robot : port.robots) {
      if (std::none_of(ifaces.begin(), ifaces.end(), [&](const ListedIface& one) { return is_device(one) && robot_of(one) == robot; }))
        missing.push_back("port " + std::to_string(port.port) + ": no robot " + base::in_quotes(robot));
      add_robot(robot, ifaces, plan.devices);
    }
    add_simulation(plan.devices);
    plans.push_back(std::move(plan));
  }
  return plans;
}

}  // namespace gateway
