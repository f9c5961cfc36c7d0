rtmsim_test(devices_test devices/devices_test.cpp devices/sensor_test.cpp devices/sensor_fault_test.cpp devices/meter_test.cpp devices/battery_test.cpp devices/plain_sensor_test.cpp devices/sensor_elements_test.cpp devices/car_drive_test.cpp devices/joint_hold_test.cpp devices/joints_test.cpp devices/joint_faults_test.cpp devices/real_robots_test.cpp devices/seen_models_test.cpp devices/lidar_test.cpp LIBRARIES simserver LABELS sim)
rtmsim_test(attachments_test devices/attachments_test.cpp LIBRARIES simserver LABELS sim)
rtmsim_test(follower_test devices/follower_test.cpp devices/path_test.cpp LIBRARIES simserver LABELS sim)
rtmsim_test(camera_device_test devices/camera_device_test.cpp LIBRARIES simserver LABELS sim render)
rtmsim_test(label_camera_test devices/label_camera_test.cpp LIBRARIES simserver LABELS sim render)
find_library(APRILTAG_LIBRARY apriltag REQUIRED)
rtmsim_test(april_tag_test devices/april_tag_test.cpp LIBRARIES simserver ${APRILTAG_LIBRARY} LABELS sim render)
rtmsim_test(actor_test devices/actor_test.cpp LIBRARIES simserver LABELS sim render)

