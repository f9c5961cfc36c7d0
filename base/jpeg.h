// Images to JPEG and back, by libjpeg-turbo. Rows from top to bottom. JpegEncoder: one thread at a time per object; the functions: any
// thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace base {

enum class JpegPixels { rgb, bgr, rgba, bgra, grey };  // a byte per colour; alpha is dropped by the encoder

std::size_t bytes_per_pixel(JpegPixels kind);

class JpegEncoder {
 public:
  JpegEncoder();
  ~JpegEncoder();
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;

  // `stride`: bytes from row to row, 0 for rows without gaps. `quality`: 1 to 100. Colour is subsampled 4:2:0.
  // The result is valid until the next call. Fails if the quality or the size is out of range, or `pixels` holds fewer rows than `height`.
  Result<std::span<const std::uint8_t>> encode(std::span<const std::uint8_t> pixels, int width, int height, std::size_t stride,
                                               JpegPixels kind, int quality);

 private:
  void* handle_;
  std::uint8_t* buffer_ = nullptr;
  unsigned long capacity_ = 0;
};

struct DecodedJpeg {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // of the kind asked for, without gaps
};

// Fails for data that is no JPEG, and for images with more than `max_side` pixels on a side or 2^28 pixels in all. Truncated data gives the
// rows that can be decoded, as libjpeg does.
Result<DecodedJpeg> decode_jpeg(std::span<const std::uint8_t> bytes, JpegPixels kind, int max_side = 16384);

}  // namespace base
