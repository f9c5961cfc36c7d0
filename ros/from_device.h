// Samples of batteries, radio, wheels, estimates and of what cameras recognise as messages of ROS 2. `frame` is the frame_id of the
// message. Units and frames are those of ROS (REP 103). One thread at a time for each Iface.
#pragma once

#include <optional>
#include <string>

#include "ros/contact_messages.h"
#include "ros/from_iface.h"
#include "ros/messages.h"
#include "shm/client.h"

namespace ros {

// The current of ROS is positive while the battery charges.
BatteryState battery_message(const shm::Iface& iface, const std::string& frame);
// Only while it is known.
std::optional<TwistWithCovarianceStamped> dvl_message(const shm::Iface& iface, const std::string& frame);
FluidPressure air_speed_message(const shm::Iface& iface, const std::string& frame);

NavSatFix ins_fix(const shm::Iface& iface, const std::string& frame);
Imu ins_orientation(const shm::Iface& iface, const std::string& frame);  // angular velocity and acceleration are not measured
TwistStamped ins_velocity(const shm::Iface& iface, const std::string& frame);

// A line for each tag.
Text rfid_message(const shm::Iface& iface, const std::string& frame);
// A line for each transmitter: its level [dBm], its frequency [MHz], its name.
Text wireless_message(const shm::Iface& iface, const std::string& frame);

JointState wheels_message(const shm::Iface& iface, const std::string& frame);
// The best hypothesis; nothing without one.
std::optional<PoseWithCovarianceStamped> localization_message(const shm::Iface& iface, const std::string& frame);

Contacts contacts_message(const shm::Iface& iface, const std::string& frame);

// A cube with a text for each thing, in the frame of the sensor; the namespace is the name of the iface.
MarkerArray seen_models_message(const shm::Iface& iface, const std::string& frame);
MarkerArray marks_message(const shm::Iface& iface, const std::string& frame);
// Boxes in the image, and boxes in the world.
Detection2DArray image_boxes_message(const shm::Iface& iface, const std::string& frame);
Detection3DArray oriented_boxes_message(const shm::Iface& iface, const std::string& frame);

}  // namespace ros
