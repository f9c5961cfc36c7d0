// Makes the topics of a robot: one function for each type of iface. One thread at a time.
#pragma once

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
  void add_altimeter(Place& place);
  void add_description(const Listed& listed);
  template <class Message, class Info, class Make>
  void add_meter(Place& place, const std::string& topic, Make make);

  // Nothing when the mapping file leaves it out.
  template <ros::Message T>
  Writer* advertise(const Place& place, const std::string& topic, bool is_large = false);
  Outlet& outlet(const Place& place, std::vector<Writer*> writers);
  void put_frame(const std::string& parent, const std::string& child, const shm::Pose& pose);
  void put_sensor_frame(const Place& place, const shm::Pose& on_model);
  std::string base() const { return robot_.names_.frame("base_link"); }

  Robot& robot_;
  shm::Pose base_on_model_ = shm::identity_pose;
};

}  // namespace ros2
