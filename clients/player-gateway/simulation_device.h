// simulation: poses of models by name, properties of time, pause and reset. Has no data. One thread at a time.
#pragma once

#include "device.h"

namespace gateway {

class Simulation final : public Device {
 public:
  using Device::Device;

 private:
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) override;
  bool has_data() const override { return false; }
  std::optional<Answer> property(const std::string& payload);
};

}  // namespace gateway
