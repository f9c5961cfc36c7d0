#include "physics/joint_dynamics.h"

#include <algorithm>

namespace sim {
namespace {

std::optional<std::size_t> link_index(const ModelDef& model, const std::string& name) {
  const auto found = std::ranges::find_if(model.links, [&](const LinkDef& link) { return link.name == name; });
  if (found == model.links.end()) return std::nullopt;
  return static_cast<std::size_t>(found - model.links.begin());
}

// For each link the number of the joint that moves it, -1: none of them.
std::vector<int> owners_of(const ModelDef& model, std::span<const std::uint32_t> joints) {
  std::vector<const JointDef*> by_child(model.links.size(), nullptr);
  std::vector<int> number(model.links.size(), -1);
  for (std::uint32_t j = 0; j < model.joints.size(); ++j) {
    const auto child = link_index(model, model.joints[j].child);
    if (!child || by_child[*child] != nullptr) continue;
    by_child[*child] = &model.joints[j];
    const auto listed = std::ranges::find(joints, j);
    if (listed != joints.end()) number[*child] = static_cast<int>(listed - joints.begin());
  }
  std::vector<int> owners(model.links.size(), -1);
  for (std::size_t l = 0; l < model.links.size(); ++l) {
    std::optional<std::size_t> at = l;
    for (std::size_t hops = 0; at && hops <= model.links.size(); ++hops) {
      if (number[*at] >= 0) {
        owners[l] = number[*at];
        break;
      }
      at = by_child[*at] != nullptr ? link_index(model, by_child[*at]->parent) : std::nullopt;
    }
  }
  return owners;
}

// Mass, centre and inertia of two rigid parts together, in one frame.
void join(JointDynamics::Body& body, double mass, const Eigen::Vector3d& center, const Eigen::Matrix3d& inertia) {
  const auto about = [](double m, const Eigen::Vector3d& r) -> Eigen::Matrix3d {
    return m * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  };
  const double sum = body.mass + mass;
  if (!(sum > 0)) return;
  const Eigen::Vector3d middle = (body.mass * body.center_of_mass + mass * center) / sum;
  body.inertia = body.inertia + about(body.mass, body.center_of_mass - middle) + inertia + about(mass, center - middle);
  body.mass = sum;
  body.center_of_mass = middle;
}

Eigen::Isometry3d moved(const JointDynamics::Body& body, double position) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (body.slides) {
    motion.translation() = position * body.axis;
  } else {
    motion.linear() = Eigen::AngleAxisd(position, body.axis).toRotationMatrix();
  }
  return body.in_parent * motion;
}

double value_at(std::span<const double> values, std::size_t i) { return i < values.size() ? values[i] : 0; }

}  // namespace

JointDynamics::JointDynamics(const ModelDef& model, std::span<const std::uint32_t> joints) : bodies_(joints.size()) {
  const std::vector<int> owners = owners_of(model, joints);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointDef& joint = model.joints[joints[i]];
    const auto parent = link_index(model, joint.parent);
    Body& body = bodies_[i];
    body.parent = parent ? owners[*parent] : -1;
    if (body.parent == static_cast<int>(i)) body.parent = -1;
    body.axis = joint.axes[0].xyz.normalized();
    body.slides = joint.kind == JointDef::Kind::prismatic;
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Eigen::Isometry3d& place = model.joints[joints[i]].pose_in_model;
    const int parent = bodies_[i].parent;
    bodies_[i].in_parent = parent < 0 ? place : model.joints[joints[static_cast<std::size_t>(parent)]].pose_in_model.inverse() * place;
  }
  for (std::size_t l = 0; l < model.links.size(); ++l) {
    if (owners[l] < 0) continue;
    const LinkDef& link = model.links[l];
    const auto owner = static_cast<std::size_t>(owners[l]);
    const Eigen::Isometry3d in_joint = model.joints[joints[owner]].pose_in_model.inverse() * link.pose;
    join(bodies_[owner], link.mass, in_joint * link.center_of_mass, in_joint.linear() * link.inertia * in_joint.linear().transpose());
  }
  // Joints of a file stand in any order; those of a loop, which have no first one, hang on the base.
  std::vector<bool> is_placed(joints.size(), false);
  while (order_.size() < joints.size()) {
    const std::size_t before = order_.size();
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const int parent = bodies_[i].parent;
      if (is_placed[i] || (parent >= 0 && !is_placed[static_cast<std::size_t>(parent)])) continue;
      is_placed[i] = true;
      order_.push_back(i);
    }
    if (order_.size() > before) continue;
    const auto first = static_cast<std::size_t>(std::ranges::find(is_placed, false) - is_placed.begin());
    bodies_[first].parent = -1;
    bodies_[first].in_parent = model.joints[joints[first]].pose_in_model;
  }
}

