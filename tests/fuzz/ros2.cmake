# Messages and requests that participants of ROS 2 send.
if(RTMSIM_ROS2)
  add_executable(ros2_fuzz ros2_fuzz.cpp)
  target_include_directories(ros2_fuzz PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(ros2_fuzz PRIVATE ros2_mappings rtmsim_settings)
  add_test(NAME fuzz.ros2 COMMAND ros2_fuzz --runs 20000)
  set_tests_properties(fuzz.ros2 PROPERTIES LABELS fuzz TIMEOUT 300)
endif()
