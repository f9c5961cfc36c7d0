#include "robot_topics.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/log.h"
#include "description.h"
#include "joint_frames.h"
#include "ros/contact_messages.h"
#include "ros/from_device.h"
#include "ros/rotation.h"

namespace ros2 {
namespace {

using shm::HeldFrame;

std::string leaf_of(const std::string& iface, const std::string& model) {
  return iface.starts_with(model + "::") ? iface.substr(model.size() + 2) : iface;
}

template <class T>
void publish_if(Writer* writer, const T& message) {
  if (writer != nullptr && !writer->readers().empty()) publish(*writer, message);
}

template <ros::Message T>
void publish_made(Writer& writer, const T& message) {
  publish(writer, message);
}
template <ros::Message T>
void publish_made(Writer& writer, const std::optional<T>& message) {
  if (message) publish(writer, *message);
}

std::vector<Writer*> without_null(std::vector<Writer*> writers) {
  std::erase(writers, nullptr);
  return writers;
}

}  // namespace

std::vector<ServedRow> served_rows() {
  using enum shm::IfaceType;
  return {
      {laser, "scan; of several layers: points", "sensor_msgs/msg/LaserScan; PointCloud2 (x y z intensity ring time)"},
      {sonar, "SENSOR/range_0, SENSOR/range_1, ...", "sensor_msgs/msg/Range"},
      {camera, "SENSOR/image_raw, SENSOR/image_raw/compressed, SENSOR/camera_info", "sensor_msgs/msg/Image, CompressedImage, CameraInfo"},
      {depth, "SENSOR/depth/image_raw, SENSOR/depth/camera_info", "sensor_msgs/msg/Image (32FC1), CameraInfo"},
      {points, "SENSOR/points", "sensor_msgs/msg/PointCloud2"},
      {imu, "imu/data", "sensor_msgs/msg/Imu"},
      {gps, "gps/fix", "sensor_msgs/msg/NavSatFix"},
      {magnetometer, "imu/mag", "sensor_msgs/msg/MagneticField"},
      {air_pressure, "air_pressure", "sensor_msgs/msg/FluidPressure"},
      {altimeter, "altimeter", "ros_gz_interfaces/msg/Altimeter"},
      {force_torque, "SENSOR/wrench", "geometry_msgs/msg/WrenchStamped"},
      {bumper, "SENSOR/contacts", "ros_gz_interfaces/msg/Contacts"},
      {battery, "battery_state", "sensor_msgs/msg/BatteryState"},
      {dvl, "SENSOR/velocity", "geometry_msgs/msg/TwistWithCovarianceStamped"},
      {air_speed, "air_speed", "sensor_msgs/msg/FluidPressure (of the air that flows in)"},
      {ins, "SENSOR/fix, SENSOR/orientation, SENSOR/velocity",
       "sensor_msgs/msg/NavSatFix, sensor_msgs/msg/Imu, geometry_msgs/msg/TwistStamped"},
      {rfid, "SENSOR/tags", "std_msgs/msg/String (a line for each tag)"},
      {wireless, "SENSOR/transmitters", "std_msgs/msg/String (a line for each: dBm, MHz, name)"},
      {wheels, "SENSOR/wheel_states", "sensor_msgs/msg/JointState"},
      {localization, "SENSOR/pose", "geometry_msgs/msg/PoseWithCovarianceStamped"},
      {logical_camera, "SENSOR/models", "visualization_msgs/msg/MarkerArray"},
      {fiducial, "SENSOR/markers", "visualization_msgs/msg/MarkerArray"},
      {boxes, "SENSOR/detections", "vision_msgs/msg/Detection2DArray; of oriented boxes: Detection3DArray"},
      {joints, "joint_states, /tf", "sensor_msgs/msg/JointState, tf2_msgs/msg/TFMessage"},
      {position2d, "odom, ground_truth/odom, /tf", "nav_msgs/msg/Odometry, tf2_msgs/msg/TFMessage"},
      {position3d, "odom, ground_truth/odom, /tf", "nav_msgs/msg/Odometry, tf2_msgs/msg/TFMessage"},
  };
}

// ---- what all have in common ----

void RobotTopics::make(const Listed& listed) {
  std::vector<ListedIface> own;
  for (const auto& iface : listed.ifaces) {
    if (iface.model == robot_.model_ || iface.name.starts_with(robot_.model_ + "::")) own.push_back(iface);
  }
  // The drive says where the base is, and joints where links are: they come first.
  std::ranges::stable_sort(own, {}, [](const ListedIface& one) {
    using enum shm::IfaceType;
    return one.type == position2d || one.type == position3d ? 0 : one.type == joints ? 1 : 2;
  });
  const bool has_drive = !own.empty() && (own[0].type == shm::IfaceType::position2d || own[0].type == shm::IfaceType::position3d);
  const auto model = std::ranges::find(listed.models, robot_.model_, &ListedModel::name);
  if (model != listed.models.end()) listed_ = &*model;
  for (const auto& iface : own) {
    const auto count = std::ranges::count(own, iface.type, &ListedIface::type);
    add(iface, count == 1);
  }
  if (listed_ == nullptr) return;
  if (!has_drive) put_frame("world", base(), listed_->pose);
  add_description();
}

void RobotTopics::add(const ListedIface& listed, bool is_only) {
  using enum shm::IfaceType;
  if (listed.type == truth || listed.type == simulation) return;
  auto source = robot_.shared_.world.find(listed.type, listed.name);
  if (!source) return;
  const std::string leaf = leaf_of(listed.name, robot_.model_);
  Place place{source, listed.name, is_only ? "" : tokens(leaf) + "/", tokens(leaf), robot_.names_.frame(token(leaf))};
  if (const auto* entry = robot_.shared_.naming.entry(listed.name, ""); entry != nullptr && entry->frame) place.frame = *entry->frame;
  switch (listed.type) {
    case laser:
      return source->iface().info<shm::LaserInfo>().layers == 1 ? add_laser(place) : add_cloud_of_laser(place);
    case sonar:
      return add_sonar(place);
    case camera:
      return add_camera(place, place.leaf);
    case depth:
      return add_camera(place, place.leaf + "/depth");
    case points:
      return add_points(place);
    case position2d:
      return add_position2d(place);
    case position3d:
      return add_position3d(place);
    case joints:
      return add_joints(place);
    case bumper:
      return add_bumper(place);
    case altimeter:
      return add_altimeter(place);
    case imu:
      return add_meter<ros::Imu, shm::ImuInfo>(place, place.front + "imu/data", ros::imu_message);
    case gps:
      return add_meter<ros::NavSatFix, shm::GpsInfo>(place, place.front + "gps/fix", ros::fix_message);
    case magnetometer:
      return add_meter<ros::MagneticField, shm::MeterInfo>(place, place.front + "imu/mag", ros::field_message);
    case air_pressure:
      return add_meter<ros::FluidPressure, shm::MeterInfo>(place, place.front + "air_pressure", ros::pressure_message);
    case force_torque:
      return add_meter<ros::WrenchStamped, shm::MeterInfo>(place, place.leaf + "/wrench", ros::wrench_message);
    default:
      return add_device(place);
  }
}

template <ros::Message T>
Writer* RobotTopics::advertise(const Place& place, const std::string& topic, bool is_large) {
  robot_.types_[place.name].emplace_back(T::name);
  const TopicEntry* entry = robot_.shared_.naming.entry(place.name, std::string(T::name));
  if (entry != nullptr && !entry->is_served) return nullptr;
  std::string name = robot_.names_.topic(entry != nullptr && entry->topic ? *entry->topic : topic);
  if (!robot_.used_topics_.insert(name).second) {
    base::log(base::Level::warn, "ros2-gateway", "{}: topic {} is in use; the topic of {} gets the name {}_2", robot_.model_, name,
              place.name, name);
    robot_.used_topics_.insert(name += "_2");
  }
  Qos qos;
  if (entry != nullptr && entry->depth) qos.depth = *entry->depth;
  if (entry != nullptr && entry->is_transient) qos.is_transient = *entry->is_transient;
  return robot_.node_.advertise<T>(name, qos, is_large);
}

Outlet& RobotTopics::outlet(const Place& place, std::vector<Writer*> writers) {
  robot_.outlets_.push_back({place.source, without_null(std::move(writers)), {}});
  Outlet& made = robot_.outlets_.back();
  if (const auto* entry = robot_.shared_.naming.entry(place.name, ""); entry != nullptr && entry->rate)
    made.period = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / *entry->rate));
  return made;
}

