// One joint of a model in ODE, whatever its kind, in SDFormat's senses and units. Private to physics/. One thread at a time.
//
// ODE has neither screws nor gearboxes between any axes: here two bodies are tied along one line, laid again for each step, by the friction
// of a contact that pushes no body. A joint with two axes gets a body that nothing can move where the world is one side of it, since ODE
// counts its angles wrongly without.
//
// ODE knows an angle within half a turn only. The angle of an axis with limits or a spring is followed from step to step, and ODE gets the
// stops as seen from the present turn. This is exact: ODE compares a stop with the angle only, also where the stop is beyond half a turn.
//
// ODE notices a stop after it was passed, and gives the joint a fifth of its rate back while it pushes it out. Here a joint that would pass
// its stop in a step comes to the stop and has no rate there. One that is beyond a limit all the same, from the start or by a blow in the
// step, cannot go further, and the stop goes back to the limit at 0.01 rad/s or m/s. A joint whose limits are one value is moved there at
// 1 rad/s or m/s. Stops with a stiffness are springs and stay ODE's.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "physics/bounded_system.h"
#include "physics/ode.h"
#include "physics/physics.h"

namespace sim {

// A tie between the motions of two bodies that ODE has no joint for, as one force along a line that is laid anew for each step. The force
// does no work, so that it carries momentum and energy over as a thread or teeth do.
struct Coupling {
  Eigen::Vector3d anchor1, axis1;  // in the first body's frame (the parent), in the world without one
  Eigen::Vector3d anchor2, axis2;  // in the second body's (the child)
  double ratio = 1;                // gearbox: rate about axis1 = -ratio * rate about axis2; screw: metres per radian
  bool is_screw = false;
};

// Where a joint sits on a body: in the body's frame, or in the world's where there is no body.
struct JointSeat {
  Eigen::Vector3d place{0, 0, 0}, axis{0, 0, 1};
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

class JointInstance {
 public:
  // Makes the joint between bodies at their places of the start. `frame` is the joint's in the world; either body may be null: the world.
  JointInstance(dWorldID world, const PhysicsDef& physics, const JointDef& def, std::uint32_t index, const Eigen::Isometry3d& frame,
                dBodyID parent, dBodyID child);

  // A gearbox turns its bodies about the axes of the joints that hold them; each a point on the axis, in the world.
  void set_gear_anchors(const Eigen::Vector3d& parent, const Eigen::Vector3d& child);

  std::uint32_t index() const { return index_; }  // in ModelDef::joints
  const JointDef& def() const { return *def_; }
  int axis_count() const { return axis_count_; }
  JointState state(int axis) const;
  JointState within_turn(int axis) const;  // as ODE has it: an angle within half a turn

  // Where an axis is, and what limits it now. Part of the state of a run.
  struct Place {
    double position = 0;                      // [rad] with whole turns, or [m]
    int turns = 0;                            // whole turns in the position
    double low = -infinite, high = infinite;  // the stops; beyond the limits while the joint is
  };
  using Places = std::array<Place, 2>;
  // After the bodies were put to where they start. `is_saved`: by poses, so that whole turns are not known; they are chosen within the
  // limits.
  void begin(double dt, bool is_saved);
  // After each step of `dt` that may have moved it. Only is_followed() joints need it.
  void follow(double dt);
  bool is_followed() const { return is_followed_; }
  const Places& places() const { return places_; }
  void take(const Places& places, double dt);
  // The place says more than the poses of the bodies do.
  bool has_history(int axis) const;

  // Force and torque that the joint put on the child in the last step, at the child's centre of mass; empty while it is not measured.
  std::optional<Wrench> load() const;

  struct Drive {
    double velocity = 0, effort = 0;
    bool is_set = false;
  };
  const Drive& drive(int axis) const { return drives_[static_cast<std::size_t>(axis)]; }
  void set_drive(int axis, double velocity, double effort);

  // The motor of a controller, for the next step; `is_in_tree`: the solver along the tree of joints steps it.
  void set_row(const JointRow& row, bool is_in_tree);
  bool has_row() const { return has_row_; }

