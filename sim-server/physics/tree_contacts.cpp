#include "physics/tree_contacts.h"

#include <algorithm>
#include <cmath>

#include "physics/weld.h"

namespace sim {

// --- rows

void TreeContacts::add_row(Touch& touch, const Eigen::Vector3d& line, const Row& row) {
  const MadeContact& contact = *touch.contact;
  const Eigen::Vector3d place = ode::vector(contact.contact.geom.pos);
  Row made = row;
  made.a = touch.a, made.b = touch.b;
  made.on_a = wrench_at(line, place - ode::vector(dBodyGetPosition(contact.a)));
  made.on_b.setZero();
  if (contact.b != nullptr) made.on_b = wrench_at(-line, place - ode::vector(dBodyGetPosition(contact.b)));
  made.give = row.give / physics_.step;
  // Bodies that nothing can move go on as they do.
  if (touch.a < 0) made.target -= made.on_a.dot(velocity_of(contact.a));
  if (touch.b < 0 && contact.b != nullptr) made.target -= made.on_b.dot(velocity_of(contact.b));
  touch.lines[touch.count++] = line;
  rows_.push_back(made);
}

// The velocity at which the bodies leave each other.
double TreeContacts::target_of(const MadeContact& made) const {
  const dSurfaceParameters& surface = made.contact.surface;
  const bool is_soft = (surface.mode & dContactSoftERP) != 0;
  const double correction = (is_soft ? surface.soft_erp : dWorldGetERP(world_)) / physics_.step;
  const double target = std::min(correction * made.contact.geom.depth, dWorldGetContactMaxCorrectingVel(world_));
  if ((surface.mode & dContactBounce) == 0 || surface.bounce_vel < 0) return target;
  const Eigen::Vector3d normal = ode::vector(made.contact.geom.normal);
  dVector3 at_a, at_b = {0, 0, 0};
  const dReal* pos = made.contact.geom.pos;
  dBodyGetPointVel(made.a, pos[0], pos[1], pos[2], at_a);
  if (made.b != nullptr) dBodyGetPointVel(made.b, pos[0], pos[1], pos[2], at_b);
  const double outgoing = normal.dot(ode::vector(at_a) - ode::vector(at_b));
  return -outgoing > surface.bounce_vel ? std::max(target, -surface.bounce * outgoing) : target;
}

void TreeContacts::add(const MadeContact& made) {
  const dSurfaceParameters& surface = made.contact.surface;
  Touch touch;
  touch.contact = &made;
  touch.a = tree_.node_of(made.a), touch.b = made.b != nullptr ? tree_.node_of(made.b) : -1;
  touch.first = rows_.size();
  const auto has = [&](int flag) { return (surface.mode & flag) != 0; };
  const Eigen::Vector3d normal = ode::vector(made.contact.geom.normal);
  Row push;
  push.give = has(dContactSoftCFM) ? surface.soft_cfm : dWorldGetCFM(world_);
  push.target = target_of(made);
  add_row(touch, normal, push);
  auto [first, second] = plane_of(normal);
  if (has(dContactFDir1)) first = ode::vector(made.contact.fdir1), second = normal.cross(first);
  const auto rub = [&](const Eigen::Vector3d& line, double mu, bool has_slip, double slip, bool is_of_normal, double motion = 0) {
    if (!(mu > 0)) return;
    Row row;
    row.target = motion;
    row.give = has_slip ? slip : dWorldGetCFM(world_);
    const bool is_bounded = mu != dInfinity;
    row.low = is_bounded ? -mu * physics_.step : -infinite, row.high = -row.low;
    if (is_bounded && is_of_normal) row.normal = static_cast<int>(touch.first), row.friction = mu;
    add_row(touch, line, row);
  };
  rub(first, surface.mu, has(dContactSlip1), surface.slip1, has(dContactApprox1_1), has(dContactMotion1) ? surface.motion1 : 0);
  rub(second, has(dContactMu2) ? surface.mu2 : surface.mu, has(dContactSlip2), surface.slip2, has(dContactApprox1_2));
  tree_.mark_touched(touch.a);
  tree_.mark_touched(touch.b);
  touches_.push_back(touch);
}

// One row for each joint that follows another one, between the rates of both.
void TreeContacts::add_mimics(ModelInstance& model) {
  const auto node_of = [&](const JointInstance* joint) { return joint == nullptr ? -1 : tree_.node_of(*joint); };
  for (const auto& mimic : model.mimics()) {
    Row row;
    row.a = node_of(model.joint(mimic.follower)), row.c = node_of(model.joint(mimic.leader));
    if (row.a < 0 || row.c < 0) continue;
    const BodyTree::Node &follower = tree_.at(row.a), &leader = tree_.at(row.c);
    const MimicDef& def = *follower.joint->def().mimic;
    row.b = follower.parent, row.d = leader.parent;
    row.on_a = follower.rows.axis_own(), row.on_b = follower.rows.axis_parent();
    row.on_c = -def.multiplier * leader.rows.axis_own(), row.on_d = -def.multiplier * leader.rows.axis_parent();
    const double wanted = def.multiplier * (leader.joint->state(0).position - def.reference) + def.offset;
    row.target = 0.2 * (wanted - follower.joint->state(0).position) / physics_.step;
    row.give = dWorldGetCFM(world_) / physics_.step;
    row.low = -infinite;
    rows_.push_back(row);
    tree_.mark_touched(row.a);
    tree_.mark_touched(row.c);
  }
  tie_rows_ = rows_.size();
}

// Six rows, as of a joint that cannot move. ODE's joint is switched off with the others.
void TreeContacts::add_weld(Weld& weld) {
  const dBodyID first = weld.first_body(), second = weld.second_body();
  const Eigen::Isometry3d wanted = weld.wanted();
  const Eigen::Vector3d place = ode::vector(dBodyGetPosition(second)), goal = wanted.translation();
  const double correction = dWorldGetERP(world_) / physics_.step;
  const Eigen::Quaterniond off = Eigen::Quaterniond(wanted.linear()) * ode::quaternion(dBodyGetQuaternion(second)).conjugate();
  const Eigen::Vector3d turned = (off.w() < 0 ? -2.0 : 2.0) * off.vec();
  const int node = tree_.node_of(second), other = first != nullptr ? tree_.node_of(first) : -1;
  const auto add_tie = [&](const Vector6& on_second, const Vector6& on_first, double target) {
    Row row;
    row.a = node, row.b = other;
    row.on_a = on_second;
    row.on_b = first != nullptr ? on_first : Vector6(Vector6::Zero());
    row.target = target;
    if (node < 0) row.target -= on_second.dot(velocity_of(second));
    if (other < 0 && first != nullptr) row.target -= on_first.dot(velocity_of(first));
    row.give = dWorldGetCFM(world_) / physics_.step;
    row.low = -infinite;
    rows_.push_back(row);
  };
  const Eigen::Vector3d first_middle = first != nullptr ? ode::vector(dBodyGetPosition(first)) : Eigen::Vector3d(Eigen::Vector3d::Zero());
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d line = Eigen::Vector3d::Unit(i);
    add_tie(wrench(line, {0, 0, 0}), wrench_at(-line, goal - first_middle), correction * (goal - place)[i]);
  }
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d line = Eigen::Vector3d::Unit(i);
    add_tie(wrench({0, 0, 0}, line), wrench({0, 0, 0}, -line), correction * turned[i]);
  }
  tree_.mark_touched(node);
  tree_.mark_touched(other);
  tie_rows_ = rows_.size();
}

