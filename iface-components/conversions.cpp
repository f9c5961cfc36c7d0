#include "conversions.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iface {
namespace {

constexpr std::int64_t nanoseconds_per_second = 1'000'000'000;
constexpr double pi = 3.14159265358979323846;

}  // namespace

RTC::Time to_time(std::int64_t sim_time_ns) {
  return {static_cast<CORBA::ULong>(sim_time_ns / nanoseconds_per_second), static_cast<CORBA::ULong>(sim_time_ns % nanoseconds_per_second)};
}

RTC::Point3D to_point(const shm::Pose& pose) { return {pose.x, pose.y, pose.z}; }

RTC::Orientation3D to_orientation(const shm::Pose& p) {
  const double roll = std::atan2(2 * (p.qw * p.qx + p.qy * p.qz), 1 - 2 * (p.qx * p.qx + p.qy * p.qy));
  const double pitch = std::asin(std::clamp(2 * (p.qw * p.qy - p.qz * p.qx), -1.0, 1.0));
  const double yaw = std::atan2(2 * (p.qw * p.qz + p.qx * p.qy), 1 - 2 * (p.qy * p.qy + p.qz * p.qz));
  return {roll, pitch, yaw};
}

RTC::Pose3D to_pose(const shm::Pose& pose) { return {to_point(pose), to_orientation(pose)}; }

RTC::Geometry3D to_geometry(const shm::Pose& pose, const double* size) {
  RTC::Geometry3D geometry{};
  geometry.pose = to_pose(pose);
  if (size != nullptr) geometry.size = {size[0], size[1], size[2]};
  return geometry;
}

RTC::Geometry2D to_geometry_2d(const shm::Pose& pose, const double* size) {
  return {{{pose.x, pose.y}, to_orientation(pose).y}, {size[0], size[1]}};
}

double port_range(float range, double min_range, double max_range) {
  if (std::isnan(range)) return max_range;
  return std::clamp(static_cast<double>(range), std::max(0.0, min_range), max_range);
}

std::uint32_t level_layer(const shm::LaserInfo& info) {
  if (info.layers < 2) return 0;
  const double step = (info.max_vertical - info.min_vertical) / (info.layers - 1);
  if (step == 0) return 0;
  return static_cast<std::uint32_t>(std::clamp(std::round(-info.min_vertical / step), 0.0, static_cast<double>(info.layers - 1)));
}

RTC::RangerGeometry ranger_geometry(const shm::LaserInfo& info) {
  RTC::RangerGeometry geometry;
  geometry.geometry = to_geometry(info.pose);
  return geometry;
}

RTC::RangerGeometry ranger_geometry(const shm::SonarInfo& info, std::span<const shm::Pose> poses) {
  RTC::RangerGeometry geometry;
  geometry.geometry = to_geometry(info.pose);
  geometry.elementGeometries.length(static_cast<CORBA::ULong>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) geometry.elementGeometries[static_cast<CORBA::ULong>(i)] = to_geometry(poses[i]);
  return geometry;
}

RTC::RangerConfig ranger_config(const shm::LaserInfo& info) {
  return {info.min_angle, info.max_angle, info.angle_step, info.min_range, info.max_range, info.range_step, info.rate};
}

// A ring has no scan angles: each transducer's direction is in its element geometry, and the cone is the angular resolution.
RTC::RangerConfig ranger_config(const shm::SonarInfo& info) { return {0, 0, info.cone, info.min_range, info.max_range, 0, info.rate}; }

namespace {

// The values of one layer; empty if there is no such layer.
std::span<const float> layer_of(const shm::LaserInfo& info, std::span<const float> values, std::uint32_t layer) {
  const auto first = static_cast<std::size_t>(layer) * info.beams;
  return first < values.size() ? values.subspan(first, std::min<std::size_t>(info.beams, values.size() - first)) : std::span<const float>{};
}

float port_intensity(float value) { return value > 0 ? std::min(value, 1.0F) : 0; }  // NaN becomes 0

}  // namespace

void to_range_data(const shm::LaserInfo& info, const shm::ScanView& scan, std::uint32_t layer, RTC::RangeData& data) {
  const auto ranges = layer_of(info, scan.ranges, layer);
  data.tm = to_time(scan.sample->stamp.sim_time_ns);
  data.ranges.length(static_cast<CORBA::ULong>(ranges.size()));
  for (std::size_t i = 0; i < ranges.size(); ++i)
    data.ranges[static_cast<CORBA::ULong>(i)] = port_range(ranges[i], info.min_range, info.max_range);
  data.geometry = ranger_geometry(info);
  data.config = ranger_config(info);
}

