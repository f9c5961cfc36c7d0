#include "range_devices.h"

#include <algorithm>
#include <cmath>

#include "protocol/payloads.h"

namespace gateway {
namespace {

float intensity(float value) { return value > 0 ? std::min(value, 255.0F) : 0.0F; }  // NaN becomes 0

// Bodies of scanners are not part of their ifaces.
constexpr player::Size3d no_size{};

std::vector<double> sonar_ranges(shm::Iface& iface) {
  const auto& info = iface.info<shm::SonarInfo>();
  std::vector<double> ranges;
  for (const float range : iface.sonar_scan().ranges) ranges.push_back(seen_range(range, info.min_range, info.max_range));
  return ranges;
}

}  // namespace

// ---- what scanners have in common ----

ScanFilter& ScanDevice::filter() {
  if (!filter_) filter_.emplace(iface().info<shm::LaserInfo>());
  return *filter_;
}

bool ScanDevice::choose(const ScanSettings& wanted) {
  auto chosen = ScanFilter::choose(iface().info<shm::LaserInfo>(), wanted);
  if (chosen) filter_ = chosen;
  return chosen.has_value();
}

bool ScanDevice::is_due(const shm::Stamp& stamp) {
  const bool is_next = filter().is_due(stamp.sequence);
  return is_next || is_for_newcomer();
}

// ---- laser ----

void Laser::show_sample() {
  const auto& info = iface().info<shm::LaserInfo>();
  const auto view = iface().laser_scan();
  if (!is_due(view.sample->stamp)) return;
  const ScanSettings& settings = filter().settings();
  player::LaserScan scan;
  scan.min_angle = static_cast<float>(settings.min_angle);
  scan.max_angle = static_cast<float>(settings.max_angle);
  scan.resolution = static_cast<float>(settings.resolution);
  scan.max_range = static_cast<float>(settings.max_range);
  scan.ranges = filter().ranges(level_layer(info, view.ranges));
  if (has_intensities_) {
    for (const float value : filter().values(level_layer(info, view.intensities)))
      scan.intensities += static_cast<char>(static_cast<unsigned char>(intensity(value)));
  }
  scan.id = ++scans_;
  publish(1, player::encode(scan), view.sample->stamp);
}

std::string Laser::config() {
  const ScanSettings& settings = filter().settings();
  player::LaserConfig config;
  config.min_angle = static_cast<float>(settings.min_angle);
  config.max_angle = static_cast<float>(settings.max_angle);
  config.resolution = static_cast<float>(settings.resolution);
  config.max_range = static_cast<float>(settings.max_range);
  config.range_resolution = static_cast<float>(settings.range_resolution);
  config.has_intensity = has_intensities_;
  config.rate = static_cast<float>(settings.rate);
  return player::encode(config);
}

Answer Laser::set_config(const std::string& payload) {
  const auto wanted = player::decode_laser_config(payload);
  // What client libraries send as max_range is whatever was in their memory.
  if (!wanted || !choose({.min_angle = wanted->min_angle,
                          .max_angle = wanted->max_angle,
                          .resolution = wanted->resolution,
                          .range_resolution = wanted->range_resolution,
                          .rate = wanted->rate}))
    return nack();
  has_intensities_ = wanted->has_intensity;
  return ack(config());
}

void Laser::on_unused() {
  ScanDevice::on_unused();
  has_intensities_ = true;
}

std::optional<Answer> Laser::answer(std::uint8_t subtype, const std::string& payload, const Later&) {
  constexpr std::uint8_t get_geometry = 1, set_configuration = 2, get_configuration = 3, power = 4, get_id = 5;
  switch (subtype) {
    case get_geometry:
      return ack(player::encode_geometry(to_pose3d(iface().info<shm::LaserInfo>().pose), no_size));
    case set_configuration:
      return set_config(payload);
    case get_configuration:
      return ack(config());
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
  const auto values = sonar_ranges(iface());
  publish(1, player::encode_sonar_ranges({values.begin(), values.end()}), iface().sample<shm::Stamp>());
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
  if (is_sonar()) return publish(data_ranges, player::encode_ranger_values(sonar_ranges(iface())), iface().sample<shm::Stamp>());
  const auto& info = iface().info<shm::LaserInfo>();
  const auto view = iface().laser_scan();
  if (!is_due(view.sample->stamp)) return;
  const auto ranges = filter().ranges(level_layer(info, view.ranges));
  publish(data_ranges, player::encode_ranger_values({ranges.begin(), ranges.end()}), view.sample->stamp);
  if (!has_intensities_) return;
  std::vector<double> intensities;
  for (const float value : filter().values(level_layer(info, view.intensities))) intensities.push_back(intensity(value));
  publish(data_intensities, player::encode_ranger_values(intensities), view.sample->stamp);
}

std::string Ranger::geometry() {
  player::RangerGeometry geometry;
  if (is_sonar()) {
    for (const shm::Pose& pose : iface().sonar_poses()) geometry.element_poses.push_back(to_pose3d(pose));
  } else {
    geometry.pose = to_pose3d(iface().info<shm::LaserInfo>().pose);
    geometry.element_poses.push_back(geometry.pose);
  }
  geometry.element_sizes.resize(geometry.element_poses.size());
  return player::encode(geometry);
}

player::RangerConfig Ranger::config() {
  if (is_sonar()) {
    const auto& info = iface().info<shm::SonarInfo>();
    return {.resolution = info.cone, .min_range = info.min_range, .max_range = info.max_range, .rate = info.rate};
  }
  const ScanSettings& s = filter().settings();
  return {s.min_angle, s.max_angle, s.resolution, s.min_range, s.max_range, s.range_resolution, s.rate};
}

Answer Ranger::set_config(const std::string& payload) {
  const auto wanted = player::decode_ranger_config(payload);
  if (!wanted) return nack();
  if (is_sonar()) {  // can't be set: what it is already, or 0, is no wish
    const auto is_as = [](double value, double present) {
      return value == 0 || std::abs(value - present) <= 1e-3 * std::max(1.0, std::abs(present));
    };
    const auto now = config();
    const bool is_present = is_as(wanted->min_angle, now.min_angle) && is_as(wanted->max_angle, now.max_angle) &&
                            is_as(wanted->resolution, now.resolution) && is_as(wanted->min_range, now.min_range) &&
                            is_as(wanted->max_range, now.max_range) && is_as(wanted->range_resolution, now.range_resolution) &&
                            is_as(wanted->rate, now.rate);
    return is_present ? ack(player::encode(now)) : nack();
  }
  const auto& w = *wanted;
  if (!choose({w.min_angle, w.max_angle, w.resolution, w.min_range, w.max_range, w.range_resolution, w.rate})) return nack();
  return ack(player::encode(config()));
}

std::optional<Answer> Ranger::answer(std::uint8_t subtype, const std::string& payload, const Later&) {
  constexpr std::uint8_t get_geometry = 1, power = 2, intensities = 3, set_configuration = 4, get_configuration = 5;
  switch (subtype) {
    case get_geometry:
      return ack(geometry());
    case power:
      return player::decode_byte(payload) ? ack() : nack();
    case intensities: {
      const auto state = player::decode_byte(payload);
      if (!state || is_sonar()) return nack();
      has_intensities_ = *state != 0;
      return ack();
    }
    case set_configuration:
      return set_config(payload);
    case get_configuration:
      return ack(player::encode(config()));
    default:
      return nack();
  }
}

}  // namespace gateway