void RobotTopics::put_frame(const std::string& parent, const std::string& child, const shm::Pose& pose) {
  // A camera that recognises boxes is two ifaces with one frame.
  if (std::ranges::find(robot_.static_transforms_, child, &ros::TransformStamped::child_frame_id) != robot_.static_transforms_.end())
    return;
  robot_.static_transforms_.push_back(ros::transform_of({}, parent, child, pose));
}

void RobotTopics::put_sensor_frame(const Place& place, const shm::Pose& on_model) {
  if (const MovingLink* link = carrier_of(place.name))
    return put_frame(link->frame, place.frame, ros::product(ros::inverse(link->rest), on_model));
  put_frame(base(), place.frame, ros::product(ros::inverse(base_on_model_), on_model));
}

const RobotTopics::MovingLink* RobotTopics::carrier_of(const std::string& iface) const {
  if (listed_ == nullptr) return nullptr;
  const auto sensor = listed_->sensor_links.find(iface);
  if (sensor == listed_->sensor_links.end()) return nullptr;
  const auto found =
      moving_links_.find(ros2::carrier_of(*listed_, sensor->second, [&](const auto& link) { return moving_links_.contains(link); }));
  return found == moving_links_.end() ? nullptr : &found->second;
}

template <class Message, class Info, class Make>
void RobotTopics::add_meter(Place& place, const std::string& topic, Make make) {
  put_sensor_frame(place, place.source->iface().info<Info>().pose);
  Writer* writer = advertise<Message>(place, topic);
  if (writer == nullptr) return;
  outlet(place, {writer}).show = [writer, make, frame = place.frame](Iface& iface, const HeldFrame*) {
    publish_made(*writer, make(iface, frame));
  };
}

