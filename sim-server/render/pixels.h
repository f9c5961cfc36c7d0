// Converts images of the renderer to images of sensors: loops over whole images. Values; any thread.
#pragma once

#include <cstdint>
#include <span>

namespace sim {

// As many pixels as fit into both. `out` holds red, green, blue of each pixel.
void rgba_to_rgb(std::span<const std::uint8_t> rgba, std::span<std::uint8_t> out);
// Luminance of the sRGB values by Rec. 601: 0.299, 0.587, 0.114.
void rgba_to_mono(std::span<const std::uint8_t> rgba, std::span<std::uint8_t> out);

// Numbers that depend on the seed alone, in the order drawn. Good enough for sensor noise, made for speed.
class NoiseStream {
 public:
  explicit NoiseStream(std::uint64_t seed);

  // Adds Gaussian noise to every byte, `mean` and `deviation` as shares of full scale (0..1); clamps.
  void add(std::span<std::uint8_t> bytes, double mean, double deviation);
  // The same for values of 16 bits, low byte first.
  void add16(std::span<std::uint8_t> bytes, double mean, double deviation);
  // The same for metres; infinities stay.
  void add(std::span<float> metres, double mean, double deviation);

 private:
  std::uint32_t next();
  std::uint32_t state_[4];
};

// One number from several: for seeds of sensors and frames.
std::uint64_t mix_seed(std::uint64_t a, std::uint64_t b);

// x forward, y left, z up of each pixel of a depth picture, three floats a point; NaN where the depth is infinite. fx, fy, cx, cy: pinhole
// model in pixels, the centre of the first pixel being 0.5.
void depth_to_points(std::span<const float> depth, int width, double fx, double fy, double cx, double cy, std::span<float> out);

}  // namespace sim
