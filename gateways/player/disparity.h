// Stereo vision of two cameras side by side: finds the pairs of cameras, and the disparities of a pair of images. Pure; any thread.
//
// The method is block matching: the 9 x 9 pixels around a pixel of the left image are compared with those around each position of the same
// row of the right image, up to a quarter of the width away. The least sum of absolute differences of grey wins, refined by the parabola
// through its neighbours. A pixel has no disparity if another position matches almost as well, as on walls of one colour, or if no position
// matches well.
#pragma once

#include <cstdint>
#include <vector>

#include "base/result.h"
#include "protocol/payloads.h"
#include "shm/iface_types.h"

namespace gateway {

struct StereoPair {
  double focal = 0, cx = 0, cy = 0;  // of the left camera [pixel]
  double base = 0;                   // from the left to the right camera [m]
};

// The error says what is no pair: they have the same size and focal length, show the same (colours, grey, temperatures, labels), look the
// same way (0.5 degrees), and the second is to the right of the first, at least 1 mm, and neither above nor before it by more than 2 % of
// that.
base::Result<StereoPair> stereo_pair(const shm::CameraInfo& left, const shm::CameraInfo& right);

// Of every `step`-th pixel of every `step`-th row, so that a row has at most 400.
struct Disparities {
  std::uint32_t width = 0, height = 0, step = 1;
  std::vector<std::uint16_t> sixteenths;  // of a pixel of this grid; 0: none
};
// Of two images of the same size, RGB888 or MONO8; empty for others.
Disparities disparities_of(const player::Image& left, const player::Image& right);

// MONO16, the high byte first.
player::Image to_image(const Disparities& disparities);
// In the frame of the left camera (x forward, y left, z up), with the colours of its image: at most `most` points, the first rows first.
std::vector<player::ColoredPoint> to_points(const Disparities& disparities, const StereoPair& pair, const player::Image& left,
                                            std::size_t most);

}  // namespace gateway
