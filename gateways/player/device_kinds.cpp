#include "device_kinds.h"

#include <algorithm>
#include <array>

#include "analog_device.h"
#include "base/text.h"
#include "camera_device.h"
#include "drive_devices.h"
#include "estimate_devices.h"
#include "graphics_devices.h"
#include "joint_devices.h"
#include "limb_device.h"
#include "map_device.h"
#include "opaque_device.h"
#include "planner_device.h"
#include "point_cloud_device.h"
#include "power_device.h"
#include "range_devices.h"
#include "seen_devices.h"
#include "sensor_devices.h"
#include "simulation_device.h"
#include "stereo_device.h"

namespace gateway {
namespace {

template <class Class>
std::unique_ptr<Device> make(const player::Address& address, std::uint32_t robot, Services services) {
  return std::make_unique<Class>(address, robot, services);
}

template <class Class>
constexpr DeviceKind row(player::Interface interface) {
  return {interface, Class::shows, Class::table, &make<Class>};
}

using enum player::Interface;
constexpr std::array kinds{
    row<Position2d>(position2d),
    row<Position3d>(position3d),
    row<Laser>(laser),
    row<Sonar>(sonar),
    row<Camera>(camera),
    row<ActArray>(actarray),
    row<LimbDevice>(limb),
    row<Gripper>(gripper),
    row<Ptz>(ptz),
    row<Gps>(gps),
    row<Imu>(imu),
    row<Bumper>(bumper),
    row<Analog>(aio),
    row<Power>(power),
    row<Rfid>(rfid),
    row<Wifi>(wifi),
    row<Localize>(localize),
    row<Ranger>(ranger),
    row<PointCloud>(pointcloud3d),
    row<Fiducial>(fiducial),
    row<Blobfinder>(blobfinder),
    row<Simulation>(simulation),
    row<Map>(map),
    row<VectorMap>(vectormap),
    row<Planner>(planner),
    row<Stereo>(stereo),
    row<Opaque>(opaque),
    row<Digital>(dio),
    row<Graphics2d>(graphics2d),
    row<Graphics3d>(graphics3d),
};

std::string names_of(std::span<const shm::IfaceType> types) {
  std::vector<std::string> names;
  for (const shm::IfaceType type : types) names.emplace_back(shm::to_text(type));
  return base::join(names, ", ");
}

}  // namespace

std::span<const DeviceKind> device_kinds() { return kinds; }

const DeviceKind* find_kind(player::Interface interface) {
  const auto found = std::ranges::find(kinds, interface, &DeviceKind::interface);
  return found == kinds.end() ? nullptr : &*found;
}

bool can_show(player::Interface interface, shm::IfaceType type) {
  const DeviceKind* kind = find_kind(interface);
  return kind != nullptr && std::ranges::find(kind->shows, type) != kind->shows.end();
}

std::vector<player::Interface> interfaces_for(shm::IfaceType type) {
  std::vector<player::Interface> all;
  for (const DeviceKind& kind : kinds) {
    if (can_show(kind.interface, type)) all.push_back(kind.interface);
  }
  return all;
}

shm::IfaceType companion_type(player::Interface interface) {
  if (interface == stereo) return shm::IfaceType::camera;
  return interface == planner ? shm::IfaceType::truth : shm::IfaceType::magnetometer;
}

std::unique_ptr<Device> make_device(const player::Address& address, std::uint32_t robot, Services services) {
  const DeviceKind* kind = find_kind(address.interface);
  return kind != nullptr ? kind->make(address, robot, services) : nullptr;
}

std::string interface_table() {
  std::string text = "| interface | code | ifaces | data | requests | commands |\n| --- | --- | --- | --- | --- | --- |\n";
  const auto cell = [](const std::string& words) { return words.empty() ? std::string(" |") : " " + words + " |"; };
  for (const DeviceKind& kind : kinds) {
    text += "| `" + std::string(player::to_text(kind.interface)) + "` | " + std::to_string(static_cast<unsigned>(kind.interface)) + " |";
    text += cell(names_of(kind.shows));
    for (const auto type : {player::Type::data, player::Type::request, player::Type::command}) text += cell(describe(kind.served, type));
    text += '\n';
  }
  return text;
}

}  // namespace gateway
