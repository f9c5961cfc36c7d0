#include "physics/tree_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "physics/weld.h"

namespace sim {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Vector6 wrench(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) {
  Vector6 out;
  out << linear, angular;
  return out;
}

// Of a force along `line` at `arm` from the middle of a body.
Vector6 wrench_at(const Eigen::Vector3d& line, const Eigen::Vector3d& arm) { return wrench(line, arm.cross(line)); }

Vector6 velocity_of(dBodyID body) { return wrench(ode::vector(dBodyGetLinearVel(body)), ode::vector(dBodyGetAngularVel(body))); }

std::pair<Eigen::Vector3d, Eigen::Vector3d> plane_of(const Eigen::Vector3d& axis) {
  dVector3 p, q;
  const dVector3 n = {axis.x(), axis.y(), axis.z()};
  dPlaneSpace(n, p, q);
  return {ode::vector(p), ode::vector(q)};
}

// The seat of a joint in the world, and the middle of its body.
struct Seated {
  Eigen::Vector3d middle{0, 0, 0}, place, axis;
  Eigen::Quaterniond turn;
};
Seated seated(dBodyID body, const JointSeat& seat) {
  if (body == nullptr) return {{0, 0, 0}, seat.place, seat.axis, seat.turn};
  const Eigen::Vector3d middle = ode::vector(dBodyGetPosition(body));
  const Eigen::Quaterniond q = ode::quaternion(dBodyGetQuaternion(body));
  return {middle, middle + q * seat.place, q * seat.axis, q * seat.turn};
}

// As ODE has them, implicit.
Eigen::Vector3d gyroscopic_torque(const Eigen::Matrix3d& inertia, const Eigen::Vector3d& turning, double dt) {
  const Eigen::Vector3d momentum = inertia * turning;
  const Eigen::Matrix3d effective = inertia - dt * cross_matrix(momentum);
  return (inertia * effective.inverse() - Eigen::Matrix3d::Identity()) * momentum / dt;
}

double parameter(dJointID joint, int which) {
  return dJointGetType(joint) == dJointTypeSlider ? dJointGetSliderParam(joint, which) : dJointGetHingeParam(joint, which);
}

}  // namespace

// --- what the step is made of

void TreeSolver::add_model(ModelInstance& model) {
  const auto first = static_cast<int>(nodes_.size());
  const double dt = physics_.step;
  for (const auto& place : model.tree().places) {
    const dBodyID body = model.body(place.assembly);
    Node node;
    node.body = body;
    if (dBodyIsKinematic(body) != 0) continue;  // alone: those have no joints
    node.parent = place.parent < 0 ? -1 : first + place.parent;
    node.joint = place.joint < 0 ? nullptr : &model.joints()[static_cast<std::size_t>(place.joint)];
    node.is_child = place.is_child;
    dMass mass;
    dBodyGetMass(body, &mass);
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> own(mass.I);
    const Eigen::Matrix3d turn = ode::quaternion(dBodyGetQuaternion(body)).toRotationMatrix();
    const Eigen::Matrix3d inertia = turn * own.leftCols<3>() * turn.transpose();
    node.mass.setZero();
    node.mass.diagonal().head<3>().setConstant(mass.mass);
    node.mass.bottomRightCorner<3, 3>() = inertia;
    Eigen::Vector3d force = ode::vector(dBodyGetForce(body)), torque = ode::vector(dBodyGetTorque(body));
    if (dBodyGetGravityMode(body) != 0) force += mass.mass * physics_.gravity;
    const Vector6 velocity = velocity_of(body);
    if (dBodyGetGyroscopicMode(body) != 0) torque += gyroscopic_torque(inertia, velocity.tail<3>(), dt);
    node.momentum = node.mass * velocity + dt * wrench(force, torque);
    places_.emplace_back(body, static_cast<int>(nodes_.size()));
    if (node.joint != nullptr) add_joint(node);
    nodes_.push_back(std::move(node));
  }
}

