// position2d and position3d: odometry out, velocities in. One thread at a time.
#pragma once

#include "device.h"

namespace gateway {

// The robot obeys the latest command; it stops when the client that gave it lets go of the device or vanishes.
class Drive : public Device {
 public:
  using Device::Device;
  ~Drive() override;

 protected:
  void command_velocity(Client& client, std::span<const double> values);
  void forget(Client& client) final;
  std::optional<Answer> switch_motors(const std::string& payload, const Later& later);

 private:
  Client* commander_ = nullptr;
};

class Position2d final : public Drive {
 public:
  using Drive::Drive;

 private:
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) override;
};

class Position3d final : public Drive {
 public:
  using Drive::Drive;

 private:
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) override;
};

}  // namespace gateway
