#include "ros/from_device.h"

#include <algorithm>
#include <span>
#include <vector>

#include "base/text.h"
#include "ros/rotation.h"

namespace ros {

BatteryState battery_message(const shm::Iface& iface, const std::string& frame) {
  const auto& info = iface.info<shm::BatteryInfo>();
  const auto& sample = iface.sample<shm::BatterySample>();
  const auto number = [](double value) { return static_cast<float>(value); };
  BatteryState message{.header = header_of(sample.stamp, frame),
                       .voltage = number(sample.voltage),
                       .current = number(-sample.current),
                       .charge = number(sample.charge),
                       .capacity = number(info.capacity),
                       .design_capacity = number(info.capacity),
                       .percentage = number(sample.level),
                       .location = text_of(info.name)};
  message.power_supply_status = sample.state == RTMSIM_BATTERY_CHARGES  ? BatteryState::charging
                                : sample.state == RTMSIM_BATTERY_FULL   ? BatteryState::full
                                : sample.state == RTMSIM_BATTERY_DRAINS ? BatteryState::discharging
                                                                        : BatteryState::not_charging;
  return message;
}

std::optional<TwistWithCovarianceStamped> dvl_message(const shm::Iface& iface, const std::string& frame) {
  const auto& sample = iface.sample<shm::DvlSample>();
  if (sample.has_velocity == 0) return std::nullopt;
  TwistWithCovarianceStamped message{.header = header_of(sample.stamp, frame)};
  message.twist.twist.linear = vector_of(sample.velocity);
  for (std::size_t row = 0; row < 3; ++row)
    std::copy_n(sample.covariance + 3 * row, 3, message.twist.covariance.begin() + static_cast<std::ptrdiff_t>(6 * row));
  return message;
}

FluidPressure air_speed_message(const shm::Iface& iface, const std::string& frame) {
  const auto& sample = iface.sample<shm::AirSpeedSample>();
  const double noise = iface.info<shm::MeterInfo>().noise[0];
  return {header_of(sample.stamp, frame), sample.pressure, noise * noise};
}

NavSatFix ins_fix(const shm::Iface& iface, const std::string& frame) {
  return fix_of(iface.info<shm::InsInfo>(), iface.sample<shm::InsSample>(), frame);
}

Imu ins_orientation(const shm::Iface& iface, const std::string& frame) {
  const auto& sample = iface.sample<shm::InsSample>();
  const double* angles = sample.orientation;
  Imu imu{.header = header_of(sample.stamp, frame), .orientation = quaternion_of({angles[0], angles[1], angles[2]})};
  imu.angular_velocity_covariance[0] = imu.linear_acceleration_covariance[0] = -1;
  return imu;
}

TwistStamped ins_velocity(const shm::Iface& iface, const std::string& frame) {
  const auto& sample = iface.sample<shm::InsSample>();
  return {header_of(sample.stamp, frame), {vector_of(sample.velocity), {}}};
}

Text rfid_message(const shm::Iface& iface, const std::string&) {
  std::vector<std::string> ids;
  for (const auto& tag : iface.elements<shm::RfidTag>()) ids.push_back(text_of(tag.id));
  return {base::join(ids, "\n")};
}

Text wireless_message(const shm::Iface& iface, const std::string&) {
  std::vector<std::string> lines;
  for (const auto& radio : iface.elements<shm::Radio>())
    lines.push_back(base::format_number(radio.level) + " " + base::format_number(radio.frequency) + " " + text_of(radio.essid));
  return {base::join(lines, "\n")};
}

JointState wheels_message(const shm::Iface& iface, const std::string& frame) {
  JointState message{.header = header_of(iface.sample<shm::WheelsSample>().stamp, frame)};
  for (const auto& wheel : iface.info_elements<shm::Wheel>()) message.names.push_back(text_of(wheel.joint));
  for (const auto& encoder : iface.elements<shm::WheelState>()) {
    message.position.push_back(encoder.angle);
    message.velocity.push_back(encoder.speed);
  }
  return message;
}

std::optional<PoseWithCovarianceStamped> localization_message(const shm::Iface& iface, const std::string& frame) {
  const auto& sample = iface.sample<shm::LocalizationSample>();
  if (sample.count == 0) return std::nullopt;
  const auto& best = iface.elements<shm::Hypothesis>().front();
  PoseWithCovarianceStamped message{header_of(sample.stamp, frame), {pose_of(pose_at(best.pose[0], best.pose[1], 0, best.pose[2])), {}}};
  const double* c = best.covariance;  // xx xy xa yy ya aa
  auto& all = message.pose.covariance;
  all[0] = c[0], all[1] = all[6] = c[1], all[5] = all[30] = c[2];
  all[7] = c[3], all[11] = all[31] = c[4], all[35] = c[5];
  return message;
}

Contacts contacts_message(const shm::Iface& iface, const std::string& frame) {
  const auto view = iface.bumper();
  Contacts message{header_of(view.sample->stamp, frame), {}};
  const std::string own = iface.name();
  for (const shm::Contact& contact : view.contacts) {
    Contact one;
    one.collision1 = {0, own, Entity::collision};
    one.collision2 = {0, text_of(contact.other), Entity::collision};
    one.positions.push_back(vector_of(contact.position));
    one.normals.push_back(vector_of(contact.normal));
    one.depths.push_back(contact.depth);
    JointWrench wrench;
    wrench.header = message.header;
    wrench.body_1_name.data = own;
    wrench.body_2_name.data = one.collision2.label;
    wrench.body_1_wrench.force = vector_of(contact.force);
    wrench.body_2_wrench.force = {-contact.force[0], -contact.force[1], -contact.force[2]};
    one.wrenches.push_back(std::move(wrench));
    message.contacts.push_back(std::move(one));
  }
  return message;
}

// ---- what cameras recognise ----

namespace {

template <class Element>
std::span<const Element> filled(const shm::Iface& iface) {
  return {reinterpret_cast<const Element*>(iface.sample_followers(0)), iface.filled()};
}

// Those of the sample before disappear.
MarkerArray no_cubes(const shm::Iface& iface, const std::string& frame) {
  MarkerArray array;
  array.markers.push_back({.header = header_of(iface.sample<shm::Stamp>(), frame), .ns = iface.name(), .action = Marker::remove_all});
  return array;
}

void add_cube(MarkerArray& array, const shm::Pose& pose, const Vector3& size, const std::string& text) {
  Marker cube{.header = array.markers.front().header, .ns = array.markers.front().ns};
  cube.id = static_cast<std::int32_t>(array.markers.size());
  cube.type = Marker::cube;
  cube.pose = pose_of(pose);
  cube.scale = size;
  cube.color = {0.2F, 0.8F, 0.3F, 0.6F};
  cube.text = text;
  array.markers.push_back(std::move(cube));
}

ObjectHypothesisWithPose certain(const shm::Box& box) { return {{std::to_string(box.label), 1}, {pose_of(box.pose)}}; }

}  // namespace

MarkerArray seen_models_message(const shm::Iface& iface, const std::string& frame) {
  auto array = no_cubes(iface, frame);
  for (const auto& model : filled<shm::SeenModel>(iface)) add_cube(array, model.pose, {0.1, 0.1, 0.1}, text_of(model.name));
  return array;
}

MarkerArray marks_message(const shm::Iface& iface, const std::string& frame) {
  auto array = no_cubes(iface, frame);
  for (const auto& mark : filled<shm::Mark>(iface)) add_cube(array, mark.pose, {0.01, mark.size[1], mark.size[2]}, std::to_string(mark.id));
  return array;
}

Detection2DArray image_boxes_message(const shm::Iface& iface, const std::string& frame) {
  Detection2DArray array{header_of(iface.sample<shm::Stamp>(), frame)};
  for (const shm::Box& box : filled<shm::Box>(iface)) {
    array.detections.push_back(
        {array.header, {certain(box)}, {{{box.center[0], box.center[1]}, 0}, box.size[0], box.size[1]}, text_of(box.name)});
  }
  return array;
}

Detection3DArray oriented_boxes_message(const shm::Iface& iface, const std::string& frame) {
  Detection3DArray array{header_of(iface.sample<shm::Stamp>(), frame)};
  for (const shm::Box& box : filled<shm::Box>(iface)) {
    array.detections.push_back(
        {array.header, {certain(box)}, {pose_of(box.pose), {box.extent[0], box.extent[1], box.extent[2]}}, text_of(box.name)});
  }
  return array;
}

}  // namespace ros