template <class Message, class Make>
void RobotTopics::add_placeless(Place& place, const std::string& topic, const std::string& frame, Make make) {
  Writer* writer = advertise<Message>(place, topic);
  if (writer == nullptr) return;
  outlet(place, {writer}).show = [writer, make, frame](Iface& iface, const HeldFrame*) { publish_made(*writer, make(iface, frame)); };
}

// ---- range finders ----

void RobotTopics::add_laser(Place& place) {
  const auto& info = place.source->iface().info<shm::LaserInfo>();
  put_sensor_frame(place, info.pose);
  Writer* writer = advertise<ros::LaserScan>(place, place.front + "scan");
  if (writer == nullptr) return;
  auto message = ros::empty_scan(place.source->iface(), place.frame);
  // Readers count the ranges by the angles.
  message.angle_max = static_cast<float>(info.min_angle + (info.beams - 1) * info.angle_step);
  outlet(place, {writer}).show = [writer, message](Iface& iface, const HeldFrame*) mutable {
    const auto scan = iface.laser_scan();
    message.header.stamp = ros::time_of(scan.sample->stamp);
    message.ranges = scan.ranges;
    message.intensities = ros::is_zero(scan.intensities) ? std::span<const float>() : scan.intensities;
    publish(*writer, message);
  };
}

void RobotTopics::add_cloud_of_laser(Place& place) {
  put_sensor_frame(place, place.source->iface().info<shm::LaserInfo>().pose);
  Writer* writer = advertise<ros::PointCloud2>(place, place.front + "points", true);
  if (writer == nullptr) return;
  outlet(place, {writer}).show = [writer, frame = place.frame](Iface& iface, const HeldFrame*) {
    const auto scan = iface.laser_scan();
    const auto& info = iface.info<shm::LaserInfo>();
    const auto points = ros::ray_points(info, scan);
    auto message = ros::ring_message(info, scan, frame, points);
    message.is_dense = std::ranges::all_of(points, [](const ros::RayPoint& point) { return std::isfinite(point.x); });
    publish(*writer, message);
  };
}

