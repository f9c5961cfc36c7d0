#include "disparity.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "base/text.h"

namespace gateway {
namespace {

constexpr int reach = 4, side = 2 * reach + 1;  // of a block [pixel]
constexpr std::uint32_t widest = 400;

struct Grey {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  const std::uint8_t* row(int y) const { return pixels.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

Grey grey_of(const player::Image& image, std::uint32_t step) {
  const std::size_t channels = image.format == player::ImageFormat::rgb888 ? 3 : 1;
  Grey grey{static_cast<int>(image.width / step), static_cast<int>(image.height / step), {}};
  grey.pixels.reserve(static_cast<std::size_t>(grey.width) * static_cast<std::size_t>(grey.height));
  for (int y = 0; y < grey.height; ++y) {
    for (int x = 0; x < grey.width; ++x) {
      const std::size_t at = (static_cast<std::size_t>(y) * step * image.width + static_cast<std::size_t>(x) * step) * channels;
      unsigned sum = 0;
      for (std::size_t i = 0; i < channels; ++i) sum += static_cast<std::uint8_t>(image.pixels[at + i]);
      grey.pixels.push_back(static_cast<std::uint8_t>(sum / channels));
    }
  }
  return grey;
}

// The costs of a row of blocks, for each distance: sums of columns are kept from row to row.
class RowCosts {
 public:
  RowCosts(const Grey& left, const Grey& right, int distances)
      : left_(left), right_(right), distances_(distances), columns_(size()), costs_(size()) {
    for (int y = 0; y < side - 1; ++y) add(y, 1);
  }
  // Of the blocks whose middle is in row y; to be called for reach, reach + 1, ...
  void go_to(int y) {
    add(y + reach, 1);
    if (y > reach) add(y - reach - 1, -1);
    for (int d = 0; d < distances_; ++d) {
      const int* column = columns_.data() + at(d, 0);
      int* cost = costs_.data() + at(d, 0);
      int sum = 0;
      for (int x = d; x < left_.width; ++x) {
        sum += column[x];
        if (x - d >= side) sum -= column[x - side];
        if (x - d >= side - 1) cost[x - reach] = sum;
      }
    }
  }
  int cost(int d, int x) const { return costs_[at(d, x)]; }

 private:
  std::size_t size() const { return static_cast<std::size_t>(distances_) * static_cast<std::size_t>(left_.width); }
  std::size_t at(int d, int x) const {
    return static_cast<std::size_t>(d) * static_cast<std::size_t>(left_.width) + static_cast<std::size_t>(x);
  }
  void add(int y, int sign) {
    const std::uint8_t *l = left_.row(y), *r = right_.row(y);
    for (int d = 0; d < distances_; ++d) {
      int* column = columns_.data() + at(d, 0);
      for (int x = d; x < left_.width; ++x) column[x] += sign * std::abs(int{l[x]} - int{r[x - d]});
    }
  }

