// laser, sonar and ranger (of either): send ranges, and report settings on request. One thread at a time.
#pragma once

#include <array>
#include <optional>

#include "device.h"
#include "scan_settings.h"

namespace gateway {

// What clients have chosen of a scanner holds for all clients of the device, until the last has let go of it.
class ScanDevice : public Device {
 public:
  using Device::Device;

 protected:
  ScanFilter& filter();
  // This scan is to be shown.
  bool is_due(const shm::Stamp& stamp);
  // False when the scanner can't.
  bool choose(const ScanSettings& wanted);
  void on_attach() override { filter_.reset(); }
  void on_unused() override { filter_.reset(); }

 private:
  std::optional<ScanFilter> filter_;
};

class Laser final : public ScanDevice {
 public:
  using ScanDevice::ScanDevice;
  static constexpr std::array shows{shm::IfaceType::laser};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "scan with intensities; of several layers the most level"},
      {player::Type::request, 1, "geometry"},
      {player::Type::request, 2, "set and get configuration"},
      {player::Type::request, 3, ""},
      {player::Type::request, 4, "power"},
      {player::Type::request, 5, "id"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void on_unused() override;
  std::string config();
  Answer set_config(const std::string& payload);
  std::uint32_t scans_ = 0;
  bool has_intensities_ = true;
};

class Sonar final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::sonar};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "ranges of all transducers"},
      {player::Type::request, 1, "geometry"},
      {player::Type::request, 2, "power"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
};

class Ranger final : public ScanDevice {
 public:
  using ScanDevice::ScanDevice;
  static constexpr std::array shows{shm::IfaceType::laser, shm::IfaceType::sonar};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "ranges of a laser, or of the sonars (the higher indexes)"},
      {player::Type::data, 3, "intensities when switched on"},
      {player::Type::request, 1, "geometry"},
      {player::Type::request, 4, "set and get configuration"},
      {player::Type::request, 5, ""},
      {player::Type::request, 2, "power"},
      {player::Type::request, 3, "intensities"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  bool is_sonar() const { return iface().type() == shm::IfaceType::sonar; }
  std::string geometry();
  player::RangerConfig config();
  Answer set_config(const std::string& payload);
  bool has_intensities_ = false;
};

}  // namespace gateway