int TreeSolver::node_of(dBodyID body) const {
  const auto found = std::lower_bound(places_.begin(), places_.end(), body, [](const auto& place, dBodyID b) { return place.first < b; });
  return found != places_.end() && found->first == body ? found->second : -1;
}

void TreeSolver::add_row(Node& node, const Vector6& on_child, const Vector6& on_parent, double target, double give, double low,
                         double high) {
  Row row;
  row.own = node.is_child ? on_child : on_parent;
  row.parent = node.is_child ? on_parent : on_child;
  row.target = target;
  row.give = give / physics_.step;
  row.low = low * physics_.step, row.high = high * physics_.step;
  node.rows.push_back(row);
}

void TreeSolver::add_joint(Node& node) {
  const JointInstance& joint = *node.joint;
  const dBodyID first = dJointGetBody(joint.id(), 0), second = dJointGetBody(joint.id(), 1);
  // ODE has the child first, unless only the parent has a body.
  const dBodyID child = node.is_child ? node.body : (first == node.body ? second : first);
  const dBodyID parent = node.is_child ? (first == node.body ? second : first) : node.body;
  const Seated on_child = seated(child, joint.seat_on_child()), on_parent = seated(parent, joint.seat_on_parent());
  const double correction = dWorldGetERP(world_) / physics_.step, give = dWorldGetCFM(world_);
  const auto equal = [&](const Vector6& c, const Vector6& p, double target) { add_row(node, c, p, target, give, -infinite, infinite); };
  const auto turn_row = [&](const Eigen::Vector3d& line, double target) {
    equal(wrench({0, 0, 0}, line), wrench({0, 0, 0}, -line), target);
  };
  const Eigen::Vector3d apart = on_parent.place - on_child.place;
  const int type = dJointGetType(joint.id());
  if (type != dJointTypeSlider) {
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d line = Eigen::Vector3d::Unit(i);
      equal(wrench_at(line, on_child.place - on_child.middle), wrench_at(-line, on_parent.place - on_parent.middle), correction * apart[i]);
    }
  }
  if (type == dJointTypeSlider || type == dJointTypeFixed) {
    const Eigen::Quaterniond off = on_parent.turn * on_child.turn.conjugate();
    const Eigen::Vector3d turned = (off.w() < 0 ? -2.0 : 2.0) * off.vec();
    for (int i = 0; i < 3; ++i) turn_row(Eigen::Vector3d::Unit(i), correction * turned[i]);
  }
  const auto [p, q] = plane_of(on_child.axis);
  const Eigen::Vector3d child_arm = on_child.place - on_child.middle, parent_arm = on_child.place - on_parent.middle;
  if (type == dJointTypeHinge) {
    const Eigen::Vector3d lean = on_child.axis.cross(on_parent.axis);
    turn_row(p, correction * p.dot(lean));
    turn_row(q, correction * q.dot(lean));
    add_axis(node, wrench({0, 0, 0}, on_child.axis), wrench({0, 0, 0}, -on_child.axis));
  } else if (type == dJointTypeSlider) {
    for (const auto& line : {p, q}) equal(wrench_at(line, child_arm), wrench_at(-line, parent_arm), correction * line.dot(apart));
    add_axis(node, wrench_at(on_child.axis, child_arm), wrench_at(-on_child.axis, parent_arm));
  }
}

