// Lenses other than pinholes: composes the image of a distorting or wide lens from one or more flat views. A value; any
// thread.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/renderer.h"
#include "world/world_def.h"

namespace sim {

class Lens {
 public:
  // Empty when the camera is a plain pinhole.
  static std::optional<Lens> make(const CameraDef& camera);

  // The views to draw, at a camera that stands in `pose`.
  std::vector<View> views(const Eigen::Isometry3d& pose) const;
  // Fills the picture from the view of that index (4 bytes a pixel); pixels beyond the lens stay black.
  void map_rgba(std::size_t view, std::span<const std::uint8_t> source, std::span<std::uint8_t> out) const;
  // The nearest mark, which knows no between; 0 beyond the lens.
  void map_marks(std::size_t view, std::span<const std::uint32_t> source, std::span<std::uint32_t> out) const;
  // The nearest depth; for lenses with one view only.
  void map_depth(std::span<const float> source, std::span<float> out) const;
  // x forward, y left, z up in the camera for each pixel of a picture that map_depth filled; NaN where its depth is infinite.
  void points(std::span<const float> depth, std::span<float> out) const;

 private:
  struct Face {
    Eigen::Matrix3d turn;  // from the face to the camera
    double left, right, bottom, top;
    int width, height;
  };
  struct Source {
    std::int16_t face = -1;
    float x = 0, y = 0;  // in pixels of the face, the centre of the first pixel being 0
  };
  void make_brown(const CameraDef& camera);
  void make_wide(const CameraDef& camera);
  void assign(std::size_t pixel, const Eigen::Vector3d& direction);

  int width_ = 0, height_ = 0;
  double near_ = 0.1, far_ = 100;
  std::vector<Face> faces_;
  std::vector<Source> sources_;
};

}  // namespace sim
