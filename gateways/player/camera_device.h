// camera: images as the iface has them, or as JPEG. One thread at a time.
#pragma once

#include <array>

#include "base/jpeg.h"
#include "device.h"
#include "protocol/payloads.h"

namespace gateway {

// Pixels as Player names them: colours in the order red, green, blue, mosaics as the colours that they stand for, 16 bits with the high
// byte first. Depths are whole millimetres in 16 bits, 0 where nothing is seen or it is further than that. Nothing for formats that are no
// picture, or when `data` is shorter than the head says.
std::optional<player::Image> to_image(const shm::FrameHead& head, std::span<const std::byte> data);

class Camera final : public Device {
 public:
  using Device::Device;
  static constexpr std::array shows{shm::IfaceType::camera, shm::IfaceType::depth};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1,
       "pictures as RGB888, MONO8 or MONO16, or as JPEG (property compression); mosaics as their colours; depths as MONO16 in millimetres, "
       "0: nothing there"},
      {player::Type::request, 1, "source"},
      {player::Type::request, 3, "picture"},
  });

 private:
  ServedTable served() const override { return table; }
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void on_attach() override;
  std::optional<player::PropertyValue> property(const std::string& key) const override;
  bool set_property(const player::DriverProperty& property) override;
  void compress(player::Image& image);

  std::string latest_;  // payload of the last picture, for those who ask for one
  bool has_complained_ = false;
  base::JpegEncoder encoder_;
  bool is_jpeg_ = false;
  int quality_ = 90;
};

}  // namespace gateway