// --- their solution

double TreeContacts::motion(const Row& row) const {
  return (row.a >= 0 ? row.on_a.dot(tree_.at(row.a).velocity) : 0) + (row.b >= 0 ? row.on_b.dot(tree_.at(row.b).velocity) : 0) +
         (row.c >= 0 ? row.on_c.dot(tree_.at(row.c).velocity) : 0) + (row.d >= 0 ? row.on_d.dot(tree_.at(row.d).velocity) : 0);
}

bool TreeContacts::solve(bool is_first) {
  ask_tree(is_first);
  return rub_and_press();
}

void TreeContacts::ask_tree(bool is_first) {
  const auto count = static_cast<Eigen::Index>(rows_.size());
  bounds_ = system_.bounds;
  system_.resize(count);
  if (!is_first) system_.bounds = bounds_;
  if (count == 0) return;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Row& row = rows_[static_cast<std::size_t>(i)];
    system_.b[i] = row.target - motion(row);
    system_.low[i] = row.low, system_.high[i] = row.high;
  }
  tree_.clear_touched();
  for (Eigen::Index i = 0; i < count; ++i) fill_column(i);
}

// What an impulse on one row does to the velocities of all.
void TreeContacts::fill_column(Eigen::Index column) {
  const Row& row = rows_[static_cast<std::size_t>(column)];
  swept_.clear();
  const auto push = [&](int node, const Vector6& on) {
    if (node < 0) return;
    tree_.at(node).impulse += on;
    if (std::find(swept_.begin(), swept_.end(), tree_.at(node).tree) == swept_.end()) swept_.push_back(tree_.at(node).tree);
  };
  push(row.a, row.on_a);
  push(row.b, row.on_b);
  push(row.c, row.on_c);
  push(row.d, row.on_d);
  tree_.sweep_touched(swept_);
  const auto is_moved = [&](int node) { return node >= 0 && std::find(swept_.begin(), swept_.end(), tree_.at(node).tree) != swept_.end(); };
  for (Eigen::Index k = 0; k < system_.a.rows(); ++k) {
    const Row& other = rows_[static_cast<std::size_t>(k)];
    const bool is_answered = is_moved(other.a) || is_moved(other.b) || is_moved(other.c) || is_moved(other.d);
    system_.a(k, column) = is_answered ? motion(other) : 0;
  }
  system_.a(column, column) += row.give;
  tree_.clear_touched(swept_);
}

