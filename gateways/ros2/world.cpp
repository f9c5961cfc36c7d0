#include "world.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/log.h"
#include "ros/from_iface.h"

namespace ros2 {
namespace {

using Json = nlohmann::json;

shm::Pose listed_pose(const Json& json) {
  const auto p = json.value("pose", std::vector<double>());
  if (p.size() != 7) return shm::identity_pose;
  return {p[0], p[1], p[2], p[3], p[4], p[5], p[6]};
}

ListedModel listed_model(const Json& json) {
  ListedModel model{json.value("name", ""), listed_pose(json), json.value("static", false), {}, {}, {}};
  const auto to_model = ros::inverse(model.pose);
  for (const auto& link : json.value("links", Json::array())) {
    ListedLink listed{link.value("name", ""), {}};
    const auto place = ros::product(to_model, listed_pose(link));
    for (const auto& shape : link.value("collisions", Json::array()))
      listed.shapes.push_back(
          {shape.value("shape", ""), ros::product(place, listed_pose(shape)), shape.value("size", std::vector<double>())});
    for (const auto& sensor : link.value("sensors", Json::array()))
      if (const auto iface = sensor.value("iface", ""); !iface.empty()) model.sensor_links[iface] = listed.name;
    model.links.push_back(std::move(listed));
  }
  for (const auto& joint : json.value("joints", Json::array())) {
    model.joint_positions[joint.value("name", "")] = joint.value("position", 0.0);
    if (joint.value("type", "") == "fixed") model.fixed_to[joint.value("child", "")] = joint.value("parent", "");
  }
  return model;
}

}  // namespace

std::optional<Listed> parse_listed(const std::string& list, const std::string& tree) {
  try {
    Listed listed;
    const Json ifaces = Json::parse(list), models = Json::parse(tree);
    for (const auto& one : ifaces.at("ifaces")) {
      const auto type = shm::parse_type(one.value("type", ""));
      if (type) listed.ifaces.push_back({*type, one.value("name", ""), one.value("model", "")});
    }
    for (const auto& model : models.at("models")) listed.models.push_back(listed_model(model));
    return listed;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

World::World(std::uint32_t server_id, AsyncRequests& async_requests, std::function<void(const Listed&)> on_list,
             std::function<void()> on_loss)
    : SimulatorLink(server_id, "ros2-gateway", std::move(on_loss)), async_requests_(async_requests), on_list_(std::move(on_list)) {}

void World::list() {
  async_requests_.post(shm::ListRequest{}, [this, met = met()](const base::Result<shm::Reply>& list) {
    if (!list || met != this->met()) return listed(false);
    async_requests_.post(shm::TreeRequest{}, [this, met, text = list->text](const base::Result<shm::Reply>& tree) {
      const bool is_known = tree && met == this->met() && is_there();
      listed(is_known);
      if (is_known) take(text, tree->text);
    });
  });
}

void World::take(const std::string& list, const std::string& tree) {
  if (const auto read = parse_listed(list, tree)) return on_list_(*read);
  base::log(base::Level::error, "ros2-gateway", "the list of simulator {} cannot be read", server_id());
}

}  // namespace ros2