  const Grey &left_, &right_;
  int distances_;
  std::vector<int> columns_, costs_;
};

// In sixteenths of a pixel; 0: none that is clearly the best.
std::uint16_t best_of(const RowCosts& costs, int x, int distances) {
  constexpr int least_gain = side * side, max_cost = 16 * side * side;  // a grey level for each pixel, and 16
  const int most = std::min(distances, x - reach + 1);
  int best = 0;
  for (int d = 1; d < most; ++d) {
    if (costs.cost(d, x) < costs.cost(best, x)) best = d;
  }
  if (best == 0 || best + 1 >= most) return 0;
  const int least = costs.cost(best, x);
  int other = std::numeric_limits<int>::max();
  for (int d = 0; d < most; ++d) {
    if (std::abs(d - best) > 1) other = std::min(other, costs.cost(d, x));
  }
  if (least > max_cost || other < least + least_gain || other * 10LL < least * 11LL) return 0;
  const int before = costs.cost(best - 1, x), after = costs.cost(best + 1, x), bend = before + after - 2 * least;
  const double part = bend > 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
  return static_cast<std::uint16_t>(std::lround(16 * (best + part)));
}

Eigen::Isometry3d isometry(const shm::Pose& pose) {
  return Eigen::Translation3d(pose.x, pose.y, pose.z) * Eigen::Quaterniond(pose.qw, pose.qx, pose.qy, pose.qz).normalized();
}

std::string_view content_of(const shm::CameraInfo& camera) {
  switch (static_cast<shm::Format>(camera.format)) {
    case shm::Format::labels:
      return "labels";
    case shm::Format::thermal8:
    case shm::Format::thermal16:
      return "temperatures";
    case shm::Format::mono8:
      return "grey";
    case shm::Format::mono16:
      return "grey of 16 bits";
    default:
      return "colours";
  }
}

}  // namespace

base::Result<StereoPair> stereo_pair(const shm::CameraInfo& left, const shm::CameraInfo& right) {
  constexpr double parallel = 0.5 * std::numbers::pi / 180, least_base = 1e-3, off = 0.02, same_focal = 1e-3;
  const auto size = [](const shm::CameraInfo& info) { return std::to_string(info.width) + " x " + std::to_string(info.height); };
  if (content_of(left) != content_of(right))
    return base::Error{"the images show " + std::string(content_of(left)) + " and " + std::string(content_of(right)) +
                       "; expected the same"};
  if (left.width != right.width || left.height != right.height)
    return base::Error{"the images have " + size(left) + " and " + size(right) + " pixels; expected the same size"};
  if (!(left.fx > 0) || std::abs(left.fx - right.fx) > same_focal * left.fx)
    return base::Error{"the focal lengths are " + base::format_number(left.fx) + " and " + base::format_number(right.fx) +
                       " pixels; expected the same"};
  const Eigen::Isometry3d between = isometry(left.pose).inverse() * isometry(right.pose);
  const double angle = Eigen::AngleAxisd(between.linear()).angle();
  if (angle > parallel)
    return base::Error{"they look " + base::format_number(std::round(angle * 1800 / std::numbers::pi) / 10) +
                       " degrees apart; expected the same way"};
  const Eigen::Vector3d way = between.translation();
  const double base = -way.y();
  if (base < least_base || std::hypot(way.x(), way.z()) > off * base)
    return base::Error{"the second is at " + base::format_number(way.x()) + ", " + base::format_number(way.y()) + ", " +
                       base::format_number(way.z()) + " m in the first one's frame; expected it to the right, at 0, -BASE, 0"};
  return StereoPair{left.fx, left.cx, left.cy, base};
}

Disparities disparities_of(const player::Image& left, const player::Image& right) {
  Disparities out;
  const bool is_color = left.format == player::ImageFormat::rgb888, is_grey = left.format == player::ImageFormat::mono8;
  const std::size_t size = std::size_t{left.width} * left.height * (is_color ? 3 : 1);
  if (size == 0 || (!is_color && !is_grey) || left.format != right.format || left.width != right.width || left.height != right.height ||
      left.pixels.size() != size || right.pixels.size() != size)
    return out;
  out.step = (left.width + widest - 1) / widest;
  const Grey l = grey_of(left, out.step), r = grey_of(right, out.step);
  out.width = static_cast<std::uint32_t>(l.width);
  out.height = static_cast<std::uint32_t>(l.height);
  out.sixteenths.assign(l.pixels.size(), 0);
  const int distances = l.width / 4;
  if (l.height < side || distances < 3) return out;
  RowCosts costs(l, r, distances);
  for (int y = reach; y + reach < l.height; ++y) {
    costs.go_to(y);
    std::uint16_t* to = out.sixteenths.data() + static_cast<std::ptrdiff_t>(y) * l.width;
    for (int x = reach; x + reach < l.width; ++x) to[x] = best_of(costs, x, distances);
  }
  return out;
}

player::Image to_image(const Disparities& disparities) {
  player::Image image{disparities.width, disparities.height, 16, player::ImageFormat::mono16, {}};
  for (const std::uint16_t value : disparities.sixteenths) {
    image.pixels += static_cast<char>(value >> 8);
    image.pixels += static_cast<char>(value & 255);
  }
  return image;
}

std::vector<player::ColoredPoint> to_points(const Disparities& disparities, const StereoPair& pair, const player::Image& left,
                                            std::size_t most) {
  std::vector<player::ColoredPoint> points;
  const std::size_t channels = left.format == player::ImageFormat::rgb888 ? 3 : 1;
  const double step = disparities.step, focal = pair.focal / step;
  for (std::size_t i = 0; i < disparities.sixteenths.size() && points.size() < most; ++i) {
    if (disparities.sixteenths[i] == 0) continue;
    const std::size_t column = i % disparities.width, row = i / disparities.width;
    const double depth = focal * pair.base * 16 / disparities.sixteenths[i];
    const double right = (static_cast<double>(column) * step + 0.5 - pair.cx) / pair.focal;
    const double down = (static_cast<double>(row) * step + 0.5 - pair.cy) / pair.focal;
    const std::size_t pixel = (row * disparities.step * left.width + column * disparities.step) * channels;
    const auto color = [&](std::size_t channel) { return static_cast<std::uint8_t>(left.pixels[pixel + (channels == 3 ? channel : 0)]); };
    points.push_back({{depth, -right * depth, -down * depth}, {color(0), color(1), color(2)}});
  }
  return points;
}

}  // namespace gateway
