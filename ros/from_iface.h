// Samples of ifaces as messages of ROS 2. `frame` is the frame_id of the message. Units and frames are those of ROS (REP 103). One thread
// at a time for each Iface.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/jpeg.h"
#include "base/result.h"
#include "ros/messages.h"
#include "shm/client.h"

namespace ros {

// Of a fixed field of a segment, which need not end.
template <std::size_t size>
std::string text_of(const char (&field)[size]) {
  return std::string(field, ::strnlen(field, size));
}

Time time_of(const shm::Stamp& stamp);
Header header_of(const shm::Stamp& stamp, const std::string& frame);
Vector3 vector_of(const double* v);
std::array<double, 9> diagonal(double a, double b, double c);

shm::Pose pose_at(double x, double y, double z, double yaw);
Pose pose_of(const shm::Pose& pose);
// `second` is in the frame that `first` puts somewhere.
shm::Pose product(const shm::Pose& first, const shm::Pose& second);
shm::Pose inverse(const shm::Pose& pose);
TransformStamped transform_of(const shm::Stamp& stamp, const std::string& parent, const std::string& child, const shm::Pose& pose);

// Of the samples that have a place on the earth, with its noise [m].
template <class Info, class Sample>
NavSatFix fix_of(const Info& info, const Sample& sample, const std::string& frame) {
  const double flat = info.position_noise * info.position_noise;
  return {.header = header_of(sample.stamp, frame),
          .latitude = sample.latitude,
          .longitude = sample.longitude,
          .altitude = sample.altitude,
          .position_covariance = diagonal(flat, flat, info.altitude_noise * info.altitude_noise),
          .position_covariance_type = 2};
}

// What is the same in each scan.
LaserScan empty_scan(const shm::Iface& iface, const std::string& frame);
bool is_zero(std::span<const float> numbers);

// The name that sensor_msgs/msg/Image has for it.
std::string encoding_of(shm::Format format);
CameraInfo camera_message(const shm::CameraInfo& info, const Header& header);
// `frame` must outlive the message.
Image image_message(const shm::HeldFrame& frame, const Header& header);
// The images that a JPEG can hold; mosaics of colour filters, depth and 16 bits of grey stay as they are.
std::optional<base::JpegPixels> jpeg_pixels(shm::Format format);
// The result is valid until the next call.
base::Result<std::span<const std::uint8_t>> to_jpeg(base::JpegEncoder& encoder, const shm::HeldFrame& frame, base::JpegPixels kind);

// Of the latest sample, which has been read.
Imu imu_message(const shm::Iface& iface, const std::string& frame);
JointState joints_message(const shm::Iface& iface);
NavSatFix fix_message(const shm::Iface& iface, const std::string& frame);
WrenchStamped wrench_message(const shm::Iface& iface, const std::string& frame);
MagneticField field_message(const shm::Iface& iface, const std::string& frame);
FluidPressure pressure_message(const shm::Iface& iface, const std::string& frame);

// Points of 12 bytes, or 16 with an intensity. `data` must outlive the message.
PointCloud2 cloud_message(const shm::Stamp& stamp, const std::string& frame, std::uint32_t width, std::uint32_t height, bool with_intensity,
                          std::span<const std::uint8_t> data);

// A scanner of several layers: its hits, in the order of beams; NaN where there is none. `ring` 0 is the lowest layer, `time` [s] counts
// from the first beam, which the stamp of the message is that of.
struct RayPoint {
  float x, y, z, intensity;
  std::uint16_t ring, padding;
  float time;
};
static_assert(sizeof(RayPoint) == 24);
std::vector<RayPoint> ray_points(const shm::LaserInfo& info, const shm::ScanView& scan);
// `points` must outlive the message.
PointCloud2 ring_message(const shm::LaserInfo& info, const shm::ScanView& scan, const std::string& frame, std::span<const RayPoint> points);

}  // namespace ros
