// laser, sonar and ranger (of either): ranges out, settings asked for. One thread at a time.
#pragma once

#include "device.h"

namespace gateway {

class Laser final : public Device {
 public:
  using Device::Device;

 private:
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  std::uint32_t scans_ = 0;
};

class Sonar final : public Device {
 public:
  using Device::Device;

 private:
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

class Ranger final : public Device {
 public:
  using Device::Device;

 private:
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  bool has_intensities_ = false;
};

}  // namespace gateway
