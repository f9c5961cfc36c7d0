#include "ros/from_iface.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

namespace ros {

Time time_of(const shm::Stamp& stamp) { return to_time(std::chrono::nanoseconds(stamp.sim_time_ns)); }

Header header_of(const shm::Stamp& stamp, const std::string& frame) { return {time_of(stamp), frame}; }

Vector3 vector_of(const double* v) { return {v[0], v[1], v[2]}; }

std::array<double, 9> diagonal(double a, double b, double c) { return {a, 0, 0, 0, b, 0, 0, 0, c}; }

shm::Pose pose_at(double x, double y, double z, double yaw) { return {x, y, z, std::cos(yaw / 2), 0, 0, std::sin(yaw / 2)}; }

Pose pose_of(const shm::Pose& pose) { return {{pose.x, pose.y, pose.z}, {pose.qx, pose.qy, pose.qz, pose.qw}}; }

shm::Pose product(const shm::Pose& a, const shm::Pose& b) {
  const double tx = 2 * (a.qy * b.z - a.qz * b.y), ty = 2 * (a.qz * b.x - a.qx * b.z), tz = 2 * (a.qx * b.y - a.qy * b.x);
  return {a.x + b.x + a.qw * tx + (a.qy * tz - a.qz * ty),       a.y + b.y + a.qw * ty + (a.qz * tx - a.qx * tz),
          a.z + b.z + a.qw * tz + (a.qx * ty - a.qy * tx),       a.qw * b.qw - a.qx * b.qx - a.qy * b.qy - a.qz * b.qz,
          a.qw * b.qx + a.qx * b.qw + a.qy * b.qz - a.qz * b.qy, a.qw * b.qy - a.qx * b.qz + a.qy * b.qw + a.qz * b.qx,
          a.qw * b.qz + a.qx * b.qy - a.qy * b.qx + a.qz * b.qw};
}

shm::Pose inverse(const shm::Pose& p) {
  const double w = p.qw, x = -p.qx, y = -p.qy, z = -p.qz;
  const double tx = 2 * (y * p.z - z * p.y), ty = 2 * (z * p.x - x * p.z), tz = 2 * (x * p.y - y * p.x);
  return {-(p.x + w * tx + (y * tz - z * ty)), -(p.y + w * ty + (z * tx - x * tz)), -(p.z + w * tz + (x * ty - y * tx)), w, x, y, z};
}

TransformStamped transform_of(const shm::Stamp& stamp, const std::string& parent, const std::string& child, const shm::Pose& pose) {
  return {header_of(stamp, parent), child, {{pose.x, pose.y, pose.z}, {pose.qx, pose.qy, pose.qz, pose.qw}}};
}

LaserScan empty_scan(const shm::Iface& iface, const std::string& frame) {
  const auto& info = iface.info<shm::LaserInfo>();
  const auto number = [](double value) { return static_cast<float>(value); };
  return {.header = {{}, frame},
          .angle_min = number(info.min_angle),
          .angle_max = number(info.max_angle),
          .angle_increment = number(info.angle_step),
          .scan_time = info.rate > 0 ? number(1 / info.rate) : 0,
          .range_min = number(info.min_range),
          .range_max = number(info.max_range)};
}

// Nearly always all octets are, which is found many times faster than by looking at each number.
bool is_zero(std::span<const float> numbers) {
  const auto octets = std::as_bytes(numbers);
  if (octets.empty() || (octets[0] == std::byte{0} && std::memcmp(octets.data(), octets.data() + 1, octets.size() - 1) == 0)) return true;
  return std::ranges::all_of(numbers, [](float one) { return one == 0; });
}

std::string encoding_of(shm::Format format) {
  using enum shm::Format;
  switch (shm::shown_as(format)) {
    case rgb8:
      return "rgb8";
    case mono8:
      return "mono8";
    case depth_float:
      return "32FC1";
    case bgr8:
      return "bgr8";
    case rgba8:
      return "rgba8";
    case bgra8:
      return "bgra8";
    case mono16:
      return "mono16";
    case bayer_rggb8:
      return "bayer_rggb8";
    case bayer_bggr8:
      return "bayer_bggr8";
    case bayer_gbrg8:
      return "bayer_gbrg8";
    case bayer_grbg8:
      return "bayer_grbg8";
    case points_float:
    case points_intensity_float:
    case labels:
    case thermal16:
    case thermal8:
      break;
  }
  return "";
}

CameraInfo camera_message(const shm::CameraInfo& info, const Header& header) {
  return {.header = header,
          .height = info.height,
          .width = info.width,
          .distortion_model = "plumb_bob",
          .d = {std::begin(info.distortion), std::end(info.distortion)},
          .k = {info.fx, 0, info.cx, 0, info.fy, info.cy, 0, 0, 1},
          .r = diagonal(1, 1, 1),
          .p = {info.fx, 0, info.cx, 0, 0, info.fy, info.cy, 0, 0, 0, 1, 0}};
}

Image image_message(const shm::HeldFrame& frame, const Header& header) {
  const auto& head = frame.head();
  return {.header = header,
          .height = head.height,
          .width = head.width,
          .encoding = encoding_of(static_cast<shm::Format>(head.format)),
          .step = head.stride,
          .data = {reinterpret_cast<const std::uint8_t*>(frame.data().data()), frame.data().size()}};
}

std::optional<base::JpegPixels> jpeg_pixels(shm::Format format) {
  switch (format) {
    case shm::Format::rgb8:
      return base::JpegPixels::rgb;
    case shm::Format::bgr8:
      return base::JpegPixels::bgr;
    case shm::Format::rgba8:
      return base::JpegPixels::rgba;
    case shm::Format::bgra8:
      return base::JpegPixels::bgra;
    case shm::Format::mono8:
      return base::JpegPixels::grey;
    default:
      return std::nullopt;
  }
}

base::Result<std::span<const std::uint8_t>> to_jpeg(base::JpegEncoder& encoder, const shm::HeldFrame& frame, base::JpegPixels kind) {
  constexpr int quality = 85;
  const auto& head = frame.head();
  return encoder.encode({reinterpret_cast<const std::uint8_t*>(frame.data().data()), frame.data().size()}, static_cast<int>(head.width),
                        static_cast<int>(head.height), head.stride, kind, quality);
}

Imu imu_message(const shm::Iface& iface, const std::string& frame) {
  const auto& info = iface.info<shm::ImuInfo>();
  const auto& sample = iface.sample<shm::ImuSample>();
  const double turn = info.angular_velocity_noise * info.angular_velocity_noise;
  const double push = info.acceleration_noise * info.acceleration_noise;
  const double* q = sample.orientation;
  return {.header = header_of(sample.stamp, frame),
          .orientation = {q[1], q[2], q[3], q[0]},
          .angular_velocity = vector_of(sample.angular_velocity),
          .angular_velocity_covariance = diagonal(turn, turn, turn),
          .linear_acceleration = vector_of(sample.acceleration),
          .linear_acceleration_covariance = diagonal(push, push, push)};
}

JointState joints_message(const shm::Iface& iface) {
  const auto* joints = reinterpret_cast<const shm::Joint*>(iface.info_followers(0));
  const auto* states = reinterpret_cast<const shm::JointState*>(iface.sample_followers(0));
  JointState message{.header = header_of(iface.sample<shm::JointsSample>().stamp, "")};
  for (std::size_t i = 0; i < iface.count(); ++i) {
    message.names.push_back(text_of(joints[i].name));
    message.position.push_back(states[i].position);
    message.velocity.push_back(states[i].velocity);
    message.effort.push_back(states[i].effort);
  }
  return message;
}

NavSatFix fix_message(const shm::Iface& iface, const std::string& frame) {
  return fix_of(iface.info<shm::GpsInfo>(), iface.sample<shm::GpsSample>(), frame);
}

WrenchStamped wrench_message(const shm::Iface& iface, const std::string& frame) {
  const auto& sample = iface.sample<shm::ForceTorqueSample>();
  return {header_of(sample.stamp, frame), {vector_of(sample.force), vector_of(sample.torque)}};
}

MagneticField field_message(const shm::Iface& iface, const std::string& frame) {
  const auto& sample = iface.sample<shm::MagnetometerSample>();
  const double noise = iface.info<shm::MeterInfo>().noise[0];
  return {header_of(sample.stamp, frame), vector_of(sample.field), diagonal(noise * noise, noise * noise, noise * noise)};
}

FluidPressure pressure_message(const shm::Iface& iface, const std::string& frame) {
  const auto& sample = iface.sample<shm::AirPressureSample>();
  const double noise = iface.info<shm::MeterInfo>().noise[0];
  return {header_of(sample.stamp, frame), sample.pressure, noise * noise};
}

namespace {

std::vector<PointField> point_fields(bool with_intensity) {
  std::vector<PointField> fields = {{"x", 0}, {"y", 4}, {"z", 8}};
  if (with_intensity) fields.push_back({"intensity", 12});
  return fields;
}

}  // namespace

PointCloud2 cloud_message(const shm::Stamp& stamp, const std::string& frame, std::uint32_t width, std::uint32_t height, bool with_intensity,
                          std::span<const std::uint8_t> data) {
  const std::uint32_t step = with_intensity ? 16 : 12;
  return {.header = header_of(stamp, frame),
          .height = height,
          .width = width,
          .point_fields = point_fields(with_intensity),
          .point_step = step,
          .row_step = step * width,
          .data = data};
}

std::vector<RayPoint> ray_points(const shm::LaserInfo& info, const shm::ScanView& scan) {
  std::vector<RayPoint> points;
  points.reserve(scan.ranges.size());
  const double rise = info.layers > 1 ? (info.max_vertical - info.min_vertical) / (info.layers - 1) : 0;
  const double sweep = info.beams > 1 ? 1e-9 * scan.sample->sweep_ns / (info.beams - 1) : 0;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = scan.ranges[i];
    const std::size_t beam = i % info.beams, layer = i / info.beams;
    const double yaw = info.min_angle + static_cast<double>(beam) * info.angle_step;
    const double pitch = info.min_vertical + static_cast<double>(layer) * rise;
    const bool is_hit = std::isfinite(range);
    const auto coordinate = [&](double factor) {
      return is_hit ? static_cast<float>(range * factor) : std::numeric_limits<float>::quiet_NaN();
    };
    points.push_back({coordinate(std::cos(pitch) * std::cos(yaw)), coordinate(std::cos(pitch) * std::sin(yaw)), coordinate(std::sin(pitch)),
                      i < scan.intensities.size() ? scan.intensities[i] : 0.0F, static_cast<std::uint16_t>(layer), 0,
                      static_cast<float>(sweep * static_cast<double>(beam))});
  }
  return points;
}

PointCloud2 ring_message(const shm::LaserInfo& info, const shm::ScanView& scan, const std::string& frame,
                         std::span<const RayPoint> points) {
  shm::Stamp begin = scan.sample->stamp;
  begin.sim_time_ns = std::max<std::int64_t>(begin.sim_time_ns - scan.sample->sweep_ns, 0);
  PointCloud2 message = cloud_message(begin, frame, info.beams, info.layers, true,
                                      {reinterpret_cast<const std::uint8_t*>(points.data()), points.size_bytes()});
  message.point_fields.push_back({"ring", 16, PointField::uint16});
  message.point_fields.push_back({"time", 20});
  message.point_step = sizeof(RayPoint);
  message.row_step = message.point_step * info.beams;
  return message;
}

}  // namespace ros
