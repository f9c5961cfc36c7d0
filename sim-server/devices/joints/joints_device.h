// The joints of a model that nothing else drives: commands of all clients, each for its own joints, go to controllers in the solver. A
// joint that no client has commanded is as the file has it. When the client that commands a joint detaches or exits, the joint brakes. See
// device.h for the thread rule.
#pragma once

#include <vector>

#include "devices/joints/joint_list.h"
#include "devices/sensors/sensor.h"

namespace sim {

class JointsDevice final : public Sensor {
 public:
  // Nothing, when the model has no such joints.
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, ModelId model);
  static std::string name_of(const ModelDef& model) { return model.name + "::joints"; }

  JointsDevice(Setup setup, std::vector<ListedJoint> joints, JointDynamics dynamics);

  bool follows_steps() const override { return true; }
  void before_step(const Moment& moment) override;
  void after_step(const Moment& moment) override;

 private:
  struct Axis {
    ListedJoint listed;
    JointServo servo;
    std::uint64_t owner = 0;  // the client that commands it; 0: none
    bool was_within = true;   // of the limits, the last command; said once
  };
  void measure(const Moment& moment) const override;
  void restart() override;
  void add_state_to(StateHash& hash) const override;
  void take(std::uint64_t owner, const shm::Command& command);
  void order(Axis& axis, std::uint64_t owner, const JointOrder& order);
  void brake_lost_joints();
  Eigen::Matrix3d base_rotation() const;
  void compute_gravity();
  JointState state_of(const Axis& axis) const { return physics().joint_state({model(), axis.listed.joint}); }
  void warn(const std::string& line) const;

  std::vector<Axis> axes_;
  JointDynamics dynamics_;
  bool is_active_ = false;  // a joint has been commanded
  std::uint32_t owners_seen_ = 0;
  std::vector<double> positions_, gravity_;
};

}  // namespace sim