void RobotTopics::add_sonar(Place& place) {
  const auto poses = place.source->iface().sonar_poses();
  std::vector<Writer*> writers;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string number = std::to_string(i);
    put_frame(base(), place.frame + "_" + number, ros::product(ros::inverse(base_on_model_), poses[i]));
    // A part of a name does not begin with a digit.
    writers.push_back(advertise<ros::Range>(place, place.leaf + "/range_" + number));
  }
  if (without_null(writers).empty()) return;
  outlet(place, writers).show = [writers, frame = place.frame](Iface& iface, const HeldFrame*) {
    const auto scan = iface.sonar_scan();
    const auto& info = iface.info<shm::SonarInfo>();
    for (std::size_t i = 0; i < scan.ranges.size() && i < writers.size(); ++i) {
      ros::Range message{.header = ros::header_of(scan.sample->stamp, frame + "_" + std::to_string(i))};
      message.field_of_view = static_cast<float>(info.cone);
      message.min_range = static_cast<float>(info.min_range);
      message.max_range = static_cast<float>(info.max_range);
      message.range = scan.ranges[i];
      message.variance = static_cast<float>(info.noise * info.noise);
      publish_if(writers[i], message);
    }
  };
}

// ---- cameras ----

void RobotTopics::add_camera(Place& place, const std::string& topic) {
  const auto& info = place.source->iface().info<shm::CameraInfo>();
  put_sensor_frame(place, info.pose);
  const std::string optical = put_optical_frame(place);
  const auto pixels = ros::jpeg_pixels(static_cast<shm::Format>(info.format));
  Writer* raw = advertise<ros::Image>(place, topic + "/image_raw", true);
  Writer* compressed = pixels ? advertise<ros::CompressedImage>(place, topic + "/image_raw/compressed", true) : nullptr;
  Writer* described = advertise<ros::CameraInfo>(place, topic + "/camera_info");
  const auto encoder = std::make_shared<base::JpegEncoder>();
  outlet(place, {raw, compressed, described}).show = [=](Iface& iface, const HeldFrame* frame) {
    const auto header = ros::header_of(frame->head().stamp, optical);
    publish_if(described, ros::camera_message(iface.info<shm::CameraInfo>(), header));
    publish_if(raw, ros::image_message(*frame, header));
    if (compressed == nullptr || compressed->readers().empty()) return;
    if (const auto bytes = ros::to_jpeg(*encoder, *frame, *pixels)) publish(*compressed, ros::CompressedImage{header, "jpeg", *bytes});
  };
}

void RobotTopics::add_points(Place& place) {
  put_sensor_frame(place, place.source->iface().info<shm::CameraInfo>().pose);
  Writer* writer = advertise<ros::PointCloud2>(place, place.leaf + "/points", true);
  if (writer == nullptr) return;
  outlet(place, {writer}).show = [writer, frame_id = place.frame](Iface&, const HeldFrame* frame) {
    const auto& head = frame->head();
    const bool has_intensity = static_cast<shm::Format>(head.format) == shm::Format::points_intensity_float;
    publish(*writer, ros::cloud_message(head.stamp, frame_id, head.width, head.height, has_intensity,
                                        {reinterpret_cast<const std::uint8_t*>(frame->data().data()), frame->data().size()}));
  };
}

// ---- drives and joints ----

void RobotTopics::add_position2d(Place& place) {
  base_on_model_ = place.source->iface().info<shm::Position2dInfo>().pose;
  const std::string odom = robot_.names_.frame("odom");
  Writer* writer = advertise<ros::Odometry>(place, place.front + "odom");
  Writer* truth = advertise<ros::Odometry>(place, place.front + "ground_truth/odom");
  Writer* tf = robot_.tf();
  ros::Odometry message;
  message.header.frame_id = odom;
  message.child_frame_id = base();
  message.pose.covariance = message.twist.covariance = ros::wheel_covariance();
  // What AMCL, Nav2's collision monitor and slam_toolbox look for. A description of the user's own has it above base_link.
  if (robot_.shared_.has_joint_tf) put_frame(base(), robot_.names_.frame("base_footprint"), shm::identity_pose);
  Outlet& made = outlet(place, {writer, truth, tf});
  made.is_first = true;
  made.show = [=](Iface& iface, const HeldFrame*) mutable {
    const auto& sample = iface.sample<shm::Position2dSample>();
    const auto pose = ros::pose_at(sample.odometry[0], sample.odometry[1], 0, sample.odometry[2]);
    publish_if(tf, ros::TFMessage{{ros::transform_of(sample.stamp, odom, message.child_frame_id, pose)}});
    message.header.stamp = ros::time_of(sample.stamp);
    message.pose.pose = ros::pose_of(pose);
    message.twist.twist = {{sample.velocity[0], sample.velocity[1], 0}, {0, 0, sample.velocity[2]}};
    publish_if(writer, message);
    ros::Odometry real{.header = {message.header.stamp, "world"}, .child_frame_id = message.child_frame_id};
    real.pose.pose = ros::pose_of(sample.true_pose);
    real.twist.twist = {{sample.true_velocity[0], sample.true_velocity[1], 0}, {0, 0, sample.true_velocity[2]}};
    publish_if(truth, real);
  };
  robot_.commands_.take_drive(place.source, robot_.names_.topic(place.front + "cmd_vel"));
}

