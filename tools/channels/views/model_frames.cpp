#include "channels/views/model_frames.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "channels/views/iface_view.h"
#include "channels/views/shapes.h"

namespace channels {

namespace {

using Json = nlohmann::json;

shm::Pose pose_in(const Json& json) {
  const auto p = json.value("pose", std::vector<double>());
  if (p.size() != 7) return shm::identity_pose;
  return {p[0], p[1], p[2], p[3], p[4], p[5], p[6]};
}

void add_axes(ModelFrames& model, const Json& joints) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto type = joints[i].value("type", "");
    const auto name = joints[i].value("name", "");
    if (type == "fixed") continue;
    model.is_rigid = model.is_static;
    if (type == "ball" || type == "gearbox") continue;  // which have no position
    model.axes.push_back({name, i, 0});
    if (type == "universal" || type == "revolute2") model.axes.push_back({name + "/2", i, 1});
  }
}

ModelFrames frames_of(const Json& json) {
  ModelFrames model{json.value("name", ""), json.value("static", false), pose_in(json), {}, {}, 0, true};
  model.joints = json.value("joints", Json::array()).size();
  const auto to_model = inverse(model.pose);
  for (const auto& link : json.value("links", Json::array()))
    model.links.push_back({model.name + "::" + link.value("name", ""), product(to_model, pose_in(link))});
  add_axes(model, json.value("joints", Json::array()));
  return model;
}

constexpr std::chrono::seconds answer_limit{3}, export_limit{60};
constexpr std::size_t per_link = 7, per_joint = 4;

shm::Pose link_pose(const float* p) { return {p[0], p[1], p[2], p[3], p[4], p[5], p[6]}; }

}  // namespace

base::Result<void> Limbs::learn() {
  version_ = -1;
  if (!simulator_) {
    auto opened = shm::Requester::open(server_id_);
    if (!opened) return opened.error();
    simulator_.emplace(std::move(*opened));
  }
  const auto reply = simulator_->ask(shm::TreeRequest{}, answer_limit);
  if (!reply) return reply.error();
  const auto tree = Json::parse(reply->text, nullptr, false);
  if (!tree.is_object()) return base::Error{"simulator: its list of models is not JSON"};
  models_.clear();
  actor_frames_.clear();
  link_count_ = joint_count_ = 0;
  try {
    for (const auto& model : tree.value("models", Json::array())) models_.push_back(frames_of(model));
  } catch (const Json::exception&) {
    return base::Error{"simulator: its list of models has an unexpected form"};
  }
  for (const auto& model : models_) {
    link_count_ += model.links.size();
    joint_count_ += model.joints;
  }
  has_actors_ = !tree.value("actors", Json::array()).empty();
  if (!has_moving()) return {};  // and the simulator need not make a scene
  const auto now = simulator_->ask(shm::PosesRequest{}, answer_limit);
  if (!now) return now.error();
  if (now->status != shm::RequestStatus::ok) return {};
  if (has_actors_) {
    // Their bones are known to those who draw them alone. A world that cannot be drawn has no frames of actors.
    const auto scene = simulator_->ask(shm::ExportRequest{}, export_limit);
    if (!scene) return scene.error();
    const auto names = links_in(scene->text);
    has_actors_ = scene->status == shm::RequestStatus::ok && names && names->size() >= link_count_;
    if (has_actors_) actor_frames_.assign(names->begin() + static_cast<std::ptrdiff_t>(link_count_), names->end());
  }
  version_ = now->values[0];
  return {};
}

bool Limbs::has_moving() const {
  return has_actors_ || std::ranges::any_of(models_, [](const ModelFrames& model) { return !model.is_rigid; });
}

bool Limbs::read() {
  const auto reply = simulator_ ? simulator_->ask(shm::PosesRequest{}, answer_limit) : base::Error{""};
  if (!reply || reply->status != shm::RequestStatus::ok || reply->values[0] != version_) return false;
  // Actors come behind the links of models.
  const auto links = static_cast<std::size_t>(std::max<std::int64_t>(reply->count, 0));
  const auto joints = static_cast<std::size_t>(std::max(reply->values[1], 0.0));
  if (links < link_count_ || joints != joint_count_ || reply->text.size() != (links * per_link + joints * per_joint) * sizeof(float))
    return false;
  if (links != link_count_ + actor_frames_.size() && has_actors_) return false;
  links_.resize(links * per_link);
  joints_.resize(joint_count_ * per_joint);
  std::memcpy(links_.data(), reply->text.data(), links_.size() * sizeof(float));
  std::memcpy(joints_.data(), reply->text.data() + links * per_link * sizeof(float), joints_.size() * sizeof(float));
  return true;
}

void Limbs::add_transforms(const shm::Stamp& stamp, const std::map<std::string, shm::Pose>& places,
                           std::vector<ros::TransformStamped>& transforms) const {
  const float* first = links_.data();
  for (const auto& model : models_) {
    const float* links = std::exchange(first, first + model.links.size() * per_link);
    const auto place = places.find(model.name);
    if (model.is_rigid || place == places.end()) continue;
    const auto to_model = inverse(place->second);
    for (std::size_t i = 0; i < model.links.size(); ++i)
      transforms.push_back(transform_of(stamp, model.name, model.links[i].frame, product(to_model, link_pose(links + i * per_link))));
  }
  for (const auto& frame : actor_frames_)
    transforms.push_back(transform_of(stamp, world_frame, frame, link_pose(std::exchange(first, first + per_link))));
}

ros::JointState Limbs::joints_of(std::size_t model, const shm::Stamp& stamp) const {
  ros::JointState state{.header = header_of(stamp, models_[model].name)};
  std::size_t before = 0;
  for (std::size_t i = 0; i < model; ++i) before += models_[i].joints;
  for (const auto& axis : models_[model].axes) {
    const float* values = joints_.data() + (before + axis.joint) * per_joint;
    state.names.push_back(axis.name);
    state.position.push_back(values[axis.number]);
    state.velocity.push_back(values[2 + axis.number]);
  }
  return state;
}

}  // namespace channels
