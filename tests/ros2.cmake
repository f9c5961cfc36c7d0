# Messages of ROS 2, and ros2-gateway before a peer of another make.
rtmsim_test(ros_wire_test ros2/ros_wire_test.cpp LIBRARIES ros_messages)