// The motor and the stops of a joint with one axis, in ODE's sense.
void TreeSolver::add_axis(Node& node, const Vector6& of_child, const Vector6& of_parent) {
  const dJointID joint = node.joint->id();
  node.axis_own = node.is_child ? of_child : of_parent;
  node.axis_parent = node.is_child ? of_parent : of_child;
  const Vector6 on_child = node.joint->sign() * of_child, on_parent = node.joint->sign() * of_parent;
  const bool slides = dJointGetType(joint) == dJointTypeSlider;
  const double low = parameter(joint, dParamLoStop), high = parameter(joint, dParamHiStop);
  bool is_locked = false;
  if ((slides ? std::isfinite(low) || std::isfinite(high) : low >= -M_PI || high <= M_PI) && low <= high) {
    const double position = slides ? dJointGetSliderPosition(joint) : dJointGetHingeAngle(joint);
    const bool is_low = position <= low;
    if (is_low || position >= high) {
      is_locked = low == high;
      const double correction = parameter(joint, dParamStopERP) / physics_.step;
      add_row(node, on_child, on_parent, -correction * (position - (is_low ? low : high)), parameter(joint, dParamStopCFM),
              is_low && !is_locked ? 0 : -infinite, is_low || is_locked ? infinite : 0);
    }
  }
  const double effort = parameter(joint, dParamFMax);
  if (!(effort > 0) || is_locked) return;
  add_row(node, on_child, on_parent, parameter(joint, dParamVel), parameter(joint, dParamCFM), -effort, effort);
  // Begins where it was in the last step: a motor at its limit is there for many steps.
  node.motor_row = static_cast<int>(node.rows.size()) - 1;
  Row& motor = node.rows.back();
  motor.bound = node.joint->motor_bound;
  if (!motor.is_free()) motor.impulse = motor.bound == Bound::low ? motor.low : motor.high;
}

void TreeSolver::add_contact_row(Touch& touch, const Eigen::Vector3d& line, const ContactRow& row) {
  const MadeContact& contact = *touch.contact;
  const Eigen::Vector3d place = ode::vector(contact.contact.geom.pos);
  ContactRow made = row;
  made.a = touch.a, made.b = touch.b;
  made.on_a = wrench_at(line, place - ode::vector(dBodyGetPosition(contact.a)));
  made.on_b.setZero();
  if (contact.b != nullptr) made.on_b = wrench_at(-line, place - ode::vector(dBodyGetPosition(contact.b)));
  made.give = row.give / physics_.step;
  // Bodies that nothing can move go on as they do.
  if (touch.a < 0) made.target -= made.on_a.dot(velocity_of(contact.a));
  if (touch.b < 0 && contact.b != nullptr) made.target -= made.on_b.dot(velocity_of(contact.b));
  touch.rows.push_back(rows_.size());
  touch.lines.push_back(line);
  rows_.push_back(made);
}

void TreeSolver::add_contact(const MadeContact& made) {
  const dSurfaceParameters& surface = made.contact.surface;
  Touch touch;
  touch.contact = &made;
  touch.a = node_of(made.a), touch.b = made.b != nullptr ? node_of(made.b) : -1;
  const auto has = [&](int flag) { return (surface.mode & flag) != 0; };
  const Eigen::Vector3d normal = ode::vector(made.contact.geom.normal);
  const double give = has(dContactSoftCFM) ? surface.soft_cfm : dWorldGetCFM(world_);
  const double correction = (has(dContactSoftERP) ? surface.soft_erp : dWorldGetERP(world_)) / physics_.step;
  ContactRow push;
  push.give = give;
  push.target = std::min(correction * made.contact.geom.depth, dWorldGetContactMaxCorrectingVel(world_));
  if (has(dContactBounce) && surface.bounce_vel >= 0) {
    dVector3 at_a, at_b = {0, 0, 0};
    const dReal* pos = made.contact.geom.pos;
    dBodyGetPointVel(made.a, pos[0], pos[1], pos[2], at_a);
    if (made.b != nullptr) dBodyGetPointVel(made.b, pos[0], pos[1], pos[2], at_b);
    const double outgoing = normal.dot(ode::vector(at_a) - ode::vector(at_b));
    if (-outgoing > surface.bounce_vel) push.target = std::max(push.target, -surface.bounce * outgoing);
  }
  const auto normal_row = static_cast<int>(rows_.size());
  add_contact_row(touch, normal, push);
  auto [first, second] = plane_of(normal);
  if (has(dContactFDir1)) first = ode::vector(made.contact.fdir1), second = normal.cross(first);
  const auto rub = [&](const Eigen::Vector3d& line, double mu, bool has_slip, double slip, bool is_of_normal, double motion = 0) {
    if (!(mu > 0)) return;
    ContactRow row;
    row.target = motion;
    row.give = has_slip ? slip : dWorldGetCFM(world_);
    const bool is_bounded = mu != dInfinity;
    row.low = is_bounded ? -mu * physics_.step : -infinite, row.high = -row.low;
    if (is_bounded && is_of_normal) row.normal = normal_row, row.friction = mu;
    add_contact_row(touch, line, row);
  };
  rub(first, surface.mu, has(dContactSlip1), surface.slip1, has(dContactApprox1_1), has(dContactMotion1) ? surface.motion1 : 0);
  rub(second, has(dContactMu2) ? surface.mu2 : surface.mu, has(dContactSlip2), surface.slip2, has(dContactApprox1_2));
  mark_touched(touch.a);
  mark_touched(touch.b);
  touches_.push_back(std::move(touch));
}

