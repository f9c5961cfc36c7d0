// Batteries, sound, radio, wheels and fused estimates as channels.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "base/text.h"
#include "channels/views/view_parts.h"

namespace channels {
namespace {

using ros::diagonal;
using ros::pose_at;
using ros::vector_of;

std::array<double, 36> covariance_of(double xx, double xy, double xa, double yy, double ya, double aa) {
  std::array<double, 36> all{};
  all[0] = xx, all[1] = all[6] = xy, all[5] = all[30] = xa;
  all[7] = yy, all[11] = all[31] = ya, all[35] = aa;
  return all;
}

ros::Quaternion quaternion_of(const double (&angles)[3]) {
  const double cr = std::cos(angles[0] / 2), sr = std::sin(angles[0] / 2), cp = std::cos(angles[1] / 2), sp = std::sin(angles[1] / 2);
  const double cy = std::cos(angles[2] / 2), sy = std::sin(angles[2] / 2);
  return {sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy};
}

// The current of ROS is positive while the battery charges.
ros::BatteryState battery_message(const shm::Iface& iface) {
  const auto& info = iface.info<shm::BatteryInfo>();
  const auto& sample = iface.sample<shm::BatterySample>();
  using State = ros::BatteryState;
  const auto number = [](double value) { return static_cast<float>(value); };
  State message{.header = header_of(sample.stamp, text_of(info.model)),
                .voltage = number(sample.voltage),
                .current = number(-sample.current),
                .charge = number(sample.charge),
                .capacity = number(info.capacity),
                .design_capacity = number(info.capacity),
                .percentage = number(sample.level),
                .location = text_of(info.name)};
  message.power_supply_status = sample.state == RTMSIM_BATTERY_CHARGES  ? State::charging
                                : sample.state == RTMSIM_BATTERY_FULL   ? State::full
                                : sample.state == RTMSIM_BATTERY_DRAINS ? State::discharging
                                                                        : State::not_charging;
  return message;
}

IfaceView battery_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::BatteryState>(iface)};
  view.rate = iface.info<shm::BatteryInfo>().rate;
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    if (from.sample<shm::Stamp>().valid != 0) said.add(0, battery_message(from));
  };
  return view;
}

ros::TwistWithCovarianceStamped dvl_message(const shm::Iface& iface) {
  const auto& sample = iface.sample<shm::DvlSample>();
  ros::TwistWithCovarianceStamped message{.header = header_of(sample.stamp, iface.name())};
  message.twist.twist.linear = vector_of(sample.velocity);
  for (std::size_t row = 0; row < 3; ++row)
    std::copy_n(sample.covariance + 3 * row, 3, message.twist.covariance.begin() + static_cast<std::ptrdiff_t>(6 * row));
  return message;
}

// Only while the velocity is known.
IfaceView dvl_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::TwistWithCovarianceStamped>(iface)};
  place<shm::DvlInfo>(view, iface);
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    const auto& sample = from.sample<shm::DvlSample>();
    if (sample.stamp.valid != 0 && sample.has_velocity != 0) said.add(0, dvl_message(from));
  };
  return view;
}

ros::FluidPressure air_speed_message(const shm::Iface& iface, const std::string& frame) {
  const auto& sample = iface.sample<shm::AirSpeedSample>();
  const double noise = iface.info<shm::MeterInfo>().noise[0];
  return {header_of(sample.stamp, frame), sample.pressure, noise * noise};
}

