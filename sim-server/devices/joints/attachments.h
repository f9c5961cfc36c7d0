// Welds that fix other models to a model: DetachableJoints, and grippers that fix an object to their palm. Both are switched on and off by
// name: MODEL::GRIPPER; MODEL::CHILD_MODEL of a DetachableJoint, which is on from the start. The stepping thread only, between the steps
// and outside of the devices, since a weld belongs to two models.
//
// A gripper that is on checks its contacts every 10 ms of simulated time. An object that enough contacts of the fingers touch
// (GripperDef::contacts), and that does not move against the palm, is attached after GripperDef::attach_checks such checks in a row. It is
// released after GripperDef::detach_checks checks in a row without a contact.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "physics/physics.h"

namespace sim {

class Attachments {
 public:
  // Those of a model. What is wrong in one adds a line to `left_out`.
  void add(const Physics& physics, ModelId model, std::vector<std::string>& left_out);
  void remove(ModelId model);
  // As at the start, of models that are below `first_spawned`.
  void reset(ModelId first_spawned);
  void before_step(Physics& physics, std::chrono::nanoseconds time);

  bool knows(std::string_view name) const;
  struct State {
    std::string name;
    bool is_on = false;
    std::string holds;  // MODEL::LINK; empty: nothing
  };
  std::vector<State> states(const Physics& physics) const;
  // Attaches at once what a DetachableJoint has to hold; a gripper that is switched off lets go. Fails when there is nothing to hold.
  base::Result<void> turn(Physics& physics, std::string_view name, bool is_on);
  // Nothing without one that is on: worlds that hold nothing keep their hashes.
  void add_to(StateHash& hash) const;

 private:
  struct Held {
    LinkId by, link;
  };
  struct Detachable {
    std::string name{};
    ModelId model = 0;
    std::uint32_t parent = 0;
    std::string child_model{}, child_link{};
    bool is_on = true;
    std::optional<Held> held{};
    bool is_told = false;  // that what it has to hold is not there
  };
  struct Grip {
    std::string name{};
    ModelId model = 0;
    GripperDef def{};
    std::uint32_t palm = 0;
    std::vector<std::uint32_t> fingers{};
    bool is_on = false;
    std::optional<Held> held{};
    std::optional<LinkId> touched{};  // that may be attached next
    Eigen::Vector3d place{0, 0, 0};   // of it, in the palm's frame
    int checks = 0;                   // in a row: with contacts; without, of what is held
  };
  base::Result<void> hold(Physics& physics, Detachable& joint);
  void check(Physics& physics, Detachable& joint);
  void check(Physics& physics, Grip& grip);
  void seek(Physics& physics, Grip& grip);
  static std::optional<LinkId> max_touched(const Physics& physics, const Grip& grip);
  static bool touches(const Physics& physics, const Grip& grip);

  std::vector<Detachable> joints_;
  std::vector<Grip> grips_;
  std::chrono::nanoseconds next_{0};
};

}  // namespace sim
