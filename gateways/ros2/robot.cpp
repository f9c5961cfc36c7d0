#include "robot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/log.h"
#include "robot_topics.h"

namespace ros2 {
namespace {

NodeName node_name(const Naming& naming, const RobotNames& names, const std::string& model) {
  if (naming.is_one_node) return gateway_node;
  return names.space == "/" ? NodeName{"/", token(model)} : NodeName{names.space, "robot"};
}

}  // namespace

bool Outlet::is_wanted() const {
  return std::ranges::any_of(writers, [](const Writer* writer) { return !writer->readers().empty(); });
}

Robot::Robot(Shared& shared, std::string model, const Listed& listed)
    : shared_(shared),
      model_(std::move(model)),
      names_(shared.naming.names_of(model_)),
      node_(shared.participant, shared.graph, node_name(shared.naming, names_, model_)),
      commands_(node_, shared.command_timeout, shared.on_arrival) {
  RobotTopics(*this).make(listed);
}

Writer* Robot::tf() {
  if (shared_.tf != nullptr) return shared_.tf;
  if (own_tf_ == nullptr) own_tf_ = node_.advertise<ros::TFMessage>(names_.topic("tf"), {false, 100});
  return own_tf_;
}

void Robot::send_static_transforms() {
  if (shared_.tf != nullptr) return;
  if (own_tf_static_ == nullptr) own_tf_static_ = node_.advertise<ros::TFMessage>(names_.topic("tf_static"), {true, 1});
  if (own_tf_static_ != nullptr) publish(*own_tf_static_, ros::TFMessage{static_transforms_});
}

Robot::~Robot() {
  for (Outlet& outlet : outlets_) {
    if (outlet.is_read) outlet.source->remove_reader();
  }
}

bool Robot::is_gone() const {
  return std::ranges::any_of(outlets_, [](const Outlet& outlet) { return outlet.source->is_closed(); });
}

std::vector<std::string> Robot::topics() const {
  std::vector<std::string> topics;
  for (const auto& writer : node_.writers())
    topics.push_back(writer->settings().topic.substr(2) + " " + type_of_ros(writer->settings().type));
  for (const auto& topic : commands_.topics()) topics.push_back(topic + " (command)");
  return topics;
}

bool Robot::choose_sources() {
  bool has_changed = false;
  for (Outlet& outlet : outlets_) {
    const bool is_joints = outlet.source->iface().type() == shm::IfaceType::joints;
    const bool is_wanted = outlet.is_wanted() || (is_joints && commands_.is_moving());
    if (is_wanted == outlet.is_read) continue;
    if (is_wanted) {
      if (auto done = outlet.source->add_reader(); !done) {
        base::log(base::Level::warn, "ros2-gateway", "{}", done.error().message);
        continue;
      }
    } else {
      outlet.source->remove_reader();
    }
    outlet.is_read = is_wanted;
    has_changed = true;
  }
  return has_changed;
}

void Robot::read() {
  fresh_.clear();
  for (Outlet& outlet : outlets_) {
    if (outlet.is_read && outlet.source->take_news()) fresh_.push_back(&outlet);
  }
}

void Robot::show(bool is_first) {
  for (Outlet* outlet : fresh_) {
    if (outlet->is_first != is_first) continue;
    shm::Iface& iface = outlet->source->iface();
    const bool has_frames = shm::has_frames(iface.type());
    const auto frame = has_frames ? iface.hold() : std::nullopt;
    if (has_frames && (!frame || frame->head().stamp.valid == 0)) continue;
    const auto& stamp = has_frames ? frame->head().stamp : iface.sample<shm::Stamp>();
    if (iface.type() == shm::IfaceType::joints) commands_.advance();
    const bool is_early =
        outlet->last_ns >= 0 && stamp.sim_time_ns >= outlet->last_ns && stamp.sim_time_ns < outlet->last_ns + outlet->period.count();
    if (is_early) continue;
    outlet->last_ns = stamp.sim_time_ns;
    outlet->show(iface, frame ? &*frame : nullptr);
  }
}

}  // namespace ros2
