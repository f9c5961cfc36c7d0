// gps, imu and bumper. One thread at a time.
#pragma once

#include <array>

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
  static constexpr std::array shows{shm::IfaceType::gps, shm::IfaceType::ins};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1,
       "place, speed, course (clockwise from north), UTM in cm as client libraries read it; satellites are not simulated and 0"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

// Sends one of the five kinds of data, the one that was chosen last: at first calibrated values and Euler angles. The magnetic field is
// that of its companion, a magnetometer; a magnetometer alone is an imu too, whose other values are 0.
class Imu final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::imu, shm::IfaceType::magnetometer};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1,
       "one of the five kinds: calibrated values with Euler angles until a client chooses another, for all clients of the device; the "
       "field "
       "of a magnetometer [T]"},
      {player::Type::data, 2, ""},
      {player::Type::data, 3, ""},
      {player::Type::data, 4, ""},
      {player::Type::data, 5, ""},
      {player::Type::request, 1, "kind of data"},
      {player::Type::request, 2, "reset of the orientation: to 0, or to angles"},
      {player::Type::request, 3, ""},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void on_attach() override { turned_ = {0, 0, 0, 1, 0, 0, 0}; }
  void show(shm::ImuSample sample, Source* magnetometer);
  bool reset(const player::Pose3d& angles);
  std::uint8_t kind_ = 4;
  std::optional<player::Pose3d> asked_;    // of a reset, until the next sample
  shm::Pose turned_{0, 0, 0, 1, 0, 0, 0};  // what resets add before the orientation
};

// Each iface is a device with one bumper.
class Bumper final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::bumper};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "one bumper per iface"},
      {player::Type::request, 1, "geometry"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

}  // namespace gateway
