#include "physics/joint_tree.h"

#include <algorithm>

namespace sim {
namespace {

bool is_known(const JointInstance& joint) {
  if (joint.id() == nullptr || joint.has_coupling() || joint.has_stand_in()) return false;
  const auto type = dJointGetType(joint.id());
  return type == dJointTypeHinge || type == dJointTypeSlider || type == dJointTypeFixed || type == dJointTypeBall;
}

class Growth {
 public:
  Growth(const std::vector<ode::Body>& bodies, const std::vector<JointInstance>& joints)
      : bodies_(bodies), joints_(joints), arms_(bodies.size()), is_placed_(bodies.size(), false) {}

  JointTree run() {
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (!is_known(joints_[j])) return {};
      for (const int end : {joints_[j].parent_assembly, joints_[j].child_assembly}) {
        if (!has_body(end)) continue;
        if (dBodyIsKinematic(bodies_[static_cast<std::size_t>(end)].id()) != 0) return {};
        arms_[static_cast<std::size_t>(end)].push_back(static_cast<int>(j));
      }
    }
    // What the world holds grows from there, the rest from its first body.
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const bool has_parent = has_body(joints_[j].parent_assembly), has_child = has_body(joints_[j].child_assembly);
      if (has_parent == has_child) continue;
      const int body = has_child ? joints_[j].child_assembly : joints_[j].parent_assembly;
      if (is_placed_[static_cast<std::size_t>(body)]) return {};  // held twice
      grow({static_cast<std::uint32_t>(body), -1, static_cast<int>(j), has_child});
    }
    for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
      if (has_body(static_cast<int>(i)) && !is_placed_[i]) grow({i, -1, -1, false});
    }
    if (joints_used_ != joints_.size()) return {};  // the others close loops
    tree_.is_one = true;
    return std::move(tree_);
  }

 private:
  bool has_body(int assembly) const { return assembly >= 0 && bodies_[static_cast<std::size_t>(assembly)].id() != nullptr; }

  void place(const JointTree::Place& place) {
    is_placed_[place.assembly] = true;
    joints_used_ += place.joint >= 0 ? 1 : 0;
    tree_.places.push_back(place);
  }
  void grow(const JointTree::Place& root) {
    std::size_t next = tree_.places.size();
    place(root);
    for (; next < tree_.places.size(); ++next) {
      const auto from = tree_.places[next].assembly;
      for (const int j : arms_[from]) {
        const JointInstance& joint = joints_[static_cast<std::size_t>(j)];
        const bool is_child = joint.parent_assembly == static_cast<int>(from);
        const int other = is_child ? joint.child_assembly : joint.parent_assembly;
        if (has_body(other) && !is_placed_[static_cast<std::size_t>(other)])
          place({static_cast<std::uint32_t>(other), static_cast<int>(next), j, is_child});
      }
    }
  }

  const std::vector<ode::Body>& bodies_;
  const std::vector<JointInstance>& joints_;
  std::vector<std::vector<int>> arms_;  // joints at each body
  std::vector<bool> is_placed_;
  std::size_t joints_used_ = 0;
  JointTree tree_;
};

}  // namespace

JointTree joint_tree(const std::vector<ode::Body>& bodies, const std::vector<JointInstance>& joints) {
  return Growth(bodies, joints).run();
}

}  // namespace sim
