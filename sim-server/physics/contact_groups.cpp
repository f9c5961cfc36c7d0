#include "physics/contact_groups.h"

#include <algorithm>

namespace sim {
namespace {

// As ODE makes them.
std::uint32_t rows_of(const dSurfaceParameters& surface) {
  const double mu2 = (surface.mode & dContactMu2) != 0 ? surface.mu2 : surface.mu;
  return 1U + (surface.mu > 0 ? 1U : 0U) + (mu2 > 0 ? 1U : 0U);
}

}  // namespace

void ContactGroups::add(ModelInstance& model) {
  const auto place = static_cast<std::uint32_t>(members_.size());
  model.group_place = place;
  Member member;
  member.model = &model;
  member.parent = place;
  member.size = {.bodies = model.moving_body_count(),
                 .joint_rows = model.joint_rows(),
                 .has_many_joints = model.is_for_tree(),
                 .has_trees_only = model.tree().is_one,
                 .lightest = model.mass(),
                 .heaviest = model.mass(),
                 .mass = model.mass()};
  members_.push_back(member);
}

std::uint32_t ContactGroups::root(std::uint32_t i) {
  while (members_[i].parent != i) i = members_[i].parent = members_[members_[i].parent].parent;
  return i;
}

void ContactGroups::touch(ModelInstance& a, ModelInstance* b, bool has_mesh, double depth, const dSurfaceParameters& surface) {
  constexpr double deep = 5e-4;  // [m]: not at rest yet, however slowly it comes out
  constexpr double soft = 0.1;   // of mass / step^2: a stiffness below which a contact is a spring, which gives back what it took
  ++contacts_;
  Member& group = members_[root(a.group_place)];
  ++group.contacts;
  group.size.contact_rows += rows_of(surface);
  group.has_mesh = group.has_mesh || has_mesh;
  group.is_deep = group.is_deep || depth > deep;
  has_mesh_ = has_mesh_ || has_mesh;
  const double lighter = b != nullptr ? std::min(a.mass(), b->mass()) : a.mass();
  if ((surface.mode & dContactSoftCFM) != 0 && surface.soft_erp < soft * lighter / physics_.step * surface.soft_cfm) group.is_exempt = true;
  if (b == nullptr) return;
  ++group.size.moving_contacts;
  join(a, *b);
}

void ContactGroups::tie(ModelInstance& a, ModelInstance& b) {
  constexpr std::uint32_t rows_of_weld = 6;
  members_[root(a.group_place)].size.joint_rows += rows_of_weld;
  join(a, b);
}

void ContactGroups::join(const ModelInstance& a, const ModelInstance& b) {
  const auto i = root(a.group_place), k = root(b.group_place);
  if (i == k) return;
  Member &kept = members_[std::min(i, k)], &joined = members_[std::max(i, k)];
  joined.parent = std::min(i, k);
  kept.has_mesh = kept.has_mesh || joined.has_mesh;
  kept.is_exempt = kept.is_exempt || joined.is_exempt;
  kept.is_deep = kept.is_deep || joined.is_deep;
  kept.contacts += joined.contacts;
  kept.size += joined.size;
}

void ContactGroups::share_out() {
  for (std::uint32_t i = 0; i < members_.size(); ++i) {
    const SolverChoice choice = choose_solver(physics_, members_[root(i)].size);
    ModelInstance& model = *members_[i].model;
    model.is_iterative = choice.is_iterative;
    model.is_tree_solved = choice.is_tree_solved;
  }
}

void ContactGroups::keep_energies() {
  if (!has_mesh_) return;
  for (std::uint32_t i = 0; i < members_.size(); ++i) {
    Member& group = members_[root(i)];
    if (!group.has_mesh) continue;
    members_[i].energy = members_[i].model->energy(physics_.gravity).sum();
    group.is_exempt = group.is_exempt || members_[i].model->is_driven();
    note_pushes(i);
  }
}

void ContactGroups::note_pushes(std::uint32_t member) {
  const ModelInstance& model = *members_[member].model;
  for (std::uint32_t k = 0; k < model.body_count(); ++k) {
    const dBodyID body = model.body(k);
    if (body == nullptr) continue;
    const Eigen::Vector3d force = ode::vector(dBodyGetForce(body)), torque = ode::vector(dBodyGetTorque(body));
    if (force.isZero(0) && torque.isZero(0)) continue;
    pushes_.push_back({body, member, force, torque, ode::vector(dBodyGetLinearVel(body)), ode::vector(dBodyGetAngularVel(body))});
  }
}

double ContactGroups::Push::work(double dt) const {
  const Eigen::Vector3d way = ode::vector(dBodyGetLinearVel(body)) + linear, turn = ode::vector(dBodyGetAngularVel(body)) + angular;
  return dt / 2 * (force.dot(way) + torque.dot(turn));
}

void ContactGroups::limit_energies() {
  if (has_mesh_) slow_down_what_gained();
}

void ContactGroups::slow_down_what_gained() {
  for (std::uint32_t i = 0; i < members_.size(); ++i) {
    Member& group = members_[root(i)];
    if (!group.has_mesh || group.is_exempt) continue;
    const Energy now = members_[i].model->energy(physics_.gravity);
    group.gained += now.sum() - members_[i].energy;
    group.motion += now.motion;
  }
  for (const Push& push : pushes_) members_[root(push.member)].work += push.work(physics_.step);
  for (std::uint32_t i = 0; i < members_.size(); ++i) {
    const Member& group = members_[root(i)];
    const double too_much = group.gained - std::max(group.work, 0.0);
    if (too_much > 0 && group.motion > 0) members_[i].model->slow_down(std::sqrt(std::max(1 - too_much / group.motion, 0.0)));
  }
}

void ContactGroups::settle() {
  for (std::uint32_t i = 0; i < members_.size(); ++i) {
    Member& group = members_[root(i)];
    const bool is_still = members_[i].model->lies_still(physics_.step, group.contacts > 0 && !group.is_deep);
    // What the limit of energies lets out of a mesh moves without a velocity.
    group.may_sleep = group.may_sleep && is_still && !(group.is_deep && group.has_mesh);
  }
  for (std::uint32_t i = 0; i < members_.size(); ++i) {
    if (members_[root(i)].may_sleep) members_[i].model->sleep();
  }
}

void ContactGroups::note_loads() {
  for (std::uint32_t i = 0; i < members_.size(); ++i) {
    const GroupSize& group = members_[root(i)].size;
    members_[i].model->load_near = group.is_uneven() ? group.mass : 0;
  }
}

void ContactGroups::clear() {
  members_.clear();
  pushes_.clear();
  has_mesh_ = false;
  contacts_ = 0;
}

}  // namespace sim
