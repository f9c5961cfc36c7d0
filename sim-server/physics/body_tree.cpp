#include "physics/body_tree.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace sim {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// As ODE has them, implicit.
Eigen::Vector3d gyroscopic_torque(const Eigen::Matrix3d& inertia, const Eigen::Vector3d& turning, double dt) {
  const Eigen::Vector3d momentum = inertia * turning;
  const Eigen::Matrix3d effective = inertia - dt * cross_matrix(momentum);
  return (inertia * effective.inverse() - Eigen::Matrix3d::Identity()) * momentum / dt;
}

}  // namespace

void BodyTree::clear() {
  count_ = 0;
  places_.clear();
}

void BodyTree::add_model(ModelInstance& model, const PhysicsDef& physics, dWorldID world) {
  const auto first = static_cast<int>(count_);
  const double dt = physics.step;
  for (const auto& place : model.tree().places) {
    const dBodyID body = model.body(place.assembly);
    if (dBodyIsKinematic(body) != 0) continue;  // alone: those have no joints
    if (count_ == nodes_.size()) nodes_.emplace_back();
    Node& node = nodes_[count_];
    node.body = body;
    node.parent = place.parent < 0 ? -1 : first + place.parent;
    node.joint = place.joint < 0 ? nullptr : &model.joints()[static_cast<std::size_t>(place.joint)];
    node.touches = false;
    dMass mass;
    dBodyGetMass(body, &mass);
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> own(mass.I);
    const Eigen::Matrix3d turn = ode::quaternion(dBodyGetQuaternion(body)).toRotationMatrix();
    const Eigen::Matrix3d inertia = turn * own.leftCols<3>() * turn.transpose();
    node.mass.setZero();
    node.mass.diagonal().head<3>().setConstant(mass.mass);
    node.mass.bottomRightCorner<3, 3>() = inertia;
    Eigen::Vector3d force = ode::vector(dBodyGetForce(body)), torque = ode::vector(dBodyGetTorque(body));
    if (dBodyGetGravityMode(body) != 0) force += mass.mass * physics.gravity;
    const Vector6 velocity = velocity_of(body);
    if (dBodyGetGyroscopicMode(body) != 0) torque += gyroscopic_torque(inertia, velocity.tail<3>(), dt);
    node.momentum = node.mass * velocity + dt * wrench(force, torque);
    places_.emplace_back(body, static_cast<int>(count_++));
    node.rows.clear();
    if (node.joint != nullptr) node.rows.make(*node.joint, {body, place.is_child}, world, dt);
  }
}

void BodyTree::sort() { std::sort(places_.begin(), places_.end()); }

int BodyTree::node_of(dBodyID body) const {
  const auto found = std::lower_bound(places_.begin(), places_.end(), body, [](const auto& place, dBodyID b) { return place.first < b; });
  return found != places_.end() && found->first == body ? found->second : -1;
}

int BodyTree::node_of(const JointInstance& joint) const {
  const auto all = nodes();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Node& node) { return node.joint == &joint; });
  return found == all.end() ? -1 : static_cast<int>(found - all.begin());
}

void BodyTree::mark_touched(int node) {
  for (; node >= 0 && !at(node).touches; node = at(node).parent) at(node).touches = true;
}

void BodyTree::gather_trees() {
  int count = 0;
  for (auto& places : trees_) places.clear();
  for (std::size_t i = 0; i < count_; ++i) {
    Node& node = nodes_[i];
    node.tree = node.parent < 0 ? count++ : at(node.parent).tree;
    if (trees_.size() < static_cast<std::size_t>(count)) trees_.emplace_back();
    if (node.touches) trees_[static_cast<std::size_t>(node.tree)].push_back(static_cast<int>(i));
  }
}

// The free rows of the node's joint, side by side.
void BodyTree::gather(Node& node) {
  const auto count = std::count_if(node.rows.begin(), node.rows.end(), [](const TreeRow& row) { return row.is_free(); });
  node.own.resize(count, 6);
  node.parent_side.resize(count, 6);
  node.target.resize(count);
  Eigen::Index i = 0;
  for (const TreeRow& row : node.rows) {
    if (!row.is_free()) continue;
    node.own.row(i) = row.own.transpose();
    node.parent_side.row(i) = row.parent.transpose();
    node.target[i++] = row.target;
  }
}