void TreeSolver::mark_touched(int node) {
  for (; node >= 0 && !nodes_[static_cast<std::size_t>(node)].touches; node = nodes_[static_cast<std::size_t>(node)].parent)
    nodes_[static_cast<std::size_t>(node)].touches = true;
}

// One row for each joint that follows another one, between the rates of both.
void TreeSolver::add_mimics(ModelInstance& model, std::size_t first) {
  const auto node_of_joint = [&](const JointInstance* joint) {
    for (std::size_t i = first; i < nodes_.size(); ++i) {
      if (joint != nullptr && nodes_[i].joint == joint) return static_cast<int>(i);
    }
    return -1;
  };
  for (const auto& mimic : model.mimics()) {
    ContactRow row;
    row.a = node_of_joint(model.joint(mimic.follower)), row.c = node_of_joint(model.joint(mimic.leader));
    if (row.a < 0 || row.c < 0) continue;
    const Node &follower = nodes_[static_cast<std::size_t>(row.a)], &leader = nodes_[static_cast<std::size_t>(row.c)];
    const MimicDef& def = *follower.joint->def().mimic;
    row.b = follower.parent, row.d = leader.parent;
    row.on_a = follower.axis_own, row.on_b = follower.axis_parent;
    row.on_c = -def.multiplier * leader.axis_own, row.on_d = -def.multiplier * leader.axis_parent;
    const double wanted = def.multiplier * (leader.joint->state(0).position - def.reference) + def.offset;
    row.target = 0.2 * (wanted - follower.joint->state(0).position) / physics_.step;
    row.give = dWorldGetCFM(world_) / physics_.step;
    row.low = -infinite;
    rows_.push_back(row);
    mark_touched(row.a);
    mark_touched(row.c);
  }
}

// Six rows, as of a joint that cannot move. ODE's joint is switched off with the others.
void TreeSolver::add_weld(Weld& weld) {
  const dBodyID first = weld.first_body(), second = weld.second_body();
  const Eigen::Isometry3d wanted = weld.wanted();
  const Eigen::Vector3d place = ode::vector(dBodyGetPosition(second)), goal = wanted.translation();
  const double correction = dWorldGetERP(world_) / physics_.step;
  const Eigen::Quaterniond off = Eigen::Quaterniond(wanted.linear()) * ode::quaternion(dBodyGetQuaternion(second)).conjugate();
  const Eigen::Vector3d turned = (off.w() < 0 ? -2.0 : 2.0) * off.vec();
  const int node = node_of(second), other = first != nullptr ? node_of(first) : -1;
  const auto add = [&](const Vector6& on_second, const Vector6& on_first, double target) {
    ContactRow row;
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
    add(wrench(line, {0, 0, 0}), wrench_at(-line, goal - first_middle), correction * (goal - place)[i]);
  }
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d line = Eigen::Vector3d::Unit(i);
    add(wrench({0, 0, 0}, line), wrench({0, 0, 0}, -line), correction * turned[i]);
  }
  mark_touched(node);
  mark_touched(other);
}

// --- the tree

