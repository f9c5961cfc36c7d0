// The simulator that the gateway serves: found when it starts, lost when it ends, listed again when models come or go. One thread at a
// time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/errands.h"
#include "common/source.h"
#include "shm/iface_types.h"

namespace ros2 {

using gateway::Errands;
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
};
struct Listed {
  std::vector<ListedIface> ifaces;
  std::vector<ListedModel> models;
};

class World {
 public:
  World(std::uint32_t server_id, Errands& errands, std::function<void(const Listed&)> on_list, std::function<void()> on_loss);

  // To be called some times a second.
  void look();
  bool is_there() const { return clock_ != nullptr; }
  // The simulation iface; nothing while there is no simulator.
  const std::shared_ptr<Source>& clock() const { return clock_; }
  // The iface, opened once; nothing, with a line in the log, when it is not there.
  std::shared_ptr<Source> find(shm::IfaceType type, const std::string& name);
  std::vector<std::shared_ptr<Source>> sources();

 private:
  void lose();
  void list();
  void take(const std::string& list, const std::string& tree);

  const std::uint32_t server_id_;
  Errands& errands_;
  const std::function<void(const Listed&)> on_list_;
  const std::function<void()> on_loss_;
  std::shared_ptr<Source> clock_;
  std::uint64_t met_ = 0;
  std::pair<std::uint32_t, std::uint32_t> listed_{};
  bool is_listing_ = false, has_list_ = false;
  std::map<std::pair<shm::IfaceType, std::string>, std::weak_ptr<Source>> found_;
};

// From the replies to a ListRequest and a TreeRequest. Nothing when they cannot be read.
std::optional<Listed> parse_listed(const std::string& list, const std::string& tree);

}  // namespace ros2
