// One camera of a world: takes pictures with a renderer and hands them out in the formats of sensors. One thread at a time.
//
// Pictures are the same for the same scene, poses, seed and time, whatever was taken before. Rows run from the top down, pixels from left
// to right, without padding. Colour: in the format of the definition (world/pixel_format.h), sRGB. Depth: one float [m] along the axis,
// native byte order, +infinity where nothing is between the clip planes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/lens.h"
#include "render/renderer.h"
#include "world/world_def.h"

namespace sim {

class Camera {
 public:
  enum class Output { color, depth, color_and_depth, marks, color_and_marks };

  // `seed`: of its noise.
  Camera(const CameraDef& def, Output output, std::uint64_t seed);

  void set_seed(std::uint64_t seed) { seed_ = seed; }
  const CameraDef& def() const { return def_; }
  Output output() const { return output_; }
  std::size_t color_bytes() const;  // of a picture in its format
  std::size_t pixels() const;

  // Pinhole model [pixel]; of a distorting lens before its distortion.
  double focal_length() const;
  Eigen::Vector2d principal_point() const;

  // `pose`: of the camera in the world. `time` [ns] only chooses the noise. `wanted`: within the camera's output; depth alone is cheaper.
  base::Result<void> take(Renderer& renderer, const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses,
                          const Eigen::Isometry3d& pose, std::int64_t time, Output wanted);
  base::Result<void> take(Renderer& renderer, const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses,
                          const Eigen::Isometry3d& pose, std::int64_t time) {
    return take(renderer, scene, poses, pose, time, output_);
  }

  // Of the last picture taken; each may be called several times.
  void write_color(std::span<std::uint8_t> out) const;
  // Of marks: temperatures as a thermal camera counts them, with its noise in K. `air` [K]: of what has no temperature of its own.
  void write_heat(const Scene& scene, double air, std::span<std::uint8_t> out) const;
  std::span<const std::uint8_t> rgba() const { return rgba_; }  // without noise
  std::span<const float> depth() const { return depth_; }
  // See render/marks.h. With colours they may be those of the first visual of each object.
  std::span<const std::uint32_t> marks() const { return marks_; }
  // x forward, y left, z up in the camera; NaN where there is none. Three floats a pixel.
  void write_points(std::span<float> out) const;

 private:
  base::Result<void> take_marks(Renderer& renderer, const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses,
                                View view, std::size_t index);
  // From the opacity of the colours, which is whole afterwards.
  void take_objects(const Scene& scene);
  void add_depth_noise();

  CameraDef def_;
  Output output_;
  std::uint64_t seed_;
  std::int64_t time_ = 0;
  std::optional<Lens> lens_;
  std::vector<std::uint8_t> rgba_, face_rgba_;
  std::vector<float> depth_, face_depth_;
  std::vector<std::uint32_t> marks_, face_marks_;
};

}  // namespace sim
