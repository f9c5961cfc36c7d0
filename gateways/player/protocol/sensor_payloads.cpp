// Payloads of sensors.
#include <algorithm>

#include "protocol/payload_codec.h"
#include "protocol/payloads.h"

namespace player {

// ---- laser ----

std::string encode(const LaserScan& scan) {
  return written([&](XdrWriter& out) {
    out.bytes().reserve(40 + 5 * scan.ranges.size());
    for (const float value : {scan.min_angle, scan.max_angle, scan.resolution, scan.max_range}) out.f32(value);
    out.count(scan.ranges.size());
    for (const float range : scan.ranges) out.f32(range);
    out.counted_bytes(scan.intensities);
    out.u32(scan.id);
  });
}

std::optional<LaserScan> decode_laser_scan(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    LaserScan scan;
    for (float* value : {&scan.min_angle, &scan.max_angle, &scan.resolution, &scan.max_range}) *value = in.f32();
    scan.ranges.resize(in.count(4, max_message / 4));
    for (float& range : scan.ranges) range = in.f32();
    scan.intensities = in.counted_bytes(max_message);
    scan.id = in.u32();
    return scan;
  });
}

std::string encode(const LaserConfig& config) {
  return written([&](XdrWriter& out) {
    for (const float value : {config.min_angle, config.max_angle, config.resolution, config.max_range, config.range_resolution})
      out.f32(value);
    out.boolean(config.has_intensity);
    out.f32(config.rate);
  });
}

std::optional<LaserConfig> decode_laser_config(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    LaserConfig config;
    for (float* value : {&config.min_angle, &config.max_angle, &config.resolution, &config.max_range, &config.range_resolution})
      *value = in.f32();
    config.has_intensity = in.boolean();
    config.rate = in.f32();
    return config;
  });
}

// ---- ranger ----

std::string encode(const RangerGeometry& geometry) {
  return written([&](XdrWriter& out) {
    put(out, geometry.pose);
    put(out, geometry.size);
    out.count(geometry.element_poses.size());
    for (const Pose3d& pose : geometry.element_poses) put(out, pose);
    out.count(geometry.element_sizes.size());
    for (const Size3d& size : geometry.element_sizes) put(out, size);
  });
}

std::string encode(const RangerConfig& config) {
  return written([&](XdrWriter& out) {
    for (const double value :
         {config.min_angle, config.max_angle, config.resolution, config.min_range, config.max_range, config.range_resolution, config.rate})
      out.f64(value);
  });
}

std::optional<RangerConfig> decode_ranger_config(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    RangerConfig config;
    for (double* value : {&config.min_angle, &config.max_angle, &config.resolution, &config.min_range, &config.max_range,
                          &config.range_resolution, &config.rate})
      *value = in.f64();
    return config;
  });
}

std::string encode_ranger_values(const std::vector<double>& values) {
  return written([&](XdrWriter& out) {
    out.count(values.size());
    for (const double value : values) out.f64(value);
  });
}

// ---- sonar ----

std::string encode_sonar_ranges(const std::vector<float>& ranges) {
  return written([&](XdrWriter& out) {
    out.count(ranges.size());
    for (const float range : ranges) out.f32(range);
  });
}

std::string encode_poses(const std::vector<Pose3d>& poses) {
  return written([&](XdrWriter& out) {
    out.count(poses.size());
    for (const Pose3d& pose : poses) put(out, pose);
  });
}

// ---- aio, pointcloud3d ----

std::string encode_voltages(const std::vector<double>& values) {
  return written([&](XdrWriter& out) {
    out.count(values.size());
    for (const double value : values) out.f32(static_cast<float>(value));
  });
}

std::string encode_points(const std::vector<Point3d>& points) {
  return written([&](XdrWriter& out) {
    constexpr std::size_t size_of_one = 40;
    out.bytes().reserve(8 + size_of_one * points.size());
    out.count(points.size());
    for (const Point3d& point : points) {
      for (const double value : {point.x, point.y, point.z}) out.f64(value);
      for (int channel = 0; channel < 4; ++channel) out.u32(255);
    }
  });
}

// ---- camera ----

void put(XdrWriter& out, const Image& image) {
  for (const std::uint32_t value : {image.width, image.height, image.bits, static_cast<std::uint32_t>(image.format)}) out.u32(value);
  out.u32(1);  // fdiv
  out.u32(image.is_compressed ? 1 : 0);
  out.counted_bytes(image.pixels);
}

std::string encode(const Image& image) {
  return written([&](XdrWriter& out) {
    out.bytes().reserve(40 + image.pixels.size());
    put(out, image);
  });
}

std::string encode_stereo(const Image& left, const Image& right, const Image& disparity, const std::vector<ColoredPoint>& points) {
  constexpr std::size_t heads = 128, of_a_point = 24;  // [byte]
  return written([&](XdrWriter& out) {
    out.bytes().reserve(heads + left.pixels.size() + right.pixels.size() + disparity.pixels.size() + of_a_point * points.size());
    put(out, left);
    put(out, right);
    put(out, disparity);
    out.count(points.size());
    for (const ColoredPoint& point : points) {
      for (const double value : {point.at.x, point.at.y, point.at.z}) out.f32(static_cast<float>(value));
      for (const std::uint8_t value : point.color) out.u32(value);
    }
    out.u32(0);  // how the images are sent: each for itself
  });
}

std::string encode_camera_source(std::string_view norm, std::int32_t source) {
  return written([&](XdrWriter& out) {
    out.counted_text(norm);
    out.i32(source);
  });
}

