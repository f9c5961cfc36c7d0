// Makes the topics of a robot: one function for each type of iface. One thread at a time.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "robot.h"

namespace ros2 {

inline const NodeName gateway_node{"/", "ros2_gateway"};

// What an iface of a type becomes, for people (`ros2-gateway --interfaces`).
struct ServedRow {
  shm::IfaceType type;
  const char* topics;
  const char* types;
};
std::vector<ServedRow> served_rows();

class RobotTopics {
 public:
  explicit RobotTopics(Robot& robot) : robot_(robot) {}
  void make(const Listed& listed);

 private:
  using Iface = shm::Iface;

  struct Place {
    std::shared_ptr<Source> source;
    std::string name;   // of the iface
    std::string front;  // of its topics: "front_laser/", or empty for the only iface of its type
    std::string leaf;   // "front_laser"
    std::string frame;
  };

  struct MovingLink {
    std::string frame;
    shm::Pose rest;  // on the model, with all joints at 0
  };

  void add(const ListedIface& listed, bool is_only);
  void add_laser(Place& place);
  void add_cloud_of_laser(Place& place);
  void add_sonar(Place& place);
  void add_camera(Place& place, const std::string& image);
  void add_points(Place& place);
  void add_position2d(Place& place);
  void add_position3d(Place& place);
  void add_joints(Place& place);
  void add_bumper(Place& place);
  // Batteries, radio, wheels, estimates, what cameras recognise.
  void add_device(Place& place);
  void add_ins(Place& place);
  void add_boxes(Place& place);
  std::string put_optical_frame(const Place& place);
  // Of a device without a frame of its own. `make` makes a message of a sample, or nothing.
  template <class Message, class Make>
  void add_placeless(Place& place, const std::string& topic, const std::string& frame, Make make);
  void add_altimeter(Place& place);
  void add_description();
  template <class Message, class Info, class Make>
  void add_meter(Place& place, const std::string& topic, Make make);

  // Nothing when the mapping file leaves it out.
  template <ros::Message T>
  Writer* advertise(const Place& place, const std::string& topic, bool is_large = false);
  Outlet& outlet(const Place& place, std::vector<Writer*> writers);
  void put_frame(const std::string& parent, const std::string& child, const shm::Pose& pose);
  void put_sensor_frame(const Place& place, const shm::Pose& on_model);
  // The moving link that carries the sensor, also by fixed joints; nothing when it does not move on the base.
  const MovingLink* carrier_of(const std::string& iface) const;
  std::string base() const { return robot_.names_.frame("base_link"); }

  Robot& robot_;
  shm::Pose base_on_model_ = shm::identity_pose;
  const ListedModel* listed_ = nullptr;             // while topics are made
  std::map<std::string, MovingLink> moving_links_;  // by name
};

}  // namespace ros2
