// The mappings of data types that ROS2Transport has, registered in the factories of the process. Any thread.
#pragma once

namespace ros2 {

void add_mappings();

// Its parts.
void add_number_mappings();
void add_sequence_mappings();

}  // namespace ros2
