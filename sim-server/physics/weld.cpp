#include "physics/weld.h"

#include "physics/model_instance.h"

namespace sim {
namespace {

void put_body(dBodyID body, const Eigen::Vector3d& place, const Eigen::Quaterniond& turn) {
  const dQuaternion q = {turn.w(), turn.x(), turn.y(), turn.z()};
  dBodySetPosition(body, place.x(), place.y(), place.z());
  dBodySetQuaternion(body, q);
}

}  // namespace

Weld::Weld(ModelInstance& first, std::uint32_t first_assembly, ModelInstance& second, std::uint32_t second_assembly)
    : first_(&first), second_(&second), first_assembly_(first_assembly), second_assembly_(second_assembly) {
  second_in_first_ = first_->assembly_pose(first_assembly_).inverse() * second_->assembly_pose(second_assembly_);
}

bool Weld::joins(ModelId a, std::uint32_t a_assembly, ModelId b, std::uint32_t b_assembly) const {
  const auto is_first = [&](ModelId model, std::uint32_t assembly) { return model == first_->id() && assembly == first_assembly_; };
  const auto is_second = [&](ModelId model, std::uint32_t assembly) { return model == second_->id() && assembly == second_assembly_; };
  return (is_first(a, a_assembly) && is_second(b, b_assembly)) || (is_first(b, b_assembly) && is_second(a, a_assembly));
}

dBodyID Weld::first_body() const { return first_->body_count() == 0 ? nullptr : first_->body(first_assembly_); }
dBodyID Weld::second_body() const { return second_->body(second_assembly_); }

Eigen::Isometry3d Weld::wanted() const { return first_->assembly_pose(first_assembly_) * second_in_first_; }

dJointID Weld::prepare(dWorldID world) {
  const dBodyID first = first_body(), second = second_body();
  const bool is_there =
      joint_.id() != nullptr && world_ == world && dJointGetBody(joint_.id(), 0) == second && dJointGetBody(joint_.id(), 1) == first;
  if (is_there) return joint_.id();
  joint_ = ode::Joint(dJointCreateFixed(world, nullptr));
  world_ = world;
  dJointAttach(joint_.id(), second, first);
  // ODE keeps the bodies as they are when it is told to: for that moment the second one is where it has to be.
  const Eigen::Vector3d place = ode::vector(dBodyGetPosition(second));
  const Eigen::Quaterniond turn = ode::quaternion(dBodyGetQuaternion(second));
  const Eigen::Isometry3d to = wanted();
  put_body(second, to.translation(), Eigen::Quaterniond(to.linear()));
  dJointSetFixed(joint_.id());
  put_body(second, place, turn);
  return joint_.id();
}

void Weld::add_to(StateHash& hash) const {
  hash.add_all(std::uint64_t{first_->id()}, std::uint64_t{first_assembly_}, std::uint64_t{second_->id()}, std::uint64_t{second_assembly_});
  for (int column = 0; column < 4; ++column) hash.add(Eigen::Vector3d(second_in_first_.matrix().col(column).head<3>()));
}

}  // namespace sim
