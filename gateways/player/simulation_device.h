// simulation: poses of models by name, properties of time, pause and reset. It publishes no data. One thread at a time.
#pragma once

#include <array>

#include "device.h"

namespace gateway {

class Simulation final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::simulation};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::request, 1, "poses of models by name in 2D and 3D, get and set"},
      {player::Type::request, 2, ""},
      {player::Type::request, 3, ""},
      {player::Type::request, 4, ""},
      {player::Type::request, 5, "properties, get and set, see below"},
      {player::Type::request, 6, ""},
      {player::Type::command, 1, "pause (turns round)"},
      {player::Type::command, 2, "reset"},
      {player::Type::command, 3, ""},
  });

 private:
  ServedTable served() const override { return table; }
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) override;
  bool has_data() const override { return false; }
  std::optional<Answer> property(const std::string& payload);
  std::optional<Answer> set_property(const std::string& payload, const Later& later);
  bool has_refused_to_save_ = false;
};

}  // namespace gateway
