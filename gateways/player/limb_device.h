// limb: moves the tip of a chain of joints to poses. The state and its motions are those of arms/limb.h, as in RTCLimb. One thread at a
// time.
#pragma once

#include "arms/limb.h"
#include "joint_devices.h"

namespace gateway {

class LimbDevice final : public JointDevice {
 public:
  using JointDevice::JointDevice;
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "position, approach and orientation of the tip, state"},
      {player::Type::request, 1, "power"},
      {player::Type::request, 2, "brakes"},
      {player::Type::request, 3, "geometry"},
      {player::Type::request, 4, "speed"},
      {player::Type::command, 1, "home"},
      {player::Type::command, 2, "stop"},
      {player::Type::command, 3, "pose or position of the tip"},
      {player::Type::command, 4, ""},
      {player::Type::command, 5, "distance along a direction"},
  });

 private:
  ServedTable served() const override { return table; }
  void show(const shm::Stamp& stamp) override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void do_command(std::uint8_t subtype, const std::string& payload) override;
  void begin() override;
  void step() override { note(limb_.step(part())); }
  void let_go() override { limb_.let_go(); }
  arms::Reply command(std::uint8_t subtype, const std::string& payload);

  arms::Limb limb_;
};

}  // namespace gateway