void JointDynamics::poses(std::span<const double> positions, std::vector<Eigen::Isometry3d>& out) const {
  out.resize(bodies_.size());
  for (const std::size_t i : order_) {
    const Body& body = bodies_[i];
    out[i] = moved(body, value_at(positions, i));
    if (body.parent >= 0) out[i] = out[static_cast<std::size_t>(body.parent)] * out[i];
  }
}

void JointDynamics::efforts(std::span<const double> positions, std::span<const double> velocities, std::span<const double> accelerations,
                            const Eigen::Vector3d& gravity, std::span<double> out) const {
  struct Motion {
    Eigen::Isometry3d pose;
    Eigen::Vector3d axis, turn, turn_change, change;  // angular velocity and acceleration, linear acceleration of the joint's origin
    Eigen::Vector3d force{0, 0, 0}, torque{0, 0, 0};  // on the joint, about its origin
  };
  thread_local std::vector<Motion> motions;
  motions.assign(bodies_.size(), Motion{});
  for (const std::size_t i : order_) {
    const Body& body = bodies_[i];
    const double v = value_at(velocities, i), a = value_at(accelerations, i);
    Motion& m = motions[i];
    m.pose = moved(body, value_at(positions, i));
    Eigen::Vector3d turn{0, 0, 0}, turn_change{0, 0, 0}, change = -gravity, from{0, 0, 0};
    if (body.parent >= 0) {
      const Motion& carrier = motions[static_cast<std::size_t>(body.parent)];
      m.pose = carrier.pose * m.pose;
      turn = carrier.turn, turn_change = carrier.turn_change, change = carrier.change, from = carrier.pose.translation();
    }
    m.axis = m.pose.linear() * body.axis;
    const Eigen::Vector3d arm = m.pose.translation() - from;
    m.change = change + turn_change.cross(arm) + turn.cross(turn.cross(arm));
    m.turn = turn, m.turn_change = turn_change;
    if (body.slides) {
      m.change += 2 * v * turn.cross(m.axis) + a * m.axis;
    } else {
      m.turn += v * m.axis;
      m.turn_change += a * m.axis + v * turn.cross(m.axis);
    }
  }
  for (auto it = order_.rbegin(); it != order_.rend(); ++it) {
    const Body& body = bodies_[*it];
    Motion& m = motions[*it];
    const Eigen::Matrix3d rotation = m.pose.linear();
    const Eigen::Vector3d arm = rotation * body.center_of_mass;
    const Eigen::Matrix3d inertia = rotation * body.inertia * rotation.transpose();
    const Eigen::Vector3d force = body.mass * (m.change + m.turn_change.cross(arm) + m.turn.cross(m.turn.cross(arm)));
    m.force += force;
    m.torque += inertia * m.turn_change + m.turn.cross(inertia * m.turn) + arm.cross(force);
    out[*it] = m.axis.dot(body.slides ? m.force : m.torque);
    if (body.parent < 0) continue;
    Motion& carrier = motions[static_cast<std::size_t>(body.parent)];
    carrier.force += m.force;
    carrier.torque += m.torque + (m.pose.translation() - carrier.pose.translation()).cross(m.force);
  }
}

double JointDynamics::inertia(std::span<const double> positions, std::size_t joint) const {
  std::vector<double> acceleration(bodies_.size(), 0.0), effort(bodies_.size(), 0.0);
  acceleration[joint] = 1;
  efforts(positions, {}, acceleration, Eigen::Vector3d::Zero(), effort);
  return effort[joint];
}

double JointDynamics::max_gravity_effort(std::size_t joint, double gravity) const {
  // By the way along the links from the joint to each centre of mass, stretched.
  std::vector<double> reach(bodies_.size(), -1);
  double sum = 0;
  for (const std::size_t i : order_) {
    const Body& body = bodies_[i];
    if (i == joint) {
      reach[i] = 0;
    } else if (body.parent >= 0 && reach[static_cast<std::size_t>(body.parent)] >= 0) {
      reach[i] = reach[static_cast<std::size_t>(body.parent)] + body.in_parent.translation().norm();
    } else {
      continue;
    }
    sum += body.mass * gravity * (bodies_[joint].slides ? 1 : reach[i] + body.center_of_mass.norm());
  }
  return sum;
}

}  // namespace sim
