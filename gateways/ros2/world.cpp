#include "world.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

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
  ListedModel model{json.value("name", ""), listed_pose(json), json.value("static", false), {}, {}};
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

World::World(std::uint32_t server_id, Errands& errands, std::function<void(const Listed&)> on_list, std::function<void()> on_loss)
    : server_id_(server_id), errands_(errands), on_list_(std::move(on_list)), on_loss_(std::move(on_loss)) {}

void World::look() {
  if (clock_ && clock_->iface().status() != shm::Status::live) lose();
  if (!clock_) {
    auto clock = Source::open(server_id_, shm::IfaceType::simulation, "world", met_ + 1);
    if (!clock) return;
    clock_ = std::move(*clock);
    ++met_;
    has_list_ = false;
    found_.clear();
  }
  auto present = listed_;
  if (clock_->iface().read()) {
    const auto& sample = clock_->iface().sample<shm::SimulationSample>();
    present = {sample.ifaces, sample.models};
  }
  const auto used = sources();
  const bool is_one_gone = std::ranges::any_of(used, [](const auto& one) { return one->is_closed(); });
  if (is_listing_ || (has_list_ && present == listed_ && !is_one_gone)) return;
  listed_ = present;
  list();
}

void World::lose() {
  base::log(base::Level::warn, "ros2-gateway", "simulator {} has ended; waiting for it", server_id_);
  clock_.reset();
  found_.clear();
  on_loss_();
}

void World::list() {
  is_listing_ = has_list_ = true;
  errands_.post(shm::ListRequest{}, [this, met = met_](const base::Result<shm::Reply>& list) {
    if (!list || met != met_) {
      is_listing_ = has_list_ = false;  // asked again at the next look
      return;
    }
    errands_.post(shm::TreeRequest{}, [this, met, text = list->text](const base::Result<shm::Reply>& tree) {
      is_listing_ = false;
      has_list_ = tree && met == met_ && clock_;
      if (has_list_) take(text, tree->text);
    });
  });
}

void World::take(const std::string& list, const std::string& tree) {
  if (const auto listed = parse_listed(list, tree)) return on_list_(*listed);
  base::log(base::Level::error, "ros2-gateway", "the list of simulator {} cannot be read", server_id_);
}

std::shared_ptr<Source> World::find(shm::IfaceType type, const std::string& name) {
  if (!clock_) return nullptr;
  auto& known = found_[{type, name}];
  if (auto source = known.lock(); source && !source->is_closed()) return source;
  auto source = Source::open(server_id_, type, name, met_);
  if (!source) {
    base::log(base::Level::warn, "ros2-gateway", "{}", source.error().message);
    return nullptr;
  }
  known = *source;
  return *source;
}

std::vector<std::shared_ptr<Source>> World::sources() {
  std::vector<std::shared_ptr<Source>> used;
  std::erase_if(found_, [&](const auto& entry) {
    auto source = entry.second.lock();
    if (source) used.push_back(std::move(source));
    return entry.second.expired();
  });
  return used;
}

}  // namespace ros2
