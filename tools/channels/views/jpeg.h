// Frames of cameras as JPEG, by libjpeg-turbo. One thread at a time per object.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shm/client.h"

namespace channels {

class Jpeg {
 public:
  Jpeg();
  ~Jpeg();
  Jpeg(const Jpeg&) = delete;
  Jpeg& operator=(const Jpeg&) = delete;

  // Pictures of eight bits a colour; mosaics of colour filters, depth and 16 bits of grey stay what they are.
  static bool takes(shm::Format format);
  // Valid until the next call; nothing when the frame is smaller than its head says.
  std::optional<std::span<const std::uint8_t>> encode(const shm::HeldFrame& frame);

 private:
  void* handle_;
  unsigned char* buffer_ = nullptr;
  unsigned long capacity_ = 0;
};

}  // namespace channels
