#include "point_cloud_device.h"

#include <cmath>
#include <cstring>

namespace gateway {
namespace {

struct Grid {
  std::size_t width, height, stride, pixel;  // stride and pixel in bytes
  std::size_t step = 1;                      // rows and columns from one that is shown to the next
};

std::optional<Grid> grid_of(const shm::FrameHead& head, std::size_t size, std::size_t most) {
  const auto format = static_cast<shm::Format>(head.format);
  if (format != shm::Format::points_float && format != shm::Format::points_intensity_float && format != shm::Format::depth_float)
    return std::nullopt;
  Grid grid{head.width, head.height, head.stride, shm::bytes_per_pixel(format)};
  if (grid.width == 0 || grid.height == 0 || most == 0 || grid.stride < grid.width * grid.pixel || size / grid.stride < grid.height)
    return std::nullopt;
  const auto shown = [&](std::size_t count) { return (count + grid.step - 1) / grid.step; };
  while (shown(grid.width) * shown(grid.height) > most) ++grid.step;
  return grid;
}

float float_at(const std::byte* from) {
  float value = 0;
  std::memcpy(&value, from, sizeof value);
  return value;
}

player::Point3d point_at(const std::byte* from) {
  return {float_at(from), float_at(from + sizeof(float)), float_at(from + 2 * sizeof(float))};
}

// Pixels look through their middles; the optical axis is x.
player::Point3d point_at_depth(double depth, std::size_t column, std::size_t row, const shm::CameraInfo& info) {
  const double right = (static_cast<double>(column) + 0.5 - info.cx) / info.fx, down = (static_cast<double>(row) + 0.5 - info.cy) / info.fy;
  return {depth, -right * depth, -down * depth};
}

}  // namespace

std::vector<player::Point3d> to_points(const shm::FrameHead& head, const shm::CameraInfo& info, std::span<const std::byte> data,
                                       std::size_t most) {
  std::vector<player::Point3d> points;
  const auto grid = grid_of(head, data.size(), most);
  const bool is_depth = static_cast<shm::Format>(head.format) == shm::Format::depth_float;
  if (!grid || (is_depth && !(info.fx > 0 && info.fy > 0))) return points;
  for (std::size_t row = 0; row < grid->height; row += grid->step) {
    const std::byte* line = data.data() + row * grid->stride;
    for (std::size_t column = 0; column < grid->width; column += grid->step) {
      const std::byte* pixel = line + column * grid->pixel;
      const auto point = is_depth ? point_at_depth(float_at(pixel), column, row, info) : point_at(pixel);
      if (std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z)) points.push_back(point);
    }
  }
  return points;
}

void PointCloud::show_sample() {
  // Clients take 8 MiB of decoded messages, in which a point has 28 bytes.
  constexpr std::size_t most = (player::max_message - 64) / 28;
  const auto frame = iface().hold();
  if (!frame || frame->head().stamp.valid == 0) return;
  publish(1, player::encode_points(to_points(frame->head(), iface().info<shm::CameraInfo>(), frame->data(), most)), frame->head().stamp);
}

std::optional<Answer> PointCloud::answer(std::uint8_t, const std::string&, const Later&) { return nack(); }

}  // namespace gateway
