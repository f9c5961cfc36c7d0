// aio: measuring devices that Player has no interface for, as analogue inputs: altimeter, air pressure, force and torque, air speed, sound,
// wheels. One thread at a time.
#pragma once

#include <array>

#include "device.h"

namespace gateway {

// The values of a sample in the order of its fields, in SI units instead of volts.
class Analog final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::altimeter, shm::IfaceType::air_pressure, shm::IfaceType::force_torque,
                                    shm::IfaceType::air_speed, shm::IfaceType::dvl,          shm::IfaceType::wheels};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1,
       "measured values instead of voltages: height and climb [m, m/s]; pressure [Pa]; force x y z and torque x y z [N, N m]; dynamic "
       "pressure [Pa] and temperature [K] of an air speed sensor; "
       "velocity x y z [m/s] and range [m] by sound; angles of wheels [rad]"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

}  // namespace gateway
