// Which class shows what.
#include "camera_device.h"
#include "drive_devices.h"
#include "range_devices.h"
#include "sensor_devices.h"
#include "simulation_device.h"

namespace gateway {

std::unique_ptr<Device> make_device(const player::Address& address, std::uint32_t robot, Services services) {
  using enum player::Interface;
  switch (address.interface) {
    case position2d:
      return std::make_unique<Position2d>(address, robot, services);
    case position3d:
      return std::make_unique<Position3d>(address, robot, services);
    case laser:
      return std::make_unique<Laser>(address, robot, services);
    case sonar:
      return std::make_unique<Sonar>(address, robot, services);
    case ranger:
      return std::make_unique<Ranger>(address, robot, services);
    case simulation:
      return std::make_unique<Simulation>(address, robot, services);
    case camera:
      return std::make_unique<Camera>(address, robot, services);
    case gps:
      return std::make_unique<Gps>(address, robot, services);
    case imu:
      return std::make_unique<Imu>(address, robot, services);
    case bumper:
      return std::make_unique<Bumper>(address, robot, services);
    case player:
      break;
  }
  return nullptr;
}

}  // namespace gateway
