#include "seen_devices.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "camera_device.h"

namespace gateway {
namespace {

constexpr std::uint32_t least_area = 10;  // [pixel]
constexpr std::size_t max_blobs = 256;
constexpr int no_color = -1;
constexpr std::array<std::uint32_t, 6> pure_colors{0xff0000, 0xffff00, 0x00ff00, 0x00ffff, 0x0000ff, 0xff00ff};

// Index into pure_colors of the nearest hue; none for what is dark or grey.
int color_of(const std::uint8_t* pixel) {
  const int r = pixel[0], g = pixel[1], b = pixel[2];
  const int most = std::max({r, g, b}), range = most - std::min({r, g, b});
  constexpr int darkest = 60;
  if (most < darkest || 2 * range < most) return no_color;
  const double hue = most == r ? (g - b) / double(range) : most == g ? 2 + (b - r) / double(range) : 4 + (r - g) / double(range);
  return static_cast<int>(std::lround(hue + 6)) % 6;
}

// The regions that pixels belong to, as a forest: each knows one before it.
class Regions {
 public:
  std::size_t make() {
    parents_.push_back(parents_.size());
    return parents_.size() - 1;
  }
  std::size_t root(std::size_t one) {
    while (parents_[one] != one) one = parents_[one] = parents_[parents_[one]];
    return one;
  }
  void join(std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }
  std::size_t size() const { return parents_.size(); }

 private:
  std::vector<std::size_t> parents_;
};

struct Sum {
  int color = no_color;
  std::uint64_t x = 0, y = 0;
  player::Blob blob;
  void add(std::uint32_t column, std::uint32_t row) {
    if (blob.area++ == 0) blob.left = blob.right = column, blob.top = row;
    blob.left = std::min(blob.left, column);
    blob.right = std::max(blob.right, column);
    blob.bottom = row;
    x += column, y += row;
  }
};

player::Blob blob_of(const shm::Box& box) {
  const auto pixel = [](double value) { return static_cast<std::uint32_t>(std::max(0.0, value)); };
  player::Blob blob;
  blob.id = box.label;
  blob.area = box.pixels;
  blob.x = pixel(box.center[0]);
  blob.y = pixel(box.center[1]);
  blob.left = pixel(box.center[0] - box.size[0] / 2);
  blob.right = pixel(box.center[0] + box.size[0] / 2);
  blob.top = pixel(box.center[1] - box.size[1] / 2);
  blob.bottom = pixel(box.center[1] + box.size[1] / 2);
  return blob;
}

}  // namespace

std::vector<player::Blob> color_blobs(std::span<const std::uint8_t> rgb, std::size_t width, std::size_t height) {
  Regions regions;
  std::vector<int> colors(width * height);
  std::vector<std::size_t> region_of(width * height);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    colors[i] = color_of(&rgb[3 * i]);
    if (colors[i] == no_color) continue;
    const bool is_left = i % width > 0 && colors[i - 1] == colors[i], is_above = i >= width && colors[i - width] == colors[i];
    region_of[i] = is_left ? region_of[i - 1] : is_above ? region_of[i - width] : regions.make();
    if (is_left && is_above) regions.join(region_of[i - 1], region_of[i - width]);
  }
  std::vector<Sum> sums(regions.size());
  for (std::size_t i = 0; i < colors.size(); ++i) {
    if (colors[i] == no_color) continue;
    Sum& sum = sums[regions.root(region_of[i])];
    sum.color = colors[i];
    sum.add(static_cast<std::uint32_t>(i % width), static_cast<std::uint32_t>(i / width));
  }
  std::vector<player::Blob> blobs;
  for (const Sum& sum : sums) {
    if (sum.blob.area < least_area) continue;
    player::Blob blob = sum.blob;
    blob.id = static_cast<std::uint32_t>(sum.color);
    blob.color = pure_colors[blob.id];
    blob.x = static_cast<std::uint32_t>(sum.x / blob.area);
    blob.y = static_cast<std::uint32_t>(sum.y / blob.area);
    blobs.push_back(blob);
  }
  std::ranges::stable_sort(blobs, std::greater{}, &player::Blob::area);
  if (blobs.size() > max_blobs) blobs.resize(max_blobs);
  return blobs;
}

void Blobfinder::show_sample() {
  if (iface().type() == shm::IfaceType::boxes) {
    const auto& info = iface().info<shm::BoxesInfo>();
    const auto* boxes = reinterpret_cast<const shm::Box*>(iface().sample_followers(0));
    std::vector<player::Blob> blobs;
    for (std::size_t i = 0; i < iface().filled(); ++i) blobs.push_back(blob_of(boxes[i]));
    return publish(1, player::encode_blobs(info.width, info.height, blobs), iface().sample<shm::Stamp>());
  }
  const auto frame = iface().hold();
  if (!frame || frame->head().stamp.valid == 0) return;
  const auto image = to_image(frame->head(), frame->data());
  std::vector<player::Blob> blobs;
  if (image && image->format == player::ImageFormat::rgb888)
    blobs = color_blobs({reinterpret_cast<const std::uint8_t*>(image->pixels.data()), image->pixels.size()}, image->width, image->height);
  publish(1, player::encode_blobs(frame->head().width, frame->head().height, blobs), frame->head().stamp);
}

std::optional<Answer> Blobfinder::answer(std::uint8_t, const std::string&, const Later&) { return nack(); }

std::vector<player::FiducialItem> Fiducial::items() {
  std::vector<player::FiducialItem> items;
  if (iface().type() == shm::IfaceType::logical_camera) {
    const auto* models = reinterpret_cast<const shm::SeenModel*>(iface().sample_followers(0));
    for (std::size_t i = 0; i < iface().filled(); ++i) items.push_back({static_cast<std::int32_t>(i), to_pose3d(models[i].pose), {}});
    return items;
  }
  const double *noise = iface().info<shm::FiducialInfo>().noise, place = noise[0], turn = noise[1];
  const auto* marks = reinterpret_cast<const shm::Mark*>(iface().sample_followers(0));
  for (std::size_t i = 0; i < iface().filled(); ++i)
    items.push_back({static_cast<std::int32_t>(marks[i].id), to_pose3d(marks[i].pose), {place, place, place, turn, turn, turn}});
  return items;
}

void Fiducial::show_sample() { publish(1, player::encode_fiducials(items()), iface().sample<shm::Stamp>()); }

std::optional<Answer> Fiducial::answer(std::uint8_t subtype, const std::string&, const Later&) {
  constexpr std::uint8_t get_geometry = 1;
  const bool is_logical = iface().type() == shm::IfaceType::logical_camera;
  if (subtype == get_geometry) {
    const auto& pose = is_logical ? iface().info<shm::LogicalCameraInfo>().pose : iface().info<shm::FiducialInfo>().pose;
    const auto* marks = reinterpret_cast<const shm::Mark*>(iface().sample_followers(0));
    const bool has_mark = !is_logical && source()->has_sample() && iface().filled() > 0;
    return ack(player::encode_fiducial_geometry(to_pose3d(pose), has_mark ? marks[0].size[1] : 0, has_mark ? marks[0].size[2] : 0));
  }
  if (is_logical) {
    const auto& info = iface().info<shm::LogicalCameraInfo>();
    return ack(player::encode_fiducial_fov(info.near_clip, info.far_clip, info.hfov));
  }
  const auto& info = iface().info<shm::FiducialInfo>();
  return ack(player::encode_fiducial_fov(info.min_range, info.max_range, info.view_angle));
}

}  // namespace gateway
