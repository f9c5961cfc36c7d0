// Mappings of scans, images, clouds, joints and positions to messages of sensor_msgs. What a message has and the port does not is lost.
#pragma once

#include <rtm/ext/ManipulatorCommonInterface_DataTypesSkel.h>
#include <rtm/ext/PointCloudTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <optional>
#include <string>
#include <vector>

#include "ros2/port_mapping.h"

namespace ros2 {

// On a port no echo is the maximum and too near is the minimum; in a LaserScan these are +inf and -inf. NaN becomes the maximum.
class RangesAndScan : public Frames {
 public:
  using Data = RTC::RangeData;
  using Message = ros::LaserScan;
  Message to_ros(const Data& data);
  static void from_ros(const Message& scan, Data& data);

 private:
  std::vector<float> ranges_;
};

// Says in the log why an image is not passed on, once for each user of a connection.
class ImageComplaint {
 protected:
  bool refuse(const std::string& why);  // false

 private:
  bool has_complained_ = false;
};

// Formats RGB8, BGR8, RGBA8, BGRA8, MONO8, MONO16, BAYER_RGGB8 and its like, and DEPTH32F, which is 32FC1. Others by their bits per pixel.
class ImageAndImage : public Frames, private ImageComplaint {
 public:
  using Data = RTC::CameraImage;
  using Message = ros::Image;
  std::optional<Message> to_ros(const Data& data);
  bool from_ros(const Message& image, Data& data);
};

// Formats JPEG and PNG. A received image has no size.
class ImageAndCompressedImage : public Frames, private ImageComplaint {
 public:
  using Data = RTC::CameraImage;
  using Message = ros::CompressedImage;
  std::optional<Message> to_ros(const Data& data);
  bool from_ros(const Message& image, Data& data);
};

// Colours from 0 to 1 are the field rgb. A cloud with the field intensity and without rgb is grey.
class PointsAndCloud : public Frames {
 public:
  using Data = RTC::PointCloud;
  using Message = ros::PointCloud2;
  Message to_ros(const Data& data);
  static bool from_ros(const Message& cloud, Data& data);

 private:
  std::vector<std::uint8_t> bytes_;
};

// Any fields. `seq` is lost.
class CloudAndCloud : public Frames {
 public:
  using Data = PointCloudTypes::PointCloud;
  using Message = ros::PointCloud2;
  std::optional<Message> to_ros(const Data& data) const;
  static bool from_ros(const Message& cloud, Data& data);
};

// The names of joints, from ros2.joint_names=NAME,NAME,...; without it joint_0, joint_1, ... are sent, and joints are received in the order
// of the message.
class JointNames {
 public:
  void init(const coil::Properties& connection);
  std::vector<std::string> first(std::size_t count) const;
  // The place of each joint in the message; nothing if one is missing.
  std::optional<std::vector<std::size_t>> places(const ros::JointState& message) const;

 private:
  std::vector<std::string> names_;
};

// `current` is the effort.
struct ActuatorsAndJoints : JointNames {
  using Data = RTC::ActArrayState;
  using Message = ros::JointState;
  Message to_ros(const Data& data) const;
  bool from_ros(const Message& message, Data& data) const;
};

// Positions alone.
struct NumbersAndJoints : JointNames {
  using Data = RTC::TimedDoubleSeq;
  using Message = ros::JointState;
  Message to_ros(const Data& data) const;
  bool from_ros(const Message& message, Data& data) const;
};
struct JointPosAndJoints : JointNames {
  using Data = JARA_ARM::TimedJointPos;
  using Message = ros::JointState;
  Message to_ros(const Data& data) const;
  bool from_ros(const Message& message, Data& data) const;
};

// Errors [m] are the roots of the covariances. Speeds, heading and the number of satellites are lost.
struct GpsAndFix : Frames {
  using Data = RTC::GPSData;
  using Message = ros::NavSatFix;
  Message to_ros(const Data& data) const;
  static void from_ros(const Message& fix, Data& data);
};

}  // namespace ros2
