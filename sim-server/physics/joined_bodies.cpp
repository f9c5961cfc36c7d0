#include "physics/joined_bodies.h"

#include <algorithm>

namespace sim {
namespace {

constexpr std::size_t max_bodies = 60;

Eigen::Matrix3d inverse_inertia(dBodyID body, const dMass& mass) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> inertia(mass.I);
  const Eigen::Matrix3d turn = ode::quaternion(dBodyGetQuaternion(body)).toRotationMatrix();
  return turn * inertia.leftCols<3>().inverse() * turn.transpose();
}

Eigen::Vector3d anchor_of(dJointID joint) {
  dVector3 place = {0, 0, 0};
  const int type = dJointGetType(joint);
  if (type == dJointTypeBall) dJointGetBallAnchor(joint, place);
  if (type == dJointTypeHinge) dJointGetHingeAnchor(joint, place);
  if (type == dJointTypeUniversal) dJointGetUniversalAnchor(joint, place);
  return ode::vector(place);
}

std::pair<Eigen::Vector3d, Eigen::Vector3d> plane_of(const dReal* normal) {
  dVector3 p, q;
  dPlaneSpace(normal, p, q);
  return {ode::vector(p), ode::vector(q)};
}

}  // namespace

JoinedBodies::JoinedBodies(dBodyID first) : bodies_{first} {
  std::vector<dJointID> joints;
  for (std::size_t i = 0; i < bodies_.size() && are_known_; ++i) {
    for (int j = 0; j < dBodyGetNumJoints(bodies_[i]); ++j) {
      const dJointID joint = dBodyGetJoint(bodies_[i], j);
      if (dJointGetType(joint) == dJointTypeContact || std::find(joints.begin(), joints.end(), joint) != joints.end()) continue;
      joints.push_back(joint);
      for (const int end : {0, 1}) {
        const dBodyID body = dJointGetBody(joint, end);
        if (is_pushable(body) && place_of(body) < 0) bodies_.push_back(body);
      }
    }
    are_known_ = bodies_.size() <= max_bodies;
  }
  if (!are_known_) return;
  for (const dBodyID body : bodies_) {
    dMass mass;
    dBodyGetMass(body, &mass);
    inverse_masses_.push_back(1 / mass.mass);
    inverse_inertias_.push_back(inverse_inertia(body, mass));
  }
  for (const dJointID joint : joints) add_rows(joint);
  const auto count = static_cast<Eigen::Index>(rows_.size());
  Eigen::MatrixXd locked(count, count);
  for (const auto& row : rows_) answers_.push_back(freely(row));
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index k = 0; k < count; ++k) locked(i, k) = rows_[static_cast<std::size_t>(i)].dot(answers_[static_cast<std::size_t>(k)]);
  }
  // Of joints that close a loop some rows say the same.
  if (count > 0) locked.diagonal().array() += 1e-12 * locked.diagonal().maxCoeff();
  if (count > 0) locked_.compute(locked);
}

int JoinedBodies::place_of(dBodyID body) const {
  const auto found = std::find(bodies_.begin(), bodies_.end(), body);
  return found == bodies_.end() ? -1 : static_cast<int>(found - bodies_.begin());
}

void JoinedBodies::add_rows(dJointID joint) {
  const int type = dJointGetType(joint);
  const Eigen::Vector3d anchor = anchor_of(joint);
  if (type == dJointTypeBall || type == dJointTypeHinge || type == dJointTypeUniversal) {
    for (int i = 0; i < 3; ++i) add_row(joint, Eigen::Vector3d::Unit(i), anchor);
  }
  dVector3 axis, other;
  switch (type) {
    case dJointTypeBall:
      break;
    case dJointTypeHinge: {
      dJointGetHingeAxis(joint, axis);
      const auto [p, q] = plane_of(axis);
      add_turn_row(joint, p);
      add_turn_row(joint, q);
      break;
    }
    case dJointTypeUniversal:
      dJointGetUniversalAxis1(joint, axis);
      dJointGetUniversalAxis2(joint, other);
      add_turn_row(joint, ode::vector(axis).cross(ode::vector(other)));
      break;
    case dJointTypeFixed:
    case dJointTypeSlider: {
      for (int i = 0; i < 3; ++i) add_turn_row(joint, Eigen::Vector3d::Unit(i));
      const dBodyID body = dJointGetBody(joint, 0) != nullptr ? dJointGetBody(joint, 0) : dJointGetBody(joint, 1);
      const Eigen::Vector3d place = ode::vector(dBodyGetPosition(body));
      if (type == dJointTypeFixed) {
        for (int i = 0; i < 3; ++i) add_row(joint, Eigen::Vector3d::Unit(i), place);
        break;
      }
      dJointGetSliderAxis(joint, axis);
      const auto [p, q] = plane_of(axis);
      add_row(joint, p, place);
      add_row(joint, q, place);
      break;
    }
    default:
      are_known_ = false;
  }
}

void JoinedBodies::add_row(dJointID joint, const Eigen::Vector3d& line, const Eigen::Vector3d& place) {
  const auto half = [&](int end, double sign) {
    Vector6 out = Vector6::Zero();
    const dBodyID body = dJointGetBody(joint, end);
    if (body != nullptr) out << sign * line, sign * (place - ode::vector(dBodyGetPosition(body))).cross(line);
    return out;
  };
  add_halves(joint, half(0, 1), half(1, -1));
}

void JoinedBodies::add_turn_row(dJointID joint, const Eigen::Vector3d& line) {
  Vector6 turn = Vector6::Zero();
  turn.tail<3>() = line;
  add_halves(joint, turn, -turn);
}

void JoinedBodies::add_halves(dJointID joint, const Vector6& first, const Vector6& second) {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(bodies_.size()));
  for (const int end : {0, 1}) {
    const int place = place_of(dJointGetBody(joint, end));
    if (place >= 0) row.segment<6>(6 * place) = end == 0 ? first : second;
  }
  rows_.push_back(row);
}

Eigen::VectorXd JoinedBodies::freely(const Eigen::VectorXd& impulses) const {
  Eigen::VectorXd out(impulses.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const auto at = 6 * static_cast<Eigen::Index>(i);
    out.segment<3>(at) = inverse_masses_[i] * impulses.segment<3>(at);
    out.segment<3>(at + 3) = inverse_inertias_[i] * impulses.segment<3>(at + 3);
  }
  return out;
}

Eigen::VectorXd JoinedBodies::response(const Eigen::VectorXd& impulses) const {
  Eigen::VectorXd out = freely(impulses);
  if (rows_.empty()) return out;
  Eigen::VectorXd open(static_cast<Eigen::Index>(rows_.size()));
  for (std::size_t i = 0; i < rows_.size(); ++i) open[static_cast<Eigen::Index>(i)] = rows_[i].dot(out);
  const Eigen::VectorXd held = locked_.solve(open);
  for (std::size_t i = 0; i < rows_.size(); ++i) out -= held[static_cast<Eigen::Index>(i)] * answers_[i];
  return out;
}

}  // namespace sim
