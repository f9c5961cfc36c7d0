// A client of the iface joints. One thread.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/simulation_fixture.h"

namespace sim::test {

// A client that commands joints by their places.
struct Joints {
  Joints(SimulationFixture& f, const std::string& model) : iface(f.open(shm::IfaceType::joints, model + "::joints")) {
    values.resize(RTMSIM_JOINT_VALUES * iface.count());
  }
  void command(std::size_t joint, std::uint32_t mode, double value) {
    values[RTMSIM_JOINT_VALUES * joint] = mode, values[RTMSIM_JOINT_VALUES * joint + 1] = value;
    ASSERT_TRUE(iface.command(shm::CommandKind::joints, values));
  }
  shm::JointState state(std::size_t joint) {
    EXPECT_TRUE(iface.read());
    return reinterpret_cast<const shm::JointState*>(iface.sample_followers(0))[joint];
  }
  const shm::Joint& info(std::size_t joint) const { return reinterpret_cast<const shm::Joint*>(iface.info_followers(0))[joint]; }
  shm::Iface iface;
  std::vector<double> values;
};

}  // namespace sim::test