void BodyTree::factor() {
  const auto all = nodes();
  for (Node& node : all) node.joined = node.mass;
  for (auto node = all.rbegin(); node != all.rend(); ++node) {
    node->inverse = node->joined.llt().solve(Matrix6::Identity());
    gather(*node);
    const Eigen::Index count = node->own.rows();
    if (count == 0) continue;
    node->answer.noalias() = node->own * node->inverse;
    Node::FewSquare give = node->answer * node->own.transpose();
    Eigen::Index i = 0;
    for (const TreeRow& row : node->rows) {
      if (row.is_free()) give(i, i) += row.give, ++i;
    }
    node->inverse_give = give.llt().solve(Node::FewSquare::Identity(count, count));
    if (node->parent < 0) continue;
    node->pull.noalias() = node->inverse_give * node->parent_side;
    at(node->parent).joined.noalias() += node->parent_side.transpose() * node->pull;
  }
}

void BodyTree::pull_up(Node& node, bool is_homogeneous) {
  if (node.own.rows() == 0) return;
  Node::Few open = -(node.answer * node.impulse);
  if (!is_homogeneous) open += node.target;
  node.share.noalias() = node.inverse_give * open;
  if (node.parent >= 0) at(node.parent).impulse.noalias() += node.parent_side.transpose() * node.share;
}

void BodyTree::push_down(Node& node) {
  node.velocity.noalias() = node.inverse * node.impulse;
  if (node.own.rows() == 0) return;
  if (node.parent >= 0) node.share.noalias() -= node.pull * at(node.parent).velocity;
  node.velocity.noalias() += node.answer.transpose() * node.share;
}

void BodyTree::load() {
  for (Node& node : nodes()) node.impulse = node.momentum;
  for (Node& node : nodes()) {
    for (const TreeRow& row : node.rows) {
      if (row.is_free()) continue;
      node.impulse += row.own * row.impulse;
      if (node.parent >= 0) at(node.parent).impulse += row.parent * row.impulse;
    }
  }
}

void BodyTree::sweep() {
  const auto all = nodes();
  for (auto node = all.rbegin(); node != all.rend(); ++node) pull_up(*node, false);
  for (Node& node : all) push_down(node);
}

void BodyTree::sweep_touched(const std::vector<int>& trees) {
  for (const int tree : trees) {
    const auto& places = trees_[static_cast<std::size_t>(tree)];
    for (auto place = places.rbegin(); place != places.rend(); ++place) pull_up(at(*place), true);
    for (const int place : places) push_down(at(place));
  }
}

void BodyTree::clear_touched(const std::vector<int>& trees) {
  for (const int tree : trees) {
    for (const int place : trees_[static_cast<std::size_t>(tree)]) at(place).impulse.setZero(), at(place).velocity.setZero();
  }
}

void BodyTree::clear_touched() {
  for (Node& node : nodes()) {
    if (node.touches) node.impulse.setZero(), node.velocity.setZero();
  }
}

bool BodyTree::bind_joints(bool one_at_a_time) {
  bool has_changed = false;
  for (Node& node : nodes()) {
    Eigen::Index free = 0;
    for (TreeRow& row : node.rows) {
      double left_over = 0;
      if (row.is_free()) {
        row.impulse = node.share[free++];
      } else {
        left_over = row.own.dot(node.velocity) + row.give * row.impulse - row.target;
        if (node.parent >= 0) left_over += row.parent.dot(at(node.parent).velocity);
      }
      if (one_at_a_time && has_changed) continue;
      const Bound better = better_bound(row.bound, row.impulse, left_over, row.low, row.high, 1e-12 + 1e-9 * std::abs(row.target));
      if (better == row.bound) continue;
      has_changed = true;
      row.bound = better;
      if (better != Bound::free) row.impulse = better == Bound::low ? row.low : row.high;
    }
  }
  return has_changed;
}

bool BodyTree::is_finite() const {
  const auto all = nodes();
  return std::all_of(all.begin(), all.end(), [](const Node& node) { return node.velocity.allFinite(); });
}

}  // namespace sim
