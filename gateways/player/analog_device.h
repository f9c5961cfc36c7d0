// aio: measuring devices that Player has no interface for, as analogue inputs: altimeter, air pressure, force and torque. One thread at a
// time.
#pragma once

#include <array>

#include "device.h"

namespace gateway {

// The values of a sample in the order of its fields, in SI units instead of volts.
class Analog final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::altimeter, shm::IfaceType::air_pressure, shm::IfaceType::force_torque};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1,
       "measured values instead of voltages: height and climb [m, m/s]; pressure [Pa]; force x y z and torque x y z [N, N m]"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

}  // namespace gateway
