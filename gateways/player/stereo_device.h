// stereo: the images of two cameras of one sensor, of the same time. One thread at a time.
#pragma once

#include <array>

#include "device.h"

namespace gateway {

// The companion is the right camera. Disparity and points are those of disparity.h; cameras that are no pair are rejected.
class Stereo final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::camera};
  static constexpr std::array table = std::to_array<Served>(
      {{player::Type::data, 1,
        "left and right picture of one time, disparity (MONO16, sixteenths of a pixel, 0: none) and points in the left camera"}});

  bool shows_companion() const override { return true; }

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t, const std::string&, const Later&) override { return nack(); }
  base::Result<void> check() const override;
  void on_attach() override { shown_.reset(); }

  std::optional<std::uint64_t> shown_;  // sequence number of the left image
  bool has_complained_ = false;
};

}  // namespace gateway
