// Mappings of points, poses and velocities to messages of geometry_msgs, nav_msgs and sensor_msgs. Twist has no time: a received sample has
// time 0. What a message has and the port does not is lost, and 0 or unknown in the other direction.
#pragma once

#include <rtm/idl/ExtendedDataTypesSkel.h>

#include "ros/plain_messages.h"
#include "ros/rotation.h"
#include "ros2/port_mapping.h"

namespace ros2 {

// ---- values ----

inline ros::Twist to_ros(const RTC::Velocity2D& v) { return {{v.vx, v.vy, 0}, {0, 0, v.va}}; }
inline ros::Twist to_ros(const RTC::Velocity3D& v) { return {{v.vx, v.vy, v.vz}, {v.vr, v.vp, v.va}}; }
inline void from_ros(const ros::Twist& twist, RTC::Velocity2D& v) { v = {twist.linear.x, twist.linear.y, twist.angular.z}; }
inline void from_ros(const ros::Twist& twist, RTC::Velocity3D& v) {
  v = {twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y, twist.angular.z};
}

inline ros::Quaternion to_ros(const RTC::Orientation3D& o) { return ros::quaternion_of({o.r, o.p, o.y}); }
inline void from_ros(const ros::Quaternion& quaternion, RTC::Orientation3D& o) {
  const auto angles = ros::angles_of(quaternion);
  o = {angles.roll, angles.pitch, angles.yaw};
}
inline ros::Quaternion to_ros(const RTC::Quaternion& q) { return {q.x, q.y, q.z, q.w}; }
inline void from_ros(const ros::Quaternion& from, RTC::Quaternion& q) { q = {from.x, from.y, from.z, from.w}; }

inline ros::Pose to_ros(const RTC::Pose2D& pose) {
  return {{pose.position.x, pose.position.y, 0}, ros::quaternion_of({0, 0, pose.heading})};
}
inline ros::Pose to_ros(const RTC::Pose3D& pose) { return {{pose.position.x, pose.position.y, pose.position.z}, to_ros(pose.orientation)}; }
inline void from_ros(const ros::Pose& from, RTC::Pose2D& pose) {
  pose = {{from.position.x, from.position.y}, ros::angles_of(from.orientation).yaw};
}
inline void from_ros(const ros::Pose& from, RTC::Pose3D& pose) {
  pose.position = {from.position.x, from.position.y, from.position.z};
  from_ros(from.orientation, pose.orientation);
}

inline ros::Vector3 vector_of(const RTC::Vector2D& v) { return {v.x, v.y, 0}; }
inline ros::Vector3 vector_of(const RTC::Vector3D& v) { return {v.x, v.y, v.z}; }
inline ros::Vector3 vector_of(const RTC::AngularVelocity3D& v) { return {v.avx, v.avy, v.avz}; }
inline ros::Vector3 vector_of(const RTC::Acceleration3D& v) { return {v.ax, v.ay, v.az}; }
inline void set_vector(RTC::Vector2D& v, const ros::Vector3& from) { v = {from.x, from.y}; }
inline void set_vector(RTC::Vector3D& v, const ros::Vector3& from) { v = {from.x, from.y, from.z}; }
inline void set_vector(RTC::AngularVelocity3D& v, const ros::Vector3& from) { v = {from.x, from.y, from.z}; }
inline void set_vector(RTC::Acceleration3D& v, const ros::Vector3& from) { v = {from.x, from.y, from.z}; }

inline ros::Point point_of(const RTC::Point2D& p) { return {p.x, p.y, 0}; }
inline ros::Point point_of(const RTC::Point3D& p) { return {p.x, p.y, p.z}; }
inline void set_point(RTC::Point2D& p, const ros::Point& from) { p = {from.x, from.y}; }
inline void set_point(RTC::Point3D& p, const ros::Point& from) { p = {from.x, from.y, from.z}; }

// ---- velocities: TimedVelocity2D, TimedVelocity3D ----

template <class Timed>
struct VelocityAndTwist {
  using Data = Timed;
  using Message = ros::Twist;
  static Message to_ros(const Data& data) { return ros2::to_ros(data.data); }
  static void from_ros(const Message& twist, Data& data) {
    data.tm = {};
    ros2::from_ros(twist, data.data);
  }
};

template <class Timed>
struct VelocityAndStampedTwist : Frames {
  using Data = Timed;
  using Message = ros::TwistStamped;
  Message to_ros(const Data& data) const { return {header(data.tm), ros2::to_ros(data.data)}; }
  static void from_ros(const Message& message, Data& data) {
    set_time(data.tm, message.header.stamp);
    ros2::from_ros(message.twist, data.data);
  }
};

// ---- poses: TimedPose2D, TimedPose3D, and with velocities TimedPoseVel2D, TimedPoseVel3D ----

template <class Timed>
struct PoseAndPose : Frames {
  using Data = Timed;
  using Message = ros::PoseStamped;
  PoseAndPose() : Frames("odom") {}
  Message to_ros(const Data& data) const { return {header(data.tm), ros2::to_ros(data.data)}; }
  static void from_ros(const Message& message, Data& data) {
    set_time(data.tm, message.header.stamp);
    ros2::from_ros(message.pose, data.data);
  }
};

template <class Timed>
struct PoseAndOdometry : Frames {
  using Data = Timed;
  using Message = ros::Odometry;
  static constexpr bool has_velocity = requires(Data data) { data.data.velocities; };
  static constexpr bool is_flat = std::is_same_v<Timed, RTC::TimedPose2D> || std::is_same_v<Timed, RTC::TimedPoseVel2D>;
  PoseAndOdometry() : Frames("odom", "base_link") {}
  Message to_ros(const Data& data) const {
    Message message{.header = header(data.tm), .child_frame_id = child()};
    if constexpr (has_velocity) {
      message.pose.pose = ros2::to_ros(data.data.pose);
      message.twist.twist = ros2::to_ros(data.data.velocities);
    } else {
      message.pose.pose = ros2::to_ros(data.data);
      message.twist.covariance = ros::unknown_covariance();
    }
    if constexpr (is_flat) message.pose.covariance = ros::wheel_covariance();
    if constexpr (is_flat && has_velocity) message.twist.covariance = ros::wheel_covariance();
    return message;
  }
  static void from_ros(const Message& message, Data& data) {
    set_time(data.tm, message.header.stamp);
    if constexpr (has_velocity) {
      ros2::from_ros(message.pose.pose, data.data.pose);
      ros2::from_ros(message.twist.twist, data.data.velocities);
    } else {
      ros2::from_ros(message.pose.pose, data.data);
    }
  }
};

// ---- points, vectors, orientations ----

template <class Timed>
struct PointAndPoint : Frames {
  using Data = Timed;
  using Message = ros::PointStamped;
  Message to_ros(const Data& data) const { return {header(data.tm), point_of(data.data)}; }
  static void from_ros(const Message& message, Data& data) {
    set_time(data.tm, message.header.stamp);
    set_point(data.data, message.point);
  }
};

template <class Timed>
struct VectorAndVector : Frames {
  using Data = Timed;
  using Message = ros::Vector3Stamped;
  Message to_ros(const Data& data) const { return {header(data.tm), vector_of(data.data)}; }
  static void from_ros(const Message& message, Data& data) {
    set_time(data.tm, message.header.stamp);
    set_vector(data.data, message.vector);
  }
};

template <class Timed>
struct OrientationAndQuaternion : Frames {
  using Data = Timed;
  using Message = ros::QuaternionStamped;
  Message to_ros(const Data& data) const { return {header(data.tm), ros2::to_ros(data.data)}; }
  static void from_ros(const Message& message, Data& data) {
    set_time(data.tm, message.header.stamp);
    ros2::from_ros(message.quaternion, data.data);
  }
};

// ---- parts of an Imu: a covariance that begins with -1 says that a part is not measured ----

inline ros::Imu part_of_imu(const ros::Header& header) {
  ros::Imu imu{.header = header};
  imu.orientation_covariance[0] = imu.angular_velocity_covariance[0] = imu.linear_acceleration_covariance[0] = -1;
  return imu;
}

struct OrientationAndImu : Frames {
  using Data = RTC::TimedOrientation3D;
  using Message = ros::Imu;
  Message to_ros(const Data& data) const {
    Message imu = part_of_imu(header(data.tm));
    imu.orientation = ros2::to_ros(data.data);
    imu.orientation_covariance[0] = 0;
    return imu;
  }
  static bool from_ros(const Message& imu, Data& data) {
    set_time(data.tm, imu.header.stamp);
    ros2::from_ros(imu.orientation, data.data);
    return imu.orientation_covariance[0] != -1;
  }
};

// A vector of an Imu, and its covariance, which is -1 where the message does not have it.
template <class Timed, auto part, auto covariance>
struct VectorAndImu : Frames {
  using Data = Timed;
  using Message = ros::Imu;
  Message to_ros(const Data& data) const {
    Message imu = part_of_imu(header(data.tm));
    imu.*part = vector_of(data.data);
    (imu.*covariance)[0] = 0;
    return imu;
  }
  static bool from_ros(const Message& imu, Data& data) {
    set_time(data.tm, imu.header.stamp);
    set_vector(data.data, imu.*part);
    return (imu.*covariance)[0] != -1;
  }
};
using AngularVelocityAndImu =
    VectorAndImu<RTC::TimedAngularVelocity3D, &ros::Imu::angular_velocity, &ros::Imu::angular_velocity_covariance>;
using AccelerationAndImu =
    VectorAndImu<RTC::TimedAcceleration3D, &ros::Imu::linear_acceleration, &ros::Imu::linear_acceleration_covariance>;

}  // namespace ros2
