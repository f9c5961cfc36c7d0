rtmsim_test(avoidance_test clients/avoidance_test.cpp LIBRARIES avoidance)
rtmsim_test(porter_test clients/porter_test.cpp LIBRARIES delivery_rule)
rtmsim_test(iface_components_test
  iface-components/conversions_test.cpp iface-components/line_limit_test.cpp iface-components/ranger_test.cpp iface-components/scan_features_test.cpp iface-components/sim_tick_test.cpp
  iface-components/tick_group_test.cpp iface-components/camera_image_test.cpp ${PROJECT_SOURCE_DIR}/iface-components/sim_tick.cpp ${PROJECT_SOURCE_DIR}/iface-components/tick_group.cpp
  LIBRARIES iface_link camera_image turbojpeg)
rtmsim_test(manipulator_test arms/arm_kinematics_test.cpp arms/limb_test.cpp arms/manipulator_test.cpp LIBRARIES arms)
find_package(SDL2 REQUIRED)
rtmsim_test(video_test clients/picture_test.cpp clients/window_test.cpp LIBRARIES video SDL2::SDL2)

rtmsim_component(ArmProbe scenario/arm_probe.cpp)
rtmsim_component(ManipulatorCaller scenario/manipulator_caller.cpp)
rtmsim_component(ManipulatorCallerWithoutModule scenario/manipulator_caller_without_module.cpp IDL scenario/without_module/ManipulatorWithoutModule.idl)
scenario_cases(manipulator. manipulator moves without_module settings bad_values queue alarms passed_limits emergency low_level dead_client reset)
scenario_cases(arms. arms simctl gains act_array dead_commander gripper limb ptz robot_hardware robot_sensors attach)

# Every interface component against a living simulator, in real processes.
rtmsim_component(SimulationProbe scenario/simulation_probe.cpp)
rtmsim_component(DeviceProbe scenario/device_probe.cpp)
scenario_cases(components. components sonar imu gps bumper ranger places point_cloud odometry goals meters others names simulation motors wrong_device)
scenario_cases(components. camera_components camera_formats camera_parameters camera_service camera_jpeg depth_camera drone wrong_camera_device restarted_server)

# Components of devices that look.
rtmsim_component(SeenProbe scenario/seen_probe.cpp)
scenario_cases(seen_devices. seen_devices logical_camera boxes fiducial multicamera thermal map)