// The free rows of the node's joint, side by side.
void TreeSolver::gather(Node& node) {
  const auto count = std::count_if(node.rows.begin(), node.rows.end(), [](const Row& row) { return row.is_free(); });
  node.own.resize(count, 6);
  node.parent_side.resize(count, 6);
  node.target.resize(count);
  Eigen::Index i = 0;
  for (const Row& row : node.rows) {
    if (!row.is_free()) continue;
    node.own.row(i) = row.own.transpose();
    node.parent_side.row(i) = row.parent.transpose();
    node.target[i++] = row.target;
  }
}

void TreeSolver::factor() {
  for (Node& node : nodes_) node.joined = node.mass;
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    node->inverse = node->joined.llt().solve(Matrix6::Identity());
    gather(*node);
    const Eigen::Index count = node->own.rows();
    if (count == 0) continue;
    node->answer.noalias() = node->own * node->inverse;
    FewSquare give = node->answer * node->own.transpose();
    Eigen::Index i = 0;
    for (const Row& row : node->rows) {
      if (row.is_free()) give(i, i) += row.give, ++i;
    }
    node->inverse_give = give.llt().solve(FewSquare::Identity(count, count));
    if (node->parent < 0) continue;
    node->pull.noalias() = node->inverse_give * node->parent_side;
    nodes_[static_cast<std::size_t>(node->parent)].joined.noalias() += node->parent_side.transpose() * node->pull;
  }
}

void TreeSolver::pull_up(Node& node, bool is_homogeneous) {
  if (node.own.rows() == 0) return;
  Few open = -(node.answer * node.impulse);
  if (!is_homogeneous) open += node.target;
  node.share.noalias() = node.inverse_give * open;
  if (node.parent >= 0) nodes_[static_cast<std::size_t>(node.parent)].impulse.noalias() += node.parent_side.transpose() * node.share;
}

void TreeSolver::push_down(Node& node) {
  node.velocity.noalias() = node.inverse * node.impulse;
  if (node.own.rows() == 0) return;
  if (node.parent >= 0) node.share.noalias() -= node.pull * nodes_[static_cast<std::size_t>(node.parent)].velocity;
  node.velocity.noalias() += node.answer.transpose() * node.share;
}

// Velocities of the impulses on the nodes and the targets of the rows.
void TreeSolver::sweep() {
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) pull_up(*node, false);
  for (Node& node : nodes_) push_down(node);
}

// The same without targets, for what leads to contacts alone, and of some trees.
void TreeSolver::sweep_trees(const std::vector<int>& trees) {
  for (const int tree : trees) {
    const auto& places = trees_[static_cast<std::size_t>(tree)];
    for (auto place = places.rbegin(); place != places.rend(); ++place) pull_up(nodes_[static_cast<std::size_t>(*place)], true);
    for (const int place : places) push_down(nodes_[static_cast<std::size_t>(place)]);
  }
}

void TreeSolver::gather_trees() {
  int count = 0;
  for (auto& places : trees_) places.clear();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    node.tree = node.parent < 0 ? count++ : nodes_[static_cast<std::size_t>(node.parent)].tree;
    if (trees_.size() < static_cast<std::size_t>(count)) trees_.emplace_back();
    if (node.touches) trees_[static_cast<std::size_t>(node.tree)].push_back(static_cast<int>(i));
  }
}

// --- contacts on what the tree answers

