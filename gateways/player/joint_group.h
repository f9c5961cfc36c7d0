// Joints of a joints iface that one device of Player shows: an array, a gripper, a limb, a pan and a tilt. Values; any thread.
#pragma once

#include <string>
#include <vector>

#include "protocol/message.h"

namespace gateway {

struct JointGroup {
  player::Interface interface = player::Interface::actarray;  // that shows them
  std::vector<std::string> joints{};                          // in the order of the device; empty: all of the iface
  double field_of_view = 0;                                   // of the camera on a pan and a tilt [rad]; 0: none
};

}  // namespace gateway