void RobotTopics::add_position3d(Place& place) {
  base_on_model_ = place.source->iface().info<shm::Position3dInfo>().pose;
  const std::string odom = robot_.names_.frame("odom"), child = base();
  Writer* writer = advertise<ros::Odometry>(place, place.front + "odom");
  Writer* truth = advertise<ros::Odometry>(place, place.front + "ground_truth/odom");
  Writer* tf = robot_.tf();
  Outlet& made = outlet(place, {writer, truth, tf});
  made.is_first = true;
  made.show = [=](Iface& iface, const HeldFrame*) {
    const auto& sample = iface.sample<shm::Position3dSample>();
    publish_if(tf, ros::TFMessage{{ros::transform_of(sample.stamp, odom, child, sample.odometry)}});
    ros::Odometry message{.header = ros::header_of(sample.stamp, odom), .child_frame_id = child};
    message.pose.pose = ros::pose_of(sample.odometry);
    message.twist.twist = {ros::vector_of(sample.velocity), ros::vector_of(sample.velocity + 3)};
    publish_if(writer, message);
    message.header.frame_id = "world";
    message.pose.pose = ros::pose_of(sample.true_pose);
    message.twist.twist = {ros::vector_of(sample.true_velocity), ros::vector_of(sample.true_velocity + 3)};
    publish_if(truth, message);
  };
  robot_.commands_.take_drive(place.source, robot_.names_.topic(place.front + "cmd_vel"));
}

void RobotTopics::add_joints(Place& place) {
  Writer* writer = advertise<ros::JointState>(place, place.front + "joint_states");
  Writer* tf = robot_.shared_.has_joint_tf ? robot_.tf() : nullptr;
  Outlet& made = outlet(place, {writer, tf});
  made.is_first = true;
  // The frame of a link is that of the joint that moves it, as in URDF.
  const auto* joints = reinterpret_cast<const shm::Joint*>(place.source->iface().info_followers(0));
  std::vector<std::string> frames;
  for (std::size_t i = 0; i < place.source->iface().count(); ++i) {
    const std::string link = ros::text_of(joints[i].link);
    frames.push_back(robot_.names_.frame(token(link)));
    moving_links_[link] = {frames.back(), joint_frame({joints, place.source->iface().count()}, i)};
  }
  made.show = [writer, tf, frames, root = base(), to_base = ros::inverse(base_on_model_)](Iface& iface, const HeldFrame*) {
    publish_if(writer, ros::joints_message(iface));
    if (tf == nullptr || tf->readers().empty()) return;
    const auto* joint = reinterpret_cast<const shm::Joint*>(iface.info_followers(0));
    const auto* state = reinterpret_cast<const shm::JointState*>(iface.sample_followers(0));
    ros::TFMessage message;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const auto moved = ros::product(joint[i].pose, motion_of(joint[i], state[i].position));
      const bool is_root = joint[i].parent == 0 || joint[i].parent > frames.size();
      message.transforms.push_back(ros::transform_of(iface.sample<shm::Stamp>(), is_root ? root : frames[joint[i].parent - 1], frames[i],
                                                     is_root ? ros::product(to_base, moved) : moved));
    }
    publish(*tf, message);
  };
  robot_.commands_.take_joints(place.source, robot_.names_);
}

// ---- the rest ----

