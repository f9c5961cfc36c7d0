#include "channels/views/iface_view.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "base/jpeg.h"
#include "channels/views/seen_view.h"
#include "channels/views/view_parts.h"
#include "ros/plain_messages.h"

namespace channels {

namespace {

// ---- range finders ----

IfaceView flat_laser_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::LaserScan>(iface)};
  place<shm::LaserInfo>(view, iface);
  view.tell = [message = ros::empty_scan(iface, iface.name())](shm::Iface& from, const shm::HeldFrame*, Said& said) mutable {
    const auto scan = from.laser_scan();
    if (scan.sample->stamp.valid == 0) return;
    message.header.stamp = ros::time_of(scan.sample->stamp);
    message.ranges = scan.ranges;
    // A world without reflecting surfaces has none, which the message says by leaving them out.
    message.intensities = ros::is_zero(scan.intensities) ? std::span<const float>() : scan.intensities;
    said.add(0, message);
  };
  return view;
}

IfaceView laser_view(const shm::Iface& iface) {
  if (iface.info<shm::LaserInfo>().layers == 1) return flat_laser_view(iface);
  IfaceView view;
  view.channels = {channel<ros::PointCloud2>(iface)};
  place<shm::LaserInfo>(view, iface);
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    const auto scan = from.laser_scan();
    if (scan.sample->stamp.valid == 0) return;
    const auto& info = from.info<shm::LaserInfo>();
    const auto points = ros::ray_points(info, scan);
    said.add(0, ros::ring_message(info, scan, from.name(), points));
  };
  return view;
}

// A channel and a frame for each transducer.
IfaceView sonar_view(const shm::Iface& iface) {
  IfaceView view;
  place<shm::SonarInfo>(view, iface);
  view.frames.clear();
  const auto& info = iface.info<shm::SonarInfo>();
  const auto poses = iface.sonar_poses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    view.channels.push_back(channel<ros::Range>(iface, "/" + std::to_string(i)));
    view.frames.push_back(transform_of({}, text_of(info.model), iface.name() + "/" + std::to_string(i), poses[i]));
  }
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    const auto scan = from.sonar_scan();
    if (scan.sample->stamp.valid == 0) return;
    const auto& ring = from.info<shm::SonarInfo>();
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      if (!said.is_wanted(i)) continue;
      const ros::Range range{.header = header_of(scan.sample->stamp, from.name() + "/" + std::to_string(i)),
                             .field_of_view = static_cast<float>(ring.cone),
                             .min_range = static_cast<float>(ring.min_range),
                             .max_range = static_cast<float>(ring.max_range),
                             .range = scan.ranges[i]};
      said.add(i, range);
    }
  };
  return view;
}

// ---- drives ----

// The odometry, and where its origin is in the world: so that what drifts is seen beside what is true.
template <class Info, class Sample, class Pose, class Velocity>
IfaceView drive_view(const shm::Iface& iface, Pose pose_by_wheels, Velocity velocity) {
  IfaceView view;
  view.channels = {channel<ros::Odometry>(iface), channel<ros::TFMessage>(iface, "/origin")};
  const std::string origin = iface.name() + "/origin";
  ros::Odometry odometry{.header = {{}, origin}, .child_frame_id = text_of(iface.info<Info>().model)};
  ros::TFMessage place{{transform_of({}, world_frame, origin, {})}};
  view.tell = [pose_by_wheels, velocity, odometry, place](shm::Iface& from, const shm::HeldFrame*, Said& said) mutable {
    const auto& sample = from.sample<Sample>();
    if (sample.stamp.valid == 0) return;
    const shm::Pose pose = pose_by_wheels(sample);
    if (said.is_wanted(0)) {
      odometry.header.stamp = ros::time_of(sample.stamp);
      odometry.pose.pose = pose_of(pose);
      odometry.twist.twist = velocity(sample);
      said.add(0, odometry);
    }
    if (said.is_wanted(1)) {
      auto& transform = place.transforms[0];
      transform.header.stamp = ros::time_of(sample.stamp);
      transform.transform = transform_of({}, "", "", product(sample.true_pose, inverse(pose))).transform;
      said.add(1, place);
    }
  };
  return view;
}

IfaceView position2d_view(const shm::Iface& iface) {
  return drive_view<shm::Position2dInfo, shm::Position2dSample>(
      iface, [](const shm::Position2dSample& s) { return ros::pose_at(s.odometry[0], s.odometry[1], 0, s.odometry[2]); },
      [](const shm::Position2dSample& s) {
        return ros::Twist{{s.velocity[0], s.velocity[1], 0}, {0, 0, s.velocity[2]}};
      });
}

IfaceView position3d_view(const shm::Iface& iface) {
  return drive_view<shm::Position3dInfo, shm::Position3dSample>(
      iface, [](const shm::Position3dSample& s) { return s.odometry; },
      [](const shm::Position3dSample& s) {
        return ros::Twist{ros::vector_of(s.velocity), ros::vector_of(s.velocity + 3)};
      });
}

// ---- cameras ----

// Pictures have z forward, x right and y down.
ros::TransformStamped optical_frame(const std::string& sensor) {
  return transform_of({}, sensor, sensor + "/optical", {0, 0, 0, 0.5, -0.5, 0.5, -0.5});
}

