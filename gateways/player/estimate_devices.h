// localize, rfid and wifi: estimates of a robot's surroundings without a scan. One thread at a time.
#pragma once

#include <array>
#include <vector>

#include "device.h"

namespace gateway {

class Localize final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::localization};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "hypotheses of the pose in the world, the best first"},
      {player::Type::request, 2, "the same as particles"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;

  std::vector<player::Hypothesis> latest_;
};

class Rfid final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::rfid};
  static constexpr std::array table =
      std::to_array<Served>({{player::Type::data, 1, "tags in reach, the nearest first; their ids as text"}});

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

class Wifi final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::wireless};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1,
       "transmitters that are received, the strongest first: name in place of the MAC address, ESSID, frequency [MHz], level [dBm + 256]"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

}  // namespace gateway
