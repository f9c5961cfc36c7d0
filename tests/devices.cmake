rtmsim_test(devices_test devices/devices_test.cpp devices/sensor_test.cpp devices/sensor_fault_test.cpp devices/meter_test.cpp devices/sensor_elements_test.cpp devices/car_drive_test.cpp devices/land_drives_test.cpp devices/joint_hold_test.cpp devices/joints_test.cpp devices/joint_faults_test.cpp devices/real_robots_test.cpp LIBRARIES simserver LABELS sim)
rtmsim_test(follower_test devices/follower_test.cpp devices/path_test.cpp LIBRARIES simserver LABELS sim)
rtmsim_test(camera_device_test devices/camera_device_test.cpp LIBRARIES simserver LABELS sim render)
rtmsim_test(actor_test devices/actor_test.cpp LIBRARIES simserver LABELS sim render)

