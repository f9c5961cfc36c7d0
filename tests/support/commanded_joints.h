// An arm of one model in a simulation of its own, and a client that commands its joints.
#pragma once

#include <numbers>
#include <vector>

#include "support/arms.h"
#include "support/simulation_fixture.h"

namespace sim::test {

inline constexpr double tenth_of_a_degree = 0.1 * std::numbers::pi / 180;

// An arm that a client commands.
class CommandedJoints {
 public:
  explicit CommandedJoints(WorldDef world) : f(std::move(world)), iface(f.open(shm::IfaceType::joints, "arm::joints")) {}
  void command(std::uint32_t joint, std::uint32_t mode, double value, double velocity = 0, double effort = 0) {
    values_.resize(RTMSIM_JOINT_VALUES * iface.count());
    double* at = values_.data() + RTMSIM_JOINT_VALUES * joint;
    at[0] = mode, at[1] = value, at[2] = velocity, at[3] = effort;
    send(iface);
  }
  void command_all(std::uint32_t mode, const std::vector<double>& values) {
    for (std::uint32_t i = 0; i < values.size(); ++i) command(i, mode, values[i]);
  }
  shm::JointState state(std::size_t joint) {
    EXPECT_TRUE(iface.read());
    return reinterpret_cast<const shm::JointState*>(iface.sample_followers(0))[joint];
  }
  const shm::Joint& info(std::size_t joint) const { return reinterpret_cast<const shm::Joint*>(iface.info_followers(0))[joint]; }
  void send(shm::Iface& from) { ASSERT_TRUE(from.command(shm::CommandKind::joints, values_)); }

  SimulationFixture f;
  shm::Iface iface;

 private:
  std::vector<double> values_;
};

inline const std::vector<double> reached{.3, -1.2, 1.5, -.9, -1.1, .7};

}  // namespace sim::test