// Friction is bounded by what presses: found without it first, then again until it presses as it was taken to.
bool TreeContacts::rub_and_press() {
  constexpr int most_rounds = 12;
  const auto count = static_cast<Eigen::Index>(rows_.size());
  if (count == 0) return true;
  const auto set_bounds = [&](bool has_pressed) {
    double change = 0, most = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const Row& row = rows_[static_cast<std::size_t>(i)];
      if (row.normal < 0) continue;
      const double bound = has_pressed ? row.friction * std::max(system_.x[row.normal], 0.0) : 0;
      change = std::max(change, std::abs(bound - system_.high[i]));
      most = std::max(most, bound);
      system_.low[i] = -bound, system_.high[i] = bound;
    }
    return change > 1e-7 * most;
  };
  set_bounds(false);
  for (int round = 0; round < most_rounds; ++round) {
    if (!system_.solve()) return false;
    if (!set_bounds(true)) break;
  }
  return true;
}

void TreeContacts::press(const Row& row, double impulse) const {
  if (row.a >= 0) tree_.at(row.a).impulse += row.on_a * impulse;
  if (row.b >= 0) tree_.at(row.b).impulse += row.on_b * impulse;
  if (row.c >= 0) tree_.at(row.c).impulse += row.on_c * impulse;
  if (row.d >= 0) tree_.at(row.d).impulse += row.on_d * impulse;
}

void TreeContacts::press() const {
  for (std::size_t i = 0; i < rows_.size(); ++i) press(rows_[i], system_.x[static_cast<Eigen::Index>(i)]);
}

void TreeContacts::press_and_tell() const {
  press();
  const double per_step = 1 / physics_.step;
  for (const Touch& touch : touches_) {
    dJointDisable(touch.contact->joint);
    if (touch.contact->feedback == nullptr) continue;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < touch.count; ++i)
      force += per_step * system_.x[static_cast<Eigen::Index>(touch.first + i)] * touch.lines[i];
    for (int i = 0; i < 3; ++i) touch.contact->feedback->f1[i] = force[i], touch.contact->feedback->f2[i] = -force[i];
  }
}

}  // namespace sim