// `is_first`: of the step; then the rows begin free, else as they were found.
void TreeSolver::solve_contacts(bool is_first) {
  const auto at = [&](int node) -> Node& { return nodes_[static_cast<std::size_t>(node)]; };
  const auto motion = [&](const ContactRow& row) {
    return (row.a >= 0 ? row.on_a.dot(at(row.a).velocity) : 0) + (row.b >= 0 ? row.on_b.dot(at(row.b).velocity) : 0) +
           (row.c >= 0 ? row.on_c.dot(at(row.c).velocity) : 0) + (row.d >= 0 ? row.on_d.dot(at(row.d).velocity) : 0);
  };
  const auto count = static_cast<Eigen::Index>(rows_.size());
  const auto bounds = is_first ? std::vector<Bound>() : system_.bounds;
  system_.resize(count);
  if (!is_first) system_.bounds = bounds;
  if (count == 0) return;
  for (Eigen::Index i = 0; i < count; ++i) {
    const ContactRow& row = rows_[static_cast<std::size_t>(i)];
    system_.b[i] = row.target - motion(row);
    system_.low[i] = row.low, system_.high[i] = row.high;
  }
  const auto clear = [&](const std::vector<int>& trees) {
    for (const int tree : trees) {
      for (const int place : trees_[static_cast<std::size_t>(tree)]) at(place).impulse.setZero(), at(place).velocity.setZero();
    }
  };
  for (Node& node : nodes_) {
    if (node.touches) node.impulse.setZero(), node.velocity.setZero();
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const ContactRow& row = rows_[static_cast<std::size_t>(i)];
    swept_.clear();
    const auto push = [&](int node, const Vector6& on) {
      if (node < 0) return;
      at(node).impulse += on;
      if (std::find(swept_.begin(), swept_.end(), at(node).tree) == swept_.end()) swept_.push_back(at(node).tree);
    };
    push(row.a, row.on_a);
    push(row.b, row.on_b);
    push(row.c, row.on_c);
    push(row.d, row.on_d);
    sweep_trees(swept_);
    const auto is_moved = [&](int node) { return node >= 0 && std::find(swept_.begin(), swept_.end(), at(node).tree) != swept_.end(); };
    for (Eigen::Index k = 0; k < count; ++k) {
      const ContactRow& other = rows_[static_cast<std::size_t>(k)];
      const bool is_answered = is_moved(other.a) || is_moved(other.b) || is_moved(other.c) || is_moved(other.d);
      system_.a(k, i) = is_answered ? motion(other) : 0;
    }
    system_.a(i, i) += row.give;
    clear(swept_);
  }
}

