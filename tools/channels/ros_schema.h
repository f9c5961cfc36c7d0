// The schema of a channel of ROS 2 messages. Pure; any thread.
#pragma once

#include <string>

#include "channels/channel.h"
#include "ros/cdr.h"

namespace channels {

template <ros::Message T>
Schema schema_of() {
  return {std::string(T::name), "ros2msg", ros::Definitions::of<T>()};
}

}  // namespace channels
