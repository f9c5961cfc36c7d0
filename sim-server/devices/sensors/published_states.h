// Ifaces of plugins of gz-sim that publish states. OdometryPublisher: type truth, `MODEL::odometry`, the true pose of the model in the
// world with the plugin's rate, offset and noise. JointStatePublisher: type joints without commands, `MODEL::joint_states`, among them
// the angles of wheels, from which odometry can be computed. The stepping thread only.
#pragma once

#include "devices/sensors/sensor.h"

namespace sim {

MadeDevice make_odometry(DeviceWorld& world, ModelId model, const PluginDef& plugin);
// Nothing where the iface joints of the model has all of them already.
MadeDevice make_joint_states(DeviceWorld& world, ModelId model, const PluginDef& plugin);

}  // namespace sim