void RobotTopics::add_bumper(Place& place) {
  Writer* writer = advertise<ros::Contacts>(place, place.leaf + "/contacts");
  if (writer == nullptr) return;
  outlet(place, {writer}).show = [writer](Iface& iface, const HeldFrame*) { publish(*writer, ros::contacts_message(iface, "world")); };
}

void RobotTopics::add_altimeter(Place& place) {
  add_meter<ros::Altimeter, shm::MeterInfo>(place, place.front + "altimeter", [](const Iface& iface, const std::string& frame) {
    const auto& sample = iface.sample<shm::AltimeterSample>();
    return ros::Altimeter{ros::header_of(sample.stamp, frame), sample.height, sample.climb, iface.info<shm::MeterInfo>().reference};
  });
}

std::string RobotTopics::put_optical_frame(const Place& place) {
  const std::string optical = place.frame + "_optical_frame";
  put_frame(place.frame, optical, {0, 0, 0, 0.5, -0.5, 0.5, -0.5});
  return optical;
}

void RobotTopics::add_ins(Place& place) {
  put_sensor_frame(place, place.source->iface().info<shm::InsInfo>().pose);
  Writer* fix = advertise<ros::NavSatFix>(place, place.leaf + "/fix");
  Writer* orientation = advertise<ros::Imu>(place, place.leaf + "/orientation");
  Writer* velocity = advertise<ros::TwistStamped>(place, place.leaf + "/velocity");
  outlet(place, {fix, orientation, velocity}).show = [=, frame = place.frame](Iface& iface, const HeldFrame*) {
    publish_if(fix, ros::ins_fix(iface, frame));
    publish_if(orientation, ros::ins_orientation(iface, frame));
    publish_if(velocity, ros::ins_velocity(iface, frame));
  };
}

void RobotTopics::add_boxes(Place& place) {
  const auto& info = place.source->iface().info<shm::BoxesInfo>();
  put_sensor_frame(place, info.pose);
  const std::string topic = place.leaf + "/detections";
  if (info.kind == RTMSIM_BOX_ORIENTED) return add_placeless<ros::Detection3DArray>(place, topic, place.frame, ros::oriented_boxes_message);
  add_placeless<ros::Detection2DArray>(place, topic, put_optical_frame(place), ros::image_boxes_message);
}

void RobotTopics::add_device(Place& place) {
  using enum shm::IfaceType;
  switch (place.source->iface().type()) {
    case battery:
      return add_placeless<ros::BatteryState>(place, place.front + "battery_state", base(), ros::battery_message);
    case wheels:
      return add_placeless<ros::JointState>(place, place.leaf + "/wheel_states", base(), ros::wheels_message);
    case localization:
      return add_placeless<ros::PoseWithCovarianceStamped>(place, place.leaf + "/pose", "world", ros::localization_message);
    case dvl:
      return add_meter<ros::TwistWithCovarianceStamped, shm::DvlInfo>(place, place.leaf + "/velocity", ros::dvl_message);
    case air_speed:
      return add_meter<ros::FluidPressure, shm::MeterInfo>(place, place.front + "air_speed", ros::air_speed_message);
    case ins:
      return add_ins(place);
    case rfid:
      return add_meter<ros::Text, shm::RfidInfo>(place, place.leaf + "/tags", ros::rfid_message);
    case wireless:
      return add_meter<ros::Text, shm::WirelessInfo>(place, place.leaf + "/transmitters", ros::wireless_message);
    case logical_camera:
      return add_meter<ros::MarkerArray, shm::LogicalCameraInfo>(place, place.leaf + "/models", ros::seen_models_message);
    case fiducial:
      return add_meter<ros::MarkerArray, shm::FiducialInfo>(place, place.leaf + "/markers", ros::marks_message);
    case boxes:
      return add_boxes(place);
    default:
      break;
  }
}

void RobotTopics::add_description() {
  const shm::Iface* joints = nullptr;
  for (const Outlet& one : robot_.outlets_) {
    if (one.source->iface().type() == shm::IfaceType::joints) joints = &one.source->iface();
  }
  Writer* writer = robot_.node_.advertise<ros::Text>(robot_.names_.topic("robot_description"), {true, 1}, true);
  if (writer != nullptr) publish(*writer, ros::Text{urdf_of(*listed_, joints, base_on_model_)});
}

}  // namespace ros2