// Friction is bounded by what presses: found without it first, then again until it presses as it was taken to.
bool TreeSolver::rub_and_press() {
  constexpr int most_rounds = 12;
  const auto count = static_cast<Eigen::Index>(rows_.size());
  if (count == 0) return true;
  const auto set_bounds = [&](bool has_pressed) {
    double change = 0, most = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const ContactRow& row = rows_[static_cast<std::size_t>(i)];
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

// --- the step

// What acts on the bodies besides the free rows of joints.
void TreeSolver::load(bool has_contacts) {
  for (Node& node : nodes_) node.impulse = node.momentum;
  for (Node& node : nodes_) {
    for (const Row& row : node.rows) {
      if (row.is_free()) continue;
      node.impulse += row.own * row.impulse;
      if (node.parent >= 0) nodes_[static_cast<std::size_t>(node.parent)].impulse += row.parent * row.impulse;
    }
  }
  for (std::size_t i = 0; has_contacts && i < rows_.size(); ++i) press(rows_[i], system_.x[static_cast<Eigen::Index>(i)]);
}

void TreeSolver::press(const ContactRow& row, double impulse) {
  if (row.a >= 0) nodes_[static_cast<std::size_t>(row.a)].impulse += row.on_a * impulse;
  if (row.b >= 0) nodes_[static_cast<std::size_t>(row.b)].impulse += row.on_b * impulse;
  if (row.c >= 0) nodes_[static_cast<std::size_t>(row.c)].impulse += row.on_c * impulse;
  if (row.d >= 0) nodes_[static_cast<std::size_t>(row.d)].impulse += row.on_d * impulse;
}

// Motors that cannot do what they are to, and stops that need not hold, are at their bounds. False: all are right as they are.
bool TreeSolver::bind_joints(bool one_at_a_time) {
  bool has_changed = false;
  for (Node& node : nodes_) {
    Eigen::Index free = 0;
    for (Row& row : node.rows) {
      double left_over = 0;
      if (row.is_free()) {
        row.impulse = node.share[free++];
      } else {
        left_over = row.own.dot(node.velocity) + row.give * row.impulse - row.target;
        if (node.parent >= 0) left_over += row.parent.dot(nodes_[static_cast<std::size_t>(node.parent)].velocity);
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

bool TreeSolver::is_finite() const {
  return std::all_of(nodes_.begin(), nodes_.end(), [](const Node& node) { return node.velocity.allFinite(); });
}

bool TreeSolver::solve(const std::vector<ModelInstance*>& models, const std::vector<const MadeContact*>& contacts) {
  constexpr int at_once = 10, most_rounds = 40;
  nodes_.clear(), touches_.clear(), rows_.clear(), places_.clear();
  for (auto* model : models) {
    const std::size_t first = nodes_.size();
    add_model(*model);
    add_mimics(*model, first);
  }
  std::sort(places_.begin(), places_.end());
  for (auto* model : models) {
    for (Weld* weld : model->welds) {
      if (weld->is_counted_for(*model)) add_weld(*weld);
    }
  }
  tie_rows_ = rows_.size();
  for (const auto* contact : contacts) add_contact(*contact);
  gather_trees();
  for (int round = 0; round < most_rounds; ++round) {
    factor();
    load(false);
    sweep();
    solve_contacts(round == 0);
    if (!rub_and_press()) return false;
    load(true);
    sweep();
    if (!is_finite()) return false;
    if (bind_joints(round >= at_once)) continue;
    put_forces();
    for (auto* model : models) {
      for (Weld* weld : model->welds) {
        if (weld->is_counted_for(*model)) switch_off(weld->prepare(world_));
      }
    }
    return true;
  }
  return false;
}

void TreeSolver::put_forces() {
  const double per_step = 1 / physics_.step;
  const auto copy = [](const Vector6& from, dReal* force, dReal* torque) {
    for (int i = 0; i < 3; ++i) force[i] = from[i], torque[i] = from[i + 3];
  };
  for (Node& node : nodes_) node.impulse.setZero();
  for (Node& node : nodes_) {
    if (node.joint == nullptr) continue;
    if (node.motor_row >= 0) node.joint->motor_bound = node.rows[static_cast<std::size_t>(node.motor_row)].bound;
    Vector6 own = Vector6::Zero(), parent = Vector6::Zero();
    for (const Row& row : node.rows) own += row.own * row.impulse, parent += row.parent * row.impulse;
    node.impulse += own;
    if (node.parent >= 0) nodes_[static_cast<std::size_t>(node.parent)].impulse += parent;
    const dJointID joint = node.joint->id();
    if (auto* feedback = dJointGetFeedback(joint)) {
      const bool is_first = dJointGetBody(joint, 0) == node.body;
      if (node.parent < 0) parent.setZero();
      copy(per_step * (is_first ? own : parent), feedback->f1, feedback->t1);
      copy(per_step * (is_first ? parent : own), feedback->f2, feedback->t2);
    }
    switch_off(joint);
  }
  for (std::size_t i = 0; i < tie_rows_; ++i) press(rows_[i], system_.x[static_cast<Eigen::Index>(i)]);
  for (const Touch& touch : touches_) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < touch.rows.size(); ++i) {
      const double impulse = system_.x[static_cast<Eigen::Index>(touch.rows[i])];
      press(rows_[touch.rows[i]], impulse);
      force += per_step * impulse * touch.lines[i];
    }
    if (touch.contact->feedback != nullptr) {
      for (int i = 0; i < 3; ++i) touch.contact->feedback->f1[i] = force[i], touch.contact->feedback->f2[i] = -force[i];
    }
    dJointDisable(touch.contact->joint);
  }
  for (const Node& node : nodes_) {
    const Vector6 w = per_step * node.impulse;
    dBodyAddForce(node.body, w[0], w[1], w[2]);
    dBodyAddTorque(node.body, w[3], w[4], w[5]);
  }
}

void TreeSolver::switch_off(dJointID joint) {
  dJointDisable(joint);
  switched_off_.push_back(joint);
}

void TreeSolver::let_go() {
  for (const dJointID joint : switched_off_) dJointEnable(joint);
  switched_off_.clear();
}

}  // namespace sim
