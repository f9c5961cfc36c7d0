rtmsim_test(devices_test
  devices/devices_test.cpp devices/position3d_test.cpp devices/sensor_test.cpp devices/sensor_fault_test.cpp devices/meter_test.cpp devices/battery_test.cpp devices/plain_sensor_test.cpp
  devices/sensor_elements_test.cpp devices/lidar_test.cpp devices/car_drive_test.cpp devices/land_drives_test.cpp devices/vehicles_test.cpp devices/buoyancy_engine_test.cpp devices/forces_test.cpp
  devices/nonsense_test.cpp devices/joint_hold_test.cpp devices/joints_test.cpp devices/joint_faults_test.cpp devices/real_robots_test.cpp devices/attachments_test.cpp devices/follower_test.cpp
  devices/path_test.cpp devices/seen_models_test.cpp
  LIBRARIES simserver LABELS sim)
find_library(APRILTAG_LIBRARY apriltag REQUIRED)
rtmsim_test(camera_device_test
  devices/camera_device_test.cpp devices/label_camera_test.cpp devices/april_tag_test.cpp devices/actor_test.cpp devices/sensor_nonsense_test.cpp devices/devices_world_test.cpp
  LIBRARIES simserver iface_json ${APRILTAG_LIBRARY} LABELS sim render)
