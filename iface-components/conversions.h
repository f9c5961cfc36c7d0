// Converts samples of ifaces to the standard data types. Angles in rad, lengths in m, simulated time stamps. Pure; any thread.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>
#include <shm/client.h>

#include <array>
#include <chrono>
#include <vector>

namespace iface {

RTC::Time to_time(std::int64_t sim_time_ns);
RTC::Point3D to_point(const shm::Pose& pose);
// Roll, pitch, yaw about the fixed x, y, z axes, in this order.
RTC::Orientation3D to_orientation(const shm::Pose& pose);
RTC::Pose3D to_pose(const shm::Pose& pose);
// Without a size, or with length, width and height [m].
RTC::Geometry3D to_geometry(const shm::Pose& pose, const double* size = nullptr);
RTC::Geometry2D to_geometry_2d(const shm::Pose& pose, const double* size);

// A range on a port is never NaN, never negative, never infinite: no hit is max_range, too near is min_range.
double port_range(float range, double min_range, double max_range);

// The layer of a scanner that looks nearest to the horizon.
std::uint32_t level_layer(const shm::LaserInfo& info);
RTC::RangerGeometry ranger_geometry(const shm::LaserInfo& info);
RTC::RangerGeometry ranger_geometry(const shm::SonarInfo& info, std::span<const shm::Pose> poses);
RTC::RangerConfig ranger_config(const shm::LaserInfo& info);
RTC::RangerConfig ranger_config(const shm::SonarInfo& info);
// One layer of a scan, with the scanner's geometry and configuration. Keeps the memory that `data` has.
void to_range_data(const shm::LaserInfo& info, const shm::ScanView& scan, std::uint32_t layer, RTC::RangeData& data);
// Intensities of one layer, from 0 to 1; what the world says above that is 1.
void to_intensity_data(const shm::LaserInfo& info, const shm::ScanView& scan, std::uint32_t layer, RTC::IntensityData& data);
void to_range_data(const shm::SonarInfo& info, std::span<const shm::Pose> poses, const shm::SonarView& scan, RTC::RangeData& data);
struct RayPoint {
  std::array<float, 3> position;  // in the sensor's frame [m]; NaN: the ray has hit nothing, or something too near
  float intensity;                // 0 to 1
  std::uint32_t ring;             // its layer, 0: the lowest
  float time;                     // since the first beam of the scan [s]; 0 unless the scanner turns meanwhile
};
// The points of all layers in the order of the scan, with those that are NaN or without.
void to_points(const shm::LaserInfo& info, const shm::ScanView& scan, bool with_misses, std::vector<RayPoint>& points);
void to_gps_data(const shm::GpsInfo& info, const shm::GpsSample& sample, RTC::GPSData& data);

// Where the ray of a pixel goes, per metre of depth: to the right and down. u, v [pixel]: 0.5 is the middle of the first. Lenses that
// distort are taken into account.
struct PixelRay {
  double right = 0;
  double down = 0;
};
PixelRay to_ray(const shm::CameraInfo& info, double u, double v);

}  // namespace iface