  // For joint_tree and tree_solver. Empty id: a gearbox.
  dJointID id() const { return joint_.id(); }
  std::uint32_t rows() const;            // of constraints that it makes while no stop is reached and no motor set
  double sign() const { return sign_; }  // of ODE's positions, rates, stops and motors
  bool has_coupling() const { return coupling_.has_value(); }
  const JointSeat& seat_on_parent() const { return seat_on_parent_; }
  const JointSeat& seat_on_child() const { return seat_on_child_; }

  // For the next step, on the child against the parent [N m] or [N]. It does nothing where takes_effort() is false.
  void add_effort(int axis, double effort);
  bool takes_effort() const;

  bool has_stand_in() const { return stand_in_.id() != nullptr; }
  bool has_forces() const { return has_forces_ || coupling_; }
  // What must be done before each step: springs, the damping that ODE's motors cannot do, couplings.
  void apply(dJointGroupID step_joints, double dt);

  int parent_assembly = -1, child_assembly = -1;  // of the model, -1: the world
  Bound motor_bound = Bound::free;                // in the last step of the tree solver, which begins the next one with it

 private:
  void make(dWorldID world, const Eigen::Isometry3d& frame);
  void attach(dJointID joint, dBodyID first, dBodyID second);
  dBodyID or_stand_in(dBodyID body);
  void make_universal(dWorldID world, const Eigen::Vector3d& place, const Eigen::Vector3d& first, const Eigen::Vector3d& second);
  void make_gearbox(const Eigen::Isometry3d& frame);
  void make_screw(dWorldID world, const Eigen::Isometry3d& frame);
  void set_axis(int axis, double dt);
  void read_stops(int axis, double dt);
  void set_stops(int axis, double rate, double dt);
  void put_stops(int axis, double low, double high, double erp);
  void move_stops(int axis, double before, double dt);
  void set_stop_parameter(int axis, int parameter, double value);
  JointState hinge_state() const;
  void remember_hinge();
  void set_parameter(int axis, int base_parameter, double value);
  bool turns(int axis) const;
  bool is_screw() const;
  bool is_at_stop() const;
  bool is_asleep() const;
  Eigen::Vector3d axis_in_world(int axis) const;
  double inertia_along(int axis) const;
  void couple(dJointGroupID step_joints, double dt);

  const JointDef* def_;
  int axis_count_;  // asked for in every step, when the definition, which is the model's own, is out of the cache
  std::uint32_t index_;
  dWorldID world_;
  dBodyID parent_, child_;
  ode::Body stand_in_;  // for the world, where ODE needs a body
  ode::Joint joint_;    // empty for a gearbox
  double sign_ = 1;     // of ODE's positions and rates against SDFormat's
  JointSeat seat_on_parent_, seat_on_child_;
  // The limits of an axis as the file gives them, and how ODE has them now.
  struct Stops {
    double low = -infinite, high = infinite;  // [rad] or [m]
    double erp = 0.2;                         // of ODE's, in a step that begins at the stop
    bool is_soft = false;                     // a spring
    bool counts_turns = false;
    double low_in_ode = -infinite, high_in_ode = infinite, erp_in_ode = 0.2;
    bool exists() const { return std::isfinite(low) || std::isfinite(high); }
    bool is_lock() const { return low == high; }
  };
  std::array<Stops, 2> stops_;
  Places places_;
  bool is_followed_ = false;
  // A hinge as it was after the last step, and what of its bodies that follows from: it is asked for several times until the next one.
  struct Seen {
    std::array<double, 14> bodies{};  // orientations and rates of turning
    JointState state;
  };
  std::unique_ptr<Seen> seen_;  // of those that are followed
  std::array<Drive, 2> drives_;
  std::array<double, 2> damping_{0, 0};  // that is not ODE's
  bool has_row_ = false;
  JointRow row_;
  bool has_forces_ = false;
  std::optional<Coupling> coupling_;
  std::unique_ptr<dJointFeedback> feedback_;
};

}  // namespace sim
