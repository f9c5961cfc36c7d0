#include "physics/body_tree.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

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

template <int size>
using Square = Eigen::Matrix<double, size, size>;

// Of a symmetric, positive definite matrix, by Gauss-Jordan elimination, whose pivots are positive then. No numbers when it is none.
template <int size>
Square<size> inverse_of(const Square<size>& a) {
  Square<size> left = -a;  // what is left of the matrix, and what is found of the inverse, with the other sign
  for (int k = 0; k < size; ++k) {
    const double pivot = left(k, k) < 0 ? -1 / left(k, k) : std::numeric_limits<double>::quiet_NaN();
    const Eigen::Matrix<double, size, 1> column = left.col(k), shares = pivot * column;
    for (int j = 0; j < size; ++j) left.col(j) += shares[j] * column;
    left.col(k) = shares;
    left.row(k) = shares.transpose();
    left(k, k) = pivot;
  }
  return left;
}

// Most joints have at most six free rows; fixed sizes are computed with several times as fast.
template <class Work>
void with_size(int rows, const Work& work) {
  constexpr int usual = 6;
  rows <= usual ? work.template operator()<usual>() : work.template operator()<JointRows::most>();
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
    node.root = node.parent < 0 ? static_cast<int>(count_) : at(node.parent).root;
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

// The free rows of the node's joint, side by side.
void BodyTree::gather(Node& node) {
  int i = 0;
  for (const TreeRow& row : node.rows) {
    if (!row.is_free()) continue;
    node.own.row(i) = row.own.transpose();
    node.parent_side.row(i) = row.parent.transpose();
    node.target[i] = row.target;
    node.give[i++] = row.give;
  }
  node.free = i;
  for (; i < JointRows::most; ++i) {  // which do nothing
    node.own.row(i).setZero();
    node.parent_side.row(i).setZero();
    node.target[i] = 0;
    node.give[i] = 1;
  }
}

template <int rows>
void BodyTree::factor_rows(Node& node) {
  const auto own = node.own.topRows<rows>(), parent_side = node.parent_side.topRows<rows>();
  auto answer = node.answer.topRows<rows>();
  answer.noalias() = own.lazyProduct(node.inverse);
  Square<rows> give = answer.lazyProduct(own.transpose());
  give.diagonal() += node.give.head<rows>();
  const Square<rows> inverse = inverse_of<rows>(give);
  node.inverse_give.topLeftCorner<rows, rows>() = inverse;
  if (node.parent < 0) return;
  auto pull = node.pull.topRows<rows>();
  pull.noalias() = inverse.lazyProduct(parent_side);
  at(node.parent).joined.noalias() += parent_side.transpose().lazyProduct(pull);
}

void BodyTree::factor() {
  const auto all = nodes();
  for (Node& node : all) node.joined = node.mass;
  for (auto node = all.rbegin(); node != all.rend(); ++node) {
    node->inverse = inverse_of<6>(node->joined);
    gather(*node);
    if (node->free > 0) with_size(node->free, [&]<int rows>() { factor_rows<rows>(*node); });
  }
}

void BodyTree::pull_up(Node& node) {
  if (node.free == 0) return;
  with_size(node.free, [&]<int rows>() {
    const Eigen::Matrix<double, rows, 1> open = node.target.head<rows>() - node.answer.topRows<rows>().lazyProduct(node.impulse);
    node.share.head<rows>().noalias() = node.inverse_give.topLeftCorner<rows, rows>().lazyProduct(open);
    if (node.parent >= 0)
      at(node.parent).impulse.noalias() += node.parent_side.topRows<rows>().transpose().lazyProduct(node.share.head<rows>());
  });
}

void BodyTree::push_down(Node& node) {
  node.velocity.noalias() = node.inverse.lazyProduct(node.impulse);
  if (node.free == 0) return;
  with_size(node.free, [&]<int rows>() {
    if (node.parent >= 0) node.share.head<rows>().noalias() -= node.pull.topRows<rows>().lazyProduct(at(node.parent).velocity);
    node.velocity.noalias() += node.answer.topRows<rows>().transpose().lazyProduct(node.share.head<rows>());
  });
}

template <int rows>
void BodyTree::prepare_answer(Node& node) {
  const auto answer = node.answer.topRows<rows>();
  const Eigen::Matrix<double, rows, 6> shares = node.inverse_give.topLeftCorner<rows, rows>().lazyProduct(answer);
  node.alone.noalias() -= answer.transpose().lazyProduct(shares);
  node.passed_on.noalias() = -node.parent_side.topRows<rows>().transpose().lazyProduct(shares);
}

void BodyTree::prepare_answers() {
  for (Node& node : nodes()) {
    if (!node.touches) continue;
    node.alone = node.inverse;
    node.passed_on.setZero();
    if (node.free > 0) with_size(node.free, [&]<int rows>() { prepare_answer<rows>(node); });
    node.whole = node.alone;
    if (node.parent < 0) continue;
    const Matrix6 of_parent = at(node.parent).whole.lazyProduct(node.passed_on);
    node.whole.noalias() += node.passed_on.transpose().lazyProduct(of_parent);
  }
}

// Parents come before what hangs on them: the later of two nodes hangs on the other, or on what it has in common with it.
Matrix6 BodyTree::answer(int at, int from) const {
  if (at == from) return this->at(at).whole;
  if (at < from) return answer(from, at).transpose();
  const Node& node = this->at(at);
  return node.passed_on.transpose().lazyProduct(answer(node.parent, from));
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
  for (auto node = all.rbegin(); node != all.rend(); ++node) pull_up(*node);
  for (Node& node : all) push_down(node);
}

bool BodyTree::bind_joints(bool one_at_a_time) {
  bool has_changed = false;
  for (Node& node : nodes()) {
    Eigen::Index free = 0;
    for (TreeRow& row : node.rows) {
      double residual = 0;
      if (row.is_free()) {
        row.impulse = node.share[free++];
      } else {
        residual = row.own.dot(node.velocity) + row.give * row.impulse - row.target;
        if (node.parent >= 0) residual += row.parent.dot(at(node.parent).velocity);
      }
      if (one_at_a_time && has_changed) continue;
      const Bound better = better_bound(row.bound, row.impulse, residual, row.low, row.high, 1e-12 + 1e-9 * std::abs(row.target));
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