// ---- gps, imu, bumper ----

std::string encode(const GpsState& state) {
  return written([&](XdrWriter& out) {
    out.u32(state.seconds);
    out.u32(state.microseconds);
    for (const std::int32_t value : {state.latitude, state.longitude, state.altitude}) out.i32(value);
    for (const double value : {state.speed, state.course, state.utm_east, state.utm_north}) out.f64(value);
    for (const std::uint32_t value : {state.quality, state.satellites, state.hdop, state.vdop}) out.u32(value);
    out.f64(state.horizontal_error);
    out.f64(state.vertical_error);
  });
}

void put(XdrWriter& out, const ImuCalibrated& values) {
  for (const float value : values.acceleration) out.f32(value);
  for (const float value : values.angular_velocity) out.f32(value);
  for (const float value : values.magnetic_field) out.f32(value);
}

// ---- power, rfid, wifi, localize ----

std::string encode(const PowerState& state) {
  constexpr std::uint32_t all = 1 | 2 | 4 | 8 | 16;  // values that are valid
  return written([&](XdrWriter& out) {
    out.u32(all);
    for (const float value : {state.volts, state.percent, state.joules, state.watts}) out.f32(value);
    out.i32(state.charging);
  });
}

std::optional<ChargingPolicy> decode_charging_policy(std::string_view payload) {
  return whole(payload, [](XdrReader& in) {
    const bool has_input = in.boolean();
    return ChargingPolicy{has_input, in.boolean()};
  });
}

std::string encode_tags(const std::vector<std::string>& ids) {
  return written([&](XdrWriter& out) {
    out.count(ids.size());
    for (const std::string& id : ids) {
      out.u32(0);  // type
      out.counted_bytes(id);
    }
  });
}

std::string encode_links(const std::vector<WifiLink>& links) {
  constexpr std::size_t longest = 31;
  constexpr std::uint32_t mode_master = 3, in_dbm = 1;
  constexpr int offset = 256;  // of levels [dBm]
  return written([&](XdrWriter& out) {
    out.count(links.size());
    for (const WifiLink& link : links) {
      out.counted_text(std::string_view(link.name).substr(0, longest));
      out.counted_text("");  // IP address
      out.counted_text(std::string_view(link.essid).substr(0, longest));
      const auto level = static_cast<std::uint32_t>(std::clamp(link.level + offset, 0, offset));
      for (const std::uint32_t value : {mode_master, link.frequency, 0U, level, level, 0U}) out.u32(value);
    }
    for (const std::uint32_t value : {0U, 0U, mode_master, in_dbm, 0U, 0U, 0U}) out.u32(value);
    out.counted_text(links.empty() ? "" : std::string_view(links.front().name).substr(0, longest));
  });
}

std::string encode_hypotheses(double time, const std::vector<Hypothesis>& hypotheses) {
  return written([&](XdrWriter& out) {
    out.u32(0);  // observations that wait
    out.f64(time);
    out.count(hypotheses.size());
    for (const Hypothesis& one : hypotheses) {
      put(out, one.mean);
      for (const double value : one.covariance) out.f64(value);
      out.f64(one.weight);
    }
  });
}

std::string encode_particles(const std::vector<Hypothesis>& hypotheses) {
  return written([&](XdrWriter& out) {
    put(out, hypotheses.empty() ? Pose2d{} : hypotheses.front().mean);
    out.f64(hypotheses.empty() ? 0 : hypotheses.front().covariance[0]);
    out.count(hypotheses.size());
    for (const Hypothesis& one : hypotheses) {
      put(out, one.mean);
      out.f64(one.weight);
    }
  });
}

std::string encode_bumpers(const std::vector<bool>& pressed) {
  std::string bytes;
  for (const bool one : pressed) bytes += one ? '\1' : '\0';
  return written([&](XdrWriter& out) { out.counted_bytes(bytes); });
}

std::string encode_bumper_shapes(const std::vector<BumperShape>& shapes) {
  return written([&](XdrWriter& out) {
    out.count(shapes.size());
    for (const BumperShape& shape : shapes) {
      put(out, shape.pose);
      out.f32(shape.length);
      out.f32(shape.radius);
    }
  });
}

// ---- fiducial, blobfinder ----

std::string encode_fiducials(const std::vector<FiducialItem>& items) {
  return written([&](XdrWriter& out) {
    out.count(items.size());
    for (const FiducialItem& item : items) {
      out.i32(item.id);
      put(out, item.pose);
      put(out, item.uncertainty);
    }
  });
}

std::string encode_fiducial_geometry(const Pose3d& pose, double width, double height) {
  return written([&](XdrWriter& out) {
    put(out, pose);
    put(out, Size3d{});
    out.f64(width);
    out.f64(height);
  });
}

std::string encode_fiducial_fov(double min_range, double max_range, double view_angle) {
  return written([&](XdrWriter& out) {
    for (const double value : {min_range, max_range, view_angle}) out.f32(static_cast<float>(value));
  });
}

std::string encode_blobs(std::uint32_t width, std::uint32_t height, const std::vector<Blob>& blobs) {
  return written([&](XdrWriter& out) {
    out.u32(width);
    out.u32(height);
    out.count(blobs.size());
    for (const Blob& blob : blobs) {
      for (const std::uint32_t value : {blob.id, blob.color, blob.area, blob.x, blob.y, blob.left, blob.right, blob.top, blob.bottom})
        out.u32(value);
      out.f32(blob.range);
    }
  });
}

}  // namespace player
