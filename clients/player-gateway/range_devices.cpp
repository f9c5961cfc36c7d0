#include "range_devices.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocol/payloads.h"

namespace gateway {
namespace {

// The beams of the layer that looks nearest to the horizon: Player's scanners have one.
template <class T>
std::span<const T> level_layer(const shm::LaserInfo& info, std::span<const T> values) {
  std::size_t layer = 0;
  if (info.layers > 1 && info.max_vertical > info.min_vertical) {
    const double step = (info.max_vertical - info.min_vertical) / (info.layers - 1);
    layer = static_cast<std::size_t>(std::clamp(std::round(-info.min_vertical / step), 0.0, static_cast<double>(info.layers - 1)));
  }
  const std::size_t first = std::min(layer * info.beams, values.size());
  return values.subspan(first, std::min<std::size_t>(info.beams, values.size() - first));
}

float intensity(float value) { return value > 0 ? std::min(value, 255.0F) : 0.0F; }  // NaN becomes 0

double angle_step(const shm::LaserInfo& info) { return info.angle_step > 0 ? info.angle_step : 1e-3; }  // clients divide by it

player::LaserConfig laser_config(const shm::LaserInfo& info) {
  player::LaserConfig config;
  config.min_angle = static_cast<float>(info.min_angle);
  config.max_angle = static_cast<float>(info.max_angle);
  config.resolution = static_cast<float>(angle_step(info));
  config.max_range = static_cast<float>(info.max_range);
  config.range_resolution = static_cast<float>(info.range_step);
  config.has_intensity = true;
  config.rate = static_cast<float>(info.rate);
  return config;
}

// Bodies of scanners are not part of their ifaces.
constexpr player::Size3d no_size{};

}  // namespace

// ---- laser ----

void Laser::show_sample() {
  const auto& info = iface().info<shm::LaserInfo>();
  const auto view = iface().laser_scan();
  player::LaserScan scan;
  scan.min_angle = static_cast<float>(info.min_angle);
  scan.max_angle = static_cast<float>(info.max_angle);
  scan.resolution = static_cast<float>(angle_step(info));
  scan.max_range = static_cast<float>(info.max_range);
  for (const float range : level_layer(info, view.ranges))
    scan.ranges.push_back(static_cast<float>(seen_range(range, info.min_range, info.max_range)));
  for (const float value : level_layer(info, view.intensities))
    scan.intensities += static_cast<char>(static_cast<unsigned char>(intensity(value)));
  scan.id = ++scans_;
  publish(1, player::encode(scan), view.sample->stamp);
}

std::optional<Answer> Laser::answer(std::uint8_t subtype, const std::string& payload, const Later&) {
  constexpr std::uint8_t get_geometry = 1, set_config = 2, get_config = 3, power = 4, get_id = 5;
  const auto& info = iface().info<shm::LaserInfo>();
  switch (subtype) {
    case get_geometry:
      return ack(player::encode_geometry(to_pose3d(info.pose), no_size));
    case set_config:  // nothing can be set: the answer says how it is
    case get_config:
      return ack(player::encode(laser_config(info)));
    case power:  // it works while somebody reads
      return player::decode_byte(payload) ? ack() : nack();
    case get_id:
      return ack(player::encode_u32(address().index));
    default:
      return nack();
  }
}

// ---- sonar ----

void Sonar::show_sample() {
  const auto& info = iface().info<shm::SonarInfo>();
  const auto view = iface().sonar_scan();
  std::vector<float> ranges;
  for (const float range : view.ranges) ranges.push_back(static_cast<float>(seen_range(range, info.min_range, info.max_range)));
  publish(1, player::encode_sonar_ranges(ranges), view.sample->stamp);
}

std::optional<Answer> Sonar::answer(std::uint8_t subtype, const std::string& payload, const Later&) {
  constexpr std::uint8_t get_geometry = 1, power = 2;
  if (subtype == power) return player::decode_byte(payload) ? ack() : nack();
  if (subtype != get_geometry) return nack();
  std::vector<player::Pose3d> poses;
  for (const shm::Pose& pose : iface().sonar_poses()) poses.push_back(to_pose3d(pose));
  return ack(player::encode_poses(poses));
}

// ---- ranger ----

void Ranger::show_sample() {
  constexpr std::uint8_t data_ranges = 1, data_intensities = 3;
  std::vector<double> ranges;
  if (iface().type() == shm::IfaceType::sonar) {
    const auto& info = iface().info<shm::SonarInfo>();
    const auto view = iface().sonar_scan();
    for (const float range : view.ranges) ranges.push_back(seen_range(range, info.min_range, info.max_range));
    publish(data_ranges, player::encode_ranger_values(ranges), view.sample->stamp);
    return;
  }
  const auto& info = iface().info<shm::LaserInfo>();
  const auto view = iface().laser_scan();
  for (const float range : level_layer(info, view.ranges)) ranges.push_back(seen_range(range, info.min_range, info.max_range));
  publish(data_ranges, player::encode_ranger_values(ranges), view.sample->stamp);
  if (!has_intensities_) return;
  std::vector<double> intensities;
  for (const float value : level_layer(info, view.intensities)) intensities.push_back(intensity(value));
  publish(data_intensities, player::encode_ranger_values(intensities), view.sample->stamp);
}

std::optional<Answer> Ranger::answer(std::uint8_t subtype, const std::string& payload, const Later&) {
  constexpr std::uint8_t get_geometry = 1, power = 2, intensities = 3, set_config = 4, get_config = 5;
  const bool is_sonar = iface().type() == shm::IfaceType::sonar;
  switch (subtype) {
    case get_geometry: {
      player::RangerGeometry geometry;
      if (is_sonar) {
        for (const shm::Pose& pose : iface().sonar_poses()) geometry.element_poses.push_back(to_pose3d(pose));
      } else {
        geometry.pose = to_pose3d(iface().info<shm::LaserInfo>().pose);
        geometry.element_poses.push_back(geometry.pose);
      }
      geometry.element_sizes.resize(geometry.element_poses.size());
      return ack(player::encode(geometry));
    }
    case power:
      return player::decode_byte(payload) ? ack() : nack();
    case intensities: {
      const auto state = player::decode_byte(payload);
      if (!state || is_sonar) return nack();
      has_intensities_ = *state != 0;
      return ack();
    }
    case set_config:
    case get_config: {
      if (is_sonar) {
        const auto& info = iface().info<shm::SonarInfo>();
        return ack(player::encode(player::RangerConfig{.min_angle = 0,
                                                       .max_angle = 0,
                                                       .resolution = info.cone,
                                                       .min_range = info.min_range,
                                                       .max_range = info.max_range,
                                                       .rate = info.rate}));
      }
      const auto& info = iface().info<shm::LaserInfo>();
      return ack(player::encode(player::RangerConfig{.min_angle = info.min_angle,
                                                     .max_angle = info.max_angle,
                                                     .resolution = angle_step(info),
                                                     .min_range = info.min_range,
                                                     .max_range = info.max_range,
                                                     .range_resolution = info.range_step,
                                                     .rate = info.rate}));
    }
    default:
      return nack();
  }
}

}  // namespace gateway
