// power: the battery of a robot. One thread at a time.
#pragma once

#include <array>

#include "device.h"

namespace gateway {

class Power final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::battery};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "voltage, charge in percent and joules, power (negative: taken), whether it is charged"},
      {player::Type::request, 1, "charging: the input connects the charger until the last client unsubscribes; the output is always on"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void on_unused() override;
  bool charge(bool is_on);

  bool is_charging_ = false;  // by this device
};

}  // namespace gateway