IfaceView camera_view(const shm::Iface& iface, Pictures pictures) {
  IfaceView view;
  const auto format = static_cast<shm::Format>(iface.info<shm::CameraInfo>().format);
  const auto kind = ros::jpeg_pixels(format);
  const bool is_jpeg = pictures == Pictures::jpeg && kind;
  view.channels = {is_jpeg ? channel<ros::CompressedImage>(iface, "/image") : channel<ros::Image>(iface, "/image"),
                   channel<ros::CameraInfo>(iface, "/camera_info")};
  place<shm::CameraInfo>(view, iface);
  view.frames.push_back(optical_frame(iface.name()));
  const auto jpeg = is_jpeg ? std::make_shared<base::JpegEncoder>() : nullptr;
  view.tell = [jpeg, kind](shm::Iface& from, const shm::HeldFrame* frame, Said& said) {
    if (frame == nullptr || frame->head().stamp.valid == 0) return;
    const auto header = header_of(frame->head().stamp, from.name() + "/optical");
    if (said.is_wanted(0) && jpeg) {
      const auto octets = ros::to_jpeg(*jpeg, *frame, *kind);
      if (octets) said.add(0, ros::CompressedImage{header, "jpeg", *octets});
    } else if (said.is_wanted(0)) {
      said.add(0, ros::image_message(*frame, header));
    }
    said.add(1, ros::camera_message(from.info<shm::CameraInfo>(), header));
  };
  return view;
}

IfaceView points_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::PointCloud2>(iface)};
  place<shm::CameraInfo>(view, iface);
  view.tell = [](shm::Iface& from, const shm::HeldFrame* frame, Said& said) {
    if (frame == nullptr || frame->head().stamp.valid == 0) return;
    const auto& head = frame->head();
    const bool with_intensity = static_cast<shm::Format>(head.format) == shm::Format::points_intensity_float;
    said.add(0, ros::cloud_message(head.stamp, from.name(), head.width, head.height, with_intensity,
                                   {reinterpret_cast<const std::uint8_t*>(frame->data().data()), frame->data().size()}));
  };
  return view;
}

// ---- meters ----

IfaceView joints_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::JointState>(iface)};
  view.rate = iface.info<shm::JointsInfo>().rate;
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    if (from.sample<shm::JointsSample>().stamp.valid != 0) said.add(0, ros::joints_message(from));
  };
  return view;
}

IfaceView altimeter_view(const shm::Iface& iface) {
  IfaceView view;
  view.channels = {channel<ros::Float64>(iface, "/height"), channel<ros::Float64>(iface, "/climb")};
  place<shm::MeterInfo>(view, iface);
  view.tell = [](shm::Iface& from, const shm::HeldFrame*, Said& said) {
    const auto& sample = from.sample<shm::AltimeterSample>();
    if (sample.stamp.valid == 0) return;
    said.add(0, ros::Float64{sample.height});
    said.add(1, ros::Float64{sample.climb});
  };
  return view;
}

// An arrow for each contact, as long as the force of 100 N is a metre.
ros::MarkerArray contacts_message(const shm::Iface& iface, const std::string&) {
  constexpr double length = 0.01;  // [m/N]
  const auto view = iface.bumper();
  ros::MarkerArray array;
  array.markers.push_back({.header = header_of(view.sample->stamp, world_frame), .ns = iface.name(), .action = ros::Marker::remove_all});
  for (const shm::Contact& contact : view.contacts) {
    ros::Marker arrow{.header = array.markers.front().header, .ns = iface.name()};
    arrow.id = static_cast<std::int32_t>(array.markers.size());
    arrow.type = ros::Marker::arrow;
    arrow.scale = {0.01, 0.02, 0};
    arrow.color = {1, 0.2F, 0.1F, 1};
    const double* p = contact.position;
    const double* f = contact.force;
    arrow.points = {{p[0], p[1], p[2]}, {p[0] + length * f[0], p[1] + length * f[1], p[2] + length * f[2]}};
    arrow.text = text_of(contact.other);
    array.markers.push_back(std::move(arrow));
  }
  return array;
}

std::optional<IfaceView> make_view(const shm::Iface& iface, Pictures pictures) {
  using enum shm::IfaceType;
  using shm::MeterInfo;
  switch (iface.type()) {
    case laser:
      return laser_view(iface);
    case sonar:
      return sonar_view(iface);
    case position2d:
      return position2d_view(iface);
    case position3d:
      return position3d_view(iface);
    case camera:
    case depth:
      return camera_view(iface, pictures);
    case points:
      return points_view(iface);
    case imu:
      return simple_view<ros::Imu, shm::ImuInfo>(iface, ros::imu_message);
    case gps:
      return simple_view<ros::NavSatFix, shm::GpsInfo>(iface, ros::fix_message);
    case bumper:
      return simple_view<ros::MarkerArray, shm::BumperInfo>(iface, contacts_message);
    case force_torque:
      return simple_view<ros::WrenchStamped, MeterInfo>(iface, ros::wrench_message);
    case altimeter:
      return altimeter_view(iface);
    case magnetometer:
      return simple_view<ros::MagneticField, MeterInfo>(iface, ros::field_message);
    case air_pressure:
      return simple_view<ros::FluidPressure, MeterInfo>(iface, ros::pressure_message);
    case joints:
      return joints_view(iface);
    case battery:
    case dvl:
    case air_speed:
    case ins:
    case rfid:
    case wireless:
    case wheels:
    case localization:
      return plain_view(iface);
    case logical_camera:
      return logical_camera_view(iface);
    case boxes:
      return boxes_view(iface);
    case fiducial:
      return fiducial_view(iface);
    case simulation:
    case truth:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::string topic_of(shm::IfaceType type, const std::string& name) {
  std::string topic = "/sim/" + std::string(shm::to_text(type)) + "/";
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool is_border = name.compare(i, 2, "::") == 0;
    topic += is_border ? '/' : name[i];
    if (is_border) ++i;
  }
  return topic;
}

std::unique_ptr<IfaceView> view_of(const shm::Iface& iface, Pictures pictures) {
  auto view = make_view(iface, pictures);
  return view ? std::make_unique<IfaceView>(std::move(*view)) : nullptr;
}

}  // namespace channels
