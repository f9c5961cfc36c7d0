// Images as JPEG, by libjpeg-turbo. One thread at a time per object.
#pragma once

#include <base/result.h>

#include <cstdint>
#include <span>

namespace iface {

class JpegEncoder {
 public:
  JpegEncoder();
  ~JpegEncoder();
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;

  enum class Pixels { rgb, bgr, rgba, bgra, grey };

  // Rows from top to bottom without gaps, a byte per colour; quality 1..100. The result stays valid until the next call.
  base::Result<std::span<const unsigned char>> encode(std::span<const std::byte> pixels, int width, int height, Pixels kind, int quality);

 private:
  void* handle_;
  unsigned char* buffer_ = nullptr;
  unsigned long capacity_ = 0;
};

}  // namespace iface
