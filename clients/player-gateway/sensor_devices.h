// gps, imu and bumper. One thread at a time.
#pragma once

#include "device.h"

namespace gateway {

// Easting and northing [m] of the Universal Transverse Mercator zone that the place is in, WGS 84; latitude and longitude [rad].
struct Utm {
  double east = 0, north = 0;
};
Utm to_utm(double latitude, double longitude);

class Gps final : public Device {
 public:
  using Device::Device;

 private:
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

// Sends one of the five kinds of data, the one that was chosen last: at first calibrated values and Euler angles.
class Imu final : public Device {
 public:
  using Device::Device;

 private:
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  std::uint8_t kind_ = 4;
};

// Each iface is a device with one bumper.
class Bumper final : public Device {
 public:
  using Device::Device;

 private:
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

}  // namespace gateway
