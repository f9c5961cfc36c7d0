#include "conversions.h"

#include <algorithm>
#include <cmath>

namespace iface {
namespace {

constexpr std::int64_t nanoseconds_per_second = 1'000'000'000;
constexpr double pi = 3.14159265358979323846;

void set_geometry(const shm::Pose& pose, RTC::Geometry3D& geometry) {
  geometry.pose = to_pose(pose);
  geometry.size = {0, 0, 0};
}

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

void to_range_data(const shm::LaserInfo& info, const shm::ScanView& scan, std::uint32_t layer, RTC::RangeData& data) {
  data.tm = to_time(scan.sample->stamp.sim_time_ns);
  const auto first = static_cast<std::size_t>(layer) * info.beams;
  const auto count = first < scan.ranges.size() ? std::min<std::size_t>(info.beams, scan.ranges.size() - first) : 0;
  data.ranges.length(static_cast<CORBA::ULong>(count));
  for (std::size_t i = 0; i < count; ++i)
    data.ranges[static_cast<CORBA::ULong>(i)] = port_range(scan.ranges[first + i], info.min_range, info.max_range);
  set_geometry(info.pose, data.geometry.geometry);
  data.geometry.elementGeometries.length(0);
  data.config.minAngle = info.min_angle;
  data.config.maxAngle = info.max_angle;
  data.config.angularRes = info.angle_step;
  data.config.minRange = info.min_range;
  data.config.maxRange = info.max_range;
  data.config.rangeRes = info.range_step;
  data.config.frequency = info.rate;
}

void to_range_data(const shm::SonarInfo& info, std::span<const shm::Pose> poses, const shm::SonarView& scan, RTC::RangeData& data) {
  data.tm = to_time(scan.sample->stamp.sim_time_ns);
  data.ranges.length(static_cast<CORBA::ULong>(scan.ranges.size()));
  for (std::size_t i = 0; i < scan.ranges.size(); ++i)
    data.ranges[static_cast<CORBA::ULong>(i)] = port_range(scan.ranges[i], info.min_range, info.max_range);
  set_geometry(info.pose, data.geometry.geometry);
  data.geometry.elementGeometries.length(static_cast<CORBA::ULong>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) set_geometry(poses[i], data.geometry.elementGeometries[static_cast<CORBA::ULong>(i)]);
  // A ring has no scan angles: each transducer's direction is in its element geometry, and the cone is the angular resolution.
  data.config.minAngle = 0;
  data.config.maxAngle = 0;
  data.config.angularRes = info.cone;
  data.config.minRange = info.min_range;
  data.config.maxRange = info.max_range;
  data.config.rangeRes = 0;
  data.config.frequency = info.rate;
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
