// Pictures of a running world for `screenshot`. This file is the place where a renderer is put in: draw_picture() chooses who draws the
// world; trails and laser fans are laid over whatever was drawn. Without a renderer the world is drawn with rays, which needs no GL: every
// collision shape in the colour of its link, lit by one light, with a metre grid on level ground. The stepping thread only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "server/simulation.h"
#include "shm/requests.h"

namespace sim {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // rows from the top
};

// How points of the world come onto the picture, and rays out of it.
class View {
 public:
  // From above; `across` metres fit into the width.
  static View top(const Eigen::Vector3d& center, double across, double height, int width_px, int height_px);
  // The camera looks along x, z is up.
  static View camera(const Eigen::Isometry3d& pose, double hfov, int width_px, int height_px);

  // False when the point is behind the camera.
  bool project(const Eigen::Vector3d& point, Eigen::Vector2d& pixel) const;
  void ray(double px, double py, Eigen::Vector3d& origin, Eigen::Vector3d& direction) const;
  bool is_top() const { return is_top_; }

 private:
  bool is_top_ = true;
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  double scale_ = 1;  // top: pixels per metre; camera: focal length [px]
  double width_ = 0, height_ = 0;
};

// The view that a request asks for. Fails when the model to follow does not exist.
base::Result<View> view_of(const Simulation& simulation, const shm::ScreenshotRequest& request);

base::Result<Image> draw_picture(Simulation& simulation, const shm::ScreenshotRequest& request);

// Written beside and renamed, so that nobody sees half a file.
base::Result<void> write_png(const Image& image, const std::filesystem::path& path);

}  // namespace sim
