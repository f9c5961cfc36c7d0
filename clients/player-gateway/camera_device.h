// camera: pictures as they come, not compressed. One thread at a time.
#pragma once

#include "device.h"
#include "protocol/payloads.h"

namespace gateway {

// Pixels as Player names them: colours in the order red, green, blue, mosaics as the colours that they stand for, 16 bits with the high
// byte first. Nothing for formats that are no picture, or when `data` is shorter than the head says.
std::optional<player::Image> to_image(const shm::FrameHead& head, std::span<const std::byte> data);

class Camera final : public Device {
 public:
  using Device::Device;

 private:
  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void on_attach() override;

  std::string latest_;  // payload of the last picture, for those who ask for one
  bool has_complained_ = false;
};

}  // namespace gateway
