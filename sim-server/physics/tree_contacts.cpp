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
  Push &on_a = made.pushes[0], &on_b = made.pushes[1];
  on_a = {touch.a, wrench_at(line, place - ode::vector(dBodyGetPosition(contact.a)))};
  if (contact.b != nullptr) on_b = {touch.b, wrench_at(-line, place - ode::vector(dBodyGetPosition(contact.b)))};
  made.give = row.give / physics_.step;
  // Bodies that nothing can move go on as they do.
  if (touch.a < 0) made.target -= on_a.on.dot(velocity_of(contact.a));
  if (touch.b < 0 && contact.b != nullptr) made.target -= on_b.on.dot(velocity_of(contact.b));
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
    const int follows = node_of(model.joint(mimic.follower)), leads = node_of(model.joint(mimic.leader));
    if (follows < 0 || leads < 0) continue;
    const BodyTree::Node &follower = tree_.at(follows), &leader = tree_.at(leads);
    const MimicDef& def = *follower.joint->def().mimic;
    Row row;
    row.pushes = {{{follows, follower.rows.axis_own()},
                   {follower.parent, follower.rows.axis_parent()},
                   {leads, -def.multiplier * leader.rows.axis_own()},
                   {leader.parent, -def.multiplier * leader.rows.axis_parent()}}};
    const double wanted = def.multiplier * (leader.joint->state(0).position - def.reference) + def.offset;
    row.target = 0.2 * (wanted - follower.joint->state(0).position) / physics_.step;
    row.give = dWorldGetCFM(world_) / physics_.step;
    row.low = -infinite;
    rows_.push_back(row);
    tree_.mark_touched(follows);
    tree_.mark_touched(leads);
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
    row.pushes[0] = {node, on_second};
    row.pushes[1] = {other, on_first};
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
  double sum = 0;
  for (const Push& push : row.pushes) {
    if (push.node >= 0) sum += push.on.dot(tree_.at(push.node).velocity);
  }
  return sum;
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
    system_.a(i, i) = row.give;
    // Friction is 0 first, and then on the side that the bodies ask for.
    if (is_first && row.normal >= 0) system_.bounds[static_cast<std::size_t>(i)] = system_.b[i] > 0 ? Bound::high : Bound::low;
  }
  if (is_first) gather_acts();
  tree_.prepare_answers();
  for (std::size_t i = 0; i < acted_count_; ++i) {
    for (std::size_t k = 0; k <= i; ++k) add_answers(acted_[i], acted_[k]);
  }
  system_.a.triangularView<Eigen::StrictlyUpper>() = system_.a.transpose();
}

void TreeContacts::gather_acts() {
  acted_count_ = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    for (const Push& push : rows_[i].pushes) {
      if (push.node < 0) continue;
      const auto end = acted_.begin() + static_cast<std::ptrdiff_t>(acted_count_);
      auto acted = std::find_if(acted_.begin(), end, [&](const Acted& one) { return one.node == push.node; });
      if (acted == end) {
        if (acted_count_ == acted_.size()) acted_.emplace_back();
        acted = acted_.begin() + static_cast<std::ptrdiff_t>(acted_count_++);
        acted->node = push.node;
        acted->acts.clear();
      }
      acted->acts.push_back({static_cast<Eigen::Index>(i), push.on});
    }
  }
}

// What impulses on one node do to the rows at another, or at the same one, and these to them. Only the lower half is filled.
void TreeContacts::add_answers(const Acted& at, const Acted& from) {
  if (tree_.at(at.node).root != tree_.at(from.node).root) return;
  const bool is_same = &at == &from;
  const Matrix6 answer = tree_.answer(at.node, from.node);
  for (const Act& push : from.acts) {
    const Vector6 velocity = answer.lazyProduct(push.on);
    for (const Act& row : at.acts) {
      if (is_same && row.row < push.row) continue;
      const double motion = row.on.dot(velocity);
      system_.a(std::max(row.row, push.row), std::min(row.row, push.row)) += !is_same && row.row == push.row ? 2 * motion : motion;
    }
  }
}

// Friction is bounded by what presses: found without it first, then again until it presses as it was taken to.
bool TreeContacts::rub_and_press() {
  constexpr int max_rounds = 12;
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
  for (int round = 0; round < max_rounds; ++round) {
    if (!system_.solve()) return false;
    if (!set_bounds(true)) break;
  }
  return true;
}

void TreeContacts::press() const {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    for (const Push& push : rows_[i].pushes) {
      if (push.node >= 0) tree_.at(push.node).impulse += push.on * system_.x[static_cast<Eigen::Index>(i)];
    }
  }
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