void to_intensity_data(const shm::LaserInfo& info, const shm::ScanView& scan, std::uint32_t layer, RTC::IntensityData& data) {
  const auto values = layer_of(info, scan.intensities, layer);
  data.tm = to_time(scan.sample->stamp.sim_time_ns);
  data.intensities.length(static_cast<CORBA::ULong>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) data.intensities[static_cast<CORBA::ULong>(i)] = port_intensity(values[i]);
  data.geometry = ranger_geometry(info);
  data.config = ranger_config(info);
}

void to_range_data(const shm::SonarInfo& info, std::span<const shm::Pose> poses, const shm::SonarView& scan, RTC::RangeData& data) {
  data.tm = to_time(scan.sample->stamp.sim_time_ns);
  data.ranges.length(static_cast<CORBA::ULong>(scan.ranges.size()));
  for (std::size_t i = 0; i < scan.ranges.size(); ++i)
    data.ranges[static_cast<CORBA::ULong>(i)] = port_range(scan.ranges[i], info.min_range, info.max_range);
  data.geometry = ranger_geometry(info, poses);
  data.config = ranger_config(info);
}

void to_points(const shm::LaserInfo& info, const shm::ScanView& scan, bool with_misses, std::vector<RayPoint>& points) {
  points.clear();
  const std::uint32_t layers = std::max(info.layers, 1u);
  const double rise = layers > 1 ? (info.max_vertical - info.min_vertical) / (layers - 1) : 0;
  const double sweep = 1e-9 * scan.sample->sweep_ns;
  for (std::uint32_t ring = 0; ring < layers; ++ring) {
    const auto ranges = layer_of(info, scan.ranges, ring), intensities = layer_of(info, scan.intensities, ring);
    const double up = std::sin(info.min_vertical + ring * rise), level = std::cos(info.min_vertical + ring * rise);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const bool is_hit = std::isfinite(ranges[i]);
      if (!is_hit && !with_misses) continue;
      const double range = is_hit ? ranges[i] : std::numeric_limits<double>::quiet_NaN();
      const double angle = info.min_angle + static_cast<double>(i) * info.angle_step;
      points.push_back(
          {{static_cast<float>(range * level * std::cos(angle)), static_cast<float>(range * level * std::sin(angle)),
            static_cast<float>(range * up)},
           i < intensities.size() ? port_intensity(intensities[i]) : 0,
           ring,
           ranges.size() > 1 ? static_cast<float>(sweep * static_cast<double>(i) / static_cast<double>(ranges.size() - 1)) : 0});
    }
  }
}

void to_gps_data(const shm::GpsInfo& info, const shm::GpsSample& sample, RTC::GPSData& data) {
  data.tm = to_time(sample.stamp.sim_time_ns);
  data.timeFromGPS.sec = data.tm.sec;
  data.timeFromGPS.msec = data.tm.nsec / 1'000'000;
  data.latitude = sample.latitude;
  data.longitude = sample.longitude;
  data.altitude = sample.altitude;
  data.horizontalError = info.position_noise;
  data.verticalError = info.altitude_noise;
  const double east = sample.velocity[0];
  const double north = sample.velocity[1];
  data.horizontalSpeed = std::hypot(east, north);
  // A course: clockwise from north, in [0, 2 pi).
  data.heading = data.horizontalSpeed > 0 ? std::fmod(std::atan2(east, north) + 2 * pi, 2 * pi) : 0;
  data.verticalSpeed = sample.velocity[2];
  data.numSatellites = sample.stamp.valid ? 8 : 0;
  data.fixType = sample.stamp.valid ? RTC::GPS_FIX_NORMAL : RTC::GPS_FIX_NONE;
}

PixelRay to_ray(const shm::CameraInfo& info, double u, double v) {
  const double x = (u - info.cx) / info.fx, y = (v - info.cy) / info.fy;
  const auto& d = info.distortion;  // k1 k2 p1 p2 k3
  if (std::all_of(std::begin(d), std::end(d), [](double term) { return term == 0; })) return {x, y};
  // The lens maps rays to pixels; the way back is found by damped steps.
  PixelRay ray{x, y};
  for (int i = 0; i < 60; ++i) {
    const double r2 = ray.right * ray.right + ray.down * ray.down;
    const double radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
    const double off_x = ray.right * radial + 2 * d[2] * ray.right * ray.down + d[3] * (r2 + 2 * ray.right * ray.right) - x;
    const double off_y = ray.down * radial + d[2] * (r2 + 2 * ray.down * ray.down) + 2 * d[3] * ray.right * ray.down - y;
    ray.right -= 0.7 * off_x;
    ray.down -= 0.7 * off_y;
    if (off_x * off_x + off_y * off_y < 1e-16) break;
    if (!(std::hypot(ray.right, ray.down) < 20)) return {x, y};  // beyond what the polynomial describes
  }
  return ray;
}

}  // namespace iface
