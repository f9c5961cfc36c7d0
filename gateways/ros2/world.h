// The simulator that the gateway serves, with its ifaces and models. One thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/async_requests.h"
#include "common/simulator_link.h"
#include "shm/iface_types.h"

namespace ros2 {

using gateway::AsyncRequests;
using gateway::SharedSegment;
using gateway::Source;

struct ListedIface {
  shm::IfaceType type = shm::IfaceType::laser;
  std::string name, model;
};
// A shape that collides, on its model. Sizes [m] as the simulator lists them: box x y z, cylinder radius length, sphere radius.
struct ListedShape {
  std::string kind;
  shm::Pose pose = shm::identity_pose;
  std::vector<double> size;
};
struct ListedLink {
  std::string name;
  std::vector<ListedShape> shapes;
};
struct ListedModel {
  std::string name;
  shm::Pose pose = shm::identity_pose;  // in the world
  bool is_static = false;
  std::vector<ListedLink> links;
  std::map<std::string, std::string> sensor_links;  // by iface: the link that carries the sensor
  std::map<std::string, std::string> fixed_to;      // by child of a fixed joint: its parent
  std::map<std::string, double> joint_positions{};  // by joint, when it was listed, as the poses of shapes [rad, m]
};
struct Listed {
  std::vector<ListedIface> ifaces;
  std::vector<ListedModel> models;
};

class World final : public gateway::SimulatorLink {
 public:
  World(std::uint32_t server_id, AsyncRequests& async_requests, std::function<void(const Listed&)> on_list, std::function<void()> on_loss);

 private:
  void list() override;
  void take(const std::string& list, const std::string& tree);

  AsyncRequests& async_requests_;
  const std::function<void(const Listed&)> on_list_;
};

// From the replies to a ListRequest and a TreeRequest. Nothing when they cannot be read.
std::optional<Listed> parse_listed(const std::string& list, const std::string& tree);

}  // namespace ros2