IfaceView ins_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::NavSatFix>(iface, "/fix"), channel<ros::Imu>(iface, "/orientation"),
                   channel<ros::TwistStamped>(iface, "/velocity")};
  place<shm::InsInfo>(view, iface);
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    const auto& info = from.info<shm::InsInfo>();
    const auto& sample = from.sample<shm::InsSample>();
    if (sample.stamp.valid == 0) return;
    const auto header = header_of(sample.stamp, from.name());
    const double flat = info.position_noise * info.position_noise;
    said.add(0, ros::NavSatFix{.header = header,
                               .latitude = sample.latitude,
                               .longitude = sample.longitude,
                               .altitude = sample.altitude,
                               .position_covariance = diagonal(flat, flat, info.altitude_noise * info.altitude_noise),
                               .position_covariance_type = 2});
    ros::Imu turn{.header = header, .orientation = quaternion_of(sample.orientation)};
    turn.angular_velocity_covariance[0] = turn.linear_acceleration_covariance[0] = -1;  // not measured
    said.add(1, turn);
    said.add(2, ros::TwistStamped{header, {vector_of(sample.velocity), {}}});
  };
  return view;
}

// A line for each tag.
ros::Text rfid_message(const shm::Iface& iface, const std::string&) {
  std::vector<std::string> ids;
  for (const auto& tag : iface.elements<shm::RfidTag>()) ids.push_back(text_of(tag.id));
  return {base::join(ids, "\n")};
}

// A line for each transmitter: its level [dBm], its frequency [MHz], its name.
ros::Text wireless_message(const shm::Iface& iface, const std::string&) {
  std::vector<std::string> lines;
  for (const auto& radio : iface.elements<shm::Radio>())
    lines.push_back(base::format_number(radio.level) + " " + base::format_number(radio.frequency) + " " + text_of(radio.essid));
  return {base::join(lines, "\n")};
}

IfaceView wheels_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::JointState>(iface)};
  view.rate = iface.info<shm::WheelsInfo>().rate;
  std::vector<std::string> names;
  for (const auto& wheel : iface.info_elements<shm::Wheel>()) names.push_back(text_of(wheel.joint));
  view.tell = [names](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    const auto& sample = from.sample<shm::WheelsSample>();
    if (sample.stamp.valid == 0) return;
    ros::JointState message{.header = header_of(sample.stamp, from.name()), .names = names};
    for (const auto& encoder : from.elements<shm::WheelState>()) {
      message.position.push_back(encoder.angle);
      message.velocity.push_back(encoder.speed);
    }
    said.add(0, message);
  };
  return view;
}

// The best hypothesis.
IfaceView localization_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::PoseWithCovarianceStamped>(iface)};
  view.rate = iface.info<shm::LocalizationInfo>().rate;
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    const auto& sample = from.sample<shm::LocalizationSample>();
    if (sample.stamp.valid == 0 || sample.count == 0) return;
    const auto& best = from.elements<shm::Hypothesis>().front();
    const double* c = best.covariance;
    said.add(0, ros::PoseWithCovarianceStamped{
                    header_of(sample.stamp, world_frame),
                    {pose_of(pose_at(best.pose[0], best.pose[1], 0, best.pose[2])), covariance_of(c[0], c[1], c[2], c[3], c[4], c[5])}});
  };
  return view;
}

}  // namespace

std::optional<IfaceView> plain_view(const shm::Iface& iface) {
  switch (iface.type()) {
    case shm::IfaceType::battery:
      return battery_view(iface);
    case shm::IfaceType::dvl:
      return dvl_view(iface);
    case shm::IfaceType::air_speed:
      return simple_view<ros::FluidPressure, shm::MeterInfo, shm::AirSpeedSample>(iface, air_speed_message);
    case shm::IfaceType::ins:
      return ins_view(iface);
    case shm::IfaceType::rfid:
      return simple_view<ros::Text, shm::RfidInfo, shm::RfidSample>(iface, rfid_message);
    case shm::IfaceType::wireless:
      return simple_view<ros::Text, shm::WirelessInfo, shm::WirelessSample>(iface, wireless_message);
    case shm::IfaceType::wheels:
      return wheels_view(iface);
    case shm::IfaceType::localization:
      return localization_view(iface);
    default:
      return std::nullopt;
  }
}

}  // namespace channels
