// The joints of a model that no other device drives: commands of all clients, each for its own joints, go to controllers in the solver. A
// joint that no client has commanded behaves as the file describes. When the client that commands a joint detaches or exits, the joint
// brakes. See device.h for the thread rule.
//
// A joint that turns a propeller takes the speed of the propeller [rad/s] as velocity and its thrust [N] as effort, and has no position to
// hold; all other commands stop it. While no client commands it, the vehicle controls it (vehicle3d.h).
#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "devices/drives/propeller.h"
#include "devices/joints/joint_list.h"
#include "devices/sensors/sensor.h"

namespace sim {

class JointsDevice final : public Sensor {
 public:
  // Nothing, when the model has no such joints.
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, ModelId model, std::shared_ptr<Propellers> propellers);
  static std::string name_of(const ModelDef& model) { return model.name + "::joints"; }

  JointsDevice(Setup setup, std::vector<ListedJoint> joints, JointDynamics dynamics, std::shared_ptr<Propellers> propellers);

  bool follows_steps() const override { return true; }
  void before_step(const Moment& moment) override;
  void after_step(const Moment& moment) override;

  std::size_t size() const { return axes_.size(); }
  // Which joint has this name.
  base::Result<std::size_t> find(std::string_view joint) const;
  // From the next step on: the part of its effort that a joint has left, and whether it goes on as it was told last. What it is told
  // meanwhile counts when that ends.
  void set_fault(std::size_t joint, double strength, bool is_halted);
  bool is_working() const override { return is_active_; }
  // Without power motors have no effort; brakes hold.
  void set_power(bool has_power) override;

 private:
  struct Told {
    std::uint64_t owner = 0;
    JointOrder order;
  };
  struct Axis {
    ListedJoint listed;
    JointServo servo;
    std::uint64_t owner = 0;  // the client that commands it; 0: none
    double strength = 1;      // of a fault
    bool was_within = true;   // of the limits, the last command; said once
    bool is_halted = false;
    std::optional<Told> told{};                        // while it was halted
    std::pair<std::uint64_t, std::uint64_t> rivals{};  // two clients that took it from each other; said once
    std::optional<std::size_t> propeller{};
  };
  void measure(const Moment& moment) const override;
  void restart() override;
  void add_state_to(StateHash& hash) const override;
  void take(std::uint64_t owner, const shm::Command& command);
  std::pair<double, double> range_of(const Axis& axis, JointMode mode) const;
  void order(Axis& axis, std::uint64_t owner, const JointOrder& order);
  void brake_lost_joints();
  Eigen::Matrix3d base_rotation() const;
  void compute_gravity();
  JointState state_of(const Axis& axis) const { return physics().joint_state({model(), axis.listed.joint}); }
  const std::string& name_of(const Axis& axis) const { return physics().def(model()).joints[axis.listed.joint].name; }
  void warn(const std::string& line) const;

  void turn_propellers(const Moment& moment);
  void apply_strength(Axis& axis);

  std::vector<Axis> axes_;
  JointDynamics dynamics_;
  std::shared_ptr<Propellers> propellers_;  // null: none
  std::optional<std::uint32_t> carrier_;    // link that carries the first joint; none: the world
  bool is_active_ = false;                  // a joint has been commanded
  bool has_power_ = true;
  std::uint32_t owners_seen_ = 0;
  // Before the step.
  std::vector<JointState> states_;
  std::vector<double> positions_, gravity_;
};

}  // namespace sim
