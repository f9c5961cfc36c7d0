#include "sensor_devices.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "protocol/payloads.h"

namespace gateway {
namespace {

constexpr double pi = std::numbers::pi;

std::int32_t scaled(double value, double factor) {
  return static_cast<std::int32_t>(std::clamp(std::round(value * factor), -2147483648.0, 2147483647.0));
}

namespace imu_data {
constexpr std::uint8_t state = 1, calibrated = 2, quaternion = 3, euler = 4, full = 5;
}

}  // namespace

// The series of the transverse Mercator projection in powers of the distance from the central meridian; good to a millimetre in a zone.
Utm to_utm(double latitude, double longitude) {
  constexpr double a = 6378137.0, f = 1 / 298.257223563, k0 = 0.9996;
  constexpr double e2 = f * (2 - f), e4 = e2 * e2, e6 = e4 * e2, ep2 = e2 / (1 - e2);
  const double zone = std::clamp(std::floor((longitude * 180 / pi + 180) / 6), 0.0, 59.0);
  const double centre = (zone * 6 - 177) * pi / 180;
  const double s = std::sin(latitude), c = std::cos(latitude), t = std::tan(latitude) * std::tan(latitude);
  const double n = a / std::sqrt(1 - e2 * s * s), q = ep2 * c * c, d = (longitude - centre) * c;
  const double m =
      a * ((1 - e2 / 4 - 3 * e4 / 64 - 5 * e6 / 256) * latitude - (3 * e2 / 8 + 3 * e4 / 32 + 45 * e6 / 1024) * std::sin(2 * latitude) +
           (15 * e4 / 256 + 45 * e6 / 1024) * std::sin(4 * latitude) - (35 * e6 / 3072) * std::sin(6 * latitude));
  const double d2 = d * d, d3 = d2 * d, d4 = d2 * d2, d5 = d4 * d, d6 = d4 * d2;
  const double east = k0 * n * (d + (1 - t + q) * d3 / 6 + (5 - 18 * t + t * t + 72 * q - 58 * ep2) * d5 / 120);
  const double north =
      k0 * (m + n * std::tan(latitude) *
                    (d2 / 2 + (5 - t + 9 * q + 4 * q * q) * d4 / 24 + (61 - 58 * t + t * t + 600 * q - 330 * ep2) * d6 / 720));
  return {east + 500000, latitude < 0 ? north + 10000000 : north};
}

// ---- gps ----

namespace {

// What a gps and an ins have alike.
template <class Info, class Sample>
player::GpsState gps_state(const Info& info, const Sample& sample) {
  const auto utm = to_utm(sample.latitude * pi / 180, sample.longitude * pi / 180);
  player::GpsState state;
  state.seconds = static_cast<std::uint32_t>(sample.stamp.sim_time_ns / 1'000'000'000);
  state.microseconds = static_cast<std::uint32_t>(sample.stamp.sim_time_ns / 1000 % 1'000'000);
  state.latitude = scaled(sample.latitude, 1e7);
  state.longitude = scaled(sample.longitude, 1e7);
  state.altitude = scaled(sample.altitude, 1e3);
  state.speed = std::hypot(sample.velocity[0], sample.velocity[1]);
  const double course = std::atan2(sample.velocity[0], sample.velocity[1]);
  state.course = course < 0 ? course + 2 * pi : course;
  state.utm_east = utm.east * 100;
  state.utm_north = utm.north * 100;
  state.quality = 1;
  state.horizontal_error = info.position_noise;
  state.vertical_error = info.altitude_noise;
  return state;
}

}  // namespace

void Gps::show_sample() {
  const auto state = iface().type() == shm::IfaceType::gps ? gps_state(iface().info<shm::GpsInfo>(), iface().sample<shm::GpsSample>())
                                                           : gps_state(iface().info<shm::InsInfo>(), iface().sample<shm::InsSample>());
  publish(1, player::encode(state), iface().sample<shm::Stamp>());
}

std::optional<Answer> Gps::answer(std::uint8_t, const std::string&, const Later&) { return nack(); }

// ---- imu ----

void Imu::show_sample() {
  if (iface().type() == shm::IfaceType::imu) return show(iface().sample<shm::ImuSample>(), companion().get());
  const auto& field = iface().sample<shm::MagnetometerSample>();
  shm::ImuSample still{};
  still.stamp = field.stamp;
  still.orientation[0] = 1;
  show(still, source().get());
}

namespace {

shm::Pose turn_of(const double (&q)[4]) { return {0, 0, 0, q[0], q[1], q[2], q[3]}; }

shm::Pose product(const shm::Pose& a, const shm::Pose& b) {
  return {0,
          0,
          0,
          a.qw * b.qw - a.qx * b.qx - a.qy * b.qy - a.qz * b.qz,
          a.qw * b.qx + a.qx * b.qw + a.qy * b.qz - a.qz * b.qy,
          a.qw * b.qy - a.qx * b.qz + a.qy * b.qw + a.qz * b.qx,
          a.qw * b.qz + a.qx * b.qy - a.qy * b.qx + a.qz * b.qw};
}

}  // namespace

// That of the next sample is this one.
bool Imu::reset(const player::Pose3d& angles) {
  for (const double angle : {angles.roll, angles.pitch, angles.yaw}) {
    if (!std::isfinite(angle)) return false;
  }
  if (iface().type() != shm::IfaceType::imu) return false;
  asked_ = angles;
  return true;
}

void Imu::show(shm::ImuSample sample, Source* magnetometer) {
  if (const auto asked = std::exchange(asked_, std::nullopt)) {
    auto back = turn_of(sample.orientation);
    back = {0, 0, 0, back.qw, -back.qx, -back.qy, -back.qz};
    turned_ = product(shm::euler_pose(0, 0, 0, asked->roll, asked->pitch, asked->yaw), back);
  }
  const shm::Pose turned = product(turned_, turn_of(sample.orientation));
  auto& q = sample.orientation;
  q[0] = turned.qw, q[1] = turned.qx, q[2] = turned.qy, q[3] = turned.qz;
  const auto angles = to_pose3d({0, 0, 0, q[0], q[1], q[2], q[3]});
  player::ImuCalibrated calibrated;
  for (int i = 0; i < 3; ++i) {
    calibrated.acceleration[i] = static_cast<float>(sample.acceleration[i]);
    calibrated.angular_velocity[i] = static_cast<float>(sample.angular_velocity[i]);
  }
  if (magnetometer != nullptr && magnetometer->has_sample()) {
    const auto& field = magnetometer->iface().sample<shm::MagnetometerSample>().field;
    for (int i = 0; i < 3; ++i) calibrated.magnetic_field[i] = static_cast<float>(field[i]);
  }
  player::XdrWriter out;
  if (kind_ == imu_data::state) {
    player::put(out, angles);
  } else if (kind_ == imu_data::full) {
    const auto& w = sample.angular_velocity;
    const auto& a = sample.acceleration;
    player::put(out, angles);
    player::put(out, player::Pose3d{0, 0, 0, w[0], w[1], w[2]});
    player::put(out, player::Pose3d{a[0], a[1], a[2], 0, 0, 0});
  } else {
    player::put(out, calibrated);
    if (kind_ == imu_data::quaternion) {
      for (const double value : q) out.f32(static_cast<float>(value));
    } else if (kind_ == imu_data::euler) {
      for (const double value : {angles.roll, angles.pitch, angles.yaw}) out.f64(value);
    }
  }
  publish(kind_, out.bytes(), sample.stamp);
}

std::optional<Answer> Imu::answer(std::uint8_t subtype, const std::string& payload, const Later&) {
  constexpr std::uint8_t set_data_type = 1, reset_orientation = 2, reset_euler = 3;
  if (subtype == reset_orientation) return player::decode_u32(payload) && reset({}) ? ack() : nack();
  if (subtype == reset_euler) {
    const auto angles = player::decode_pose3d(payload);
    return angles && reset(*angles) ? ack() : nack();
  }
  const auto kind = player::decode_byte(payload);
  if (subtype != set_data_type || !kind || *kind < imu_data::state || *kind > imu_data::full) return nack();
  kind_ = *kind;
  return ack();
}

// ---- bumper ----

// It looks away from the middle of the robot, along the shorter of its sides; a round one is as long as it is wide.
static player::BumperShape shape_of(const shm::BumperInfo& info) {
  player::BumperShape shape{to_pose3d(info.middle), static_cast<float>(std::max(info.size[0], info.size[1])),
                            static_cast<float>(info.radius)};
  if (info.radius > 0 || info.size[0] == info.size[1]) return shape;
  const bool looks_along_x = info.size[0] < info.size[1];
  const double along = shape.pose.yaw + (looks_along_x ? 0 : pi / 2);
  const bool is_behind = shape.pose.x * std::cos(along) + shape.pose.y * std::sin(along) < 0;
  shape.pose.yaw = std::remainder(along + (is_behind ? pi : 0), 2 * pi);
  return shape;
}

void Bumper::show_sample() {
  const auto view = iface().bumper();
  publish(1, player::encode_bumpers({view.sample->total > 0}), view.sample->stamp);
}

std::optional<Answer> Bumper::answer(std::uint8_t subtype, const std::string&, const Later&) {
  constexpr std::uint8_t get_geometry = 1;
  if (subtype != get_geometry) return nack();
  return ack(player::encode_bumper_shapes({shape_of(iface().info<shm::BumperInfo>())}));
}

}  // namespace gateway
