rtmsim_test(devices_test unit/devices_test.cpp unit/meter_test.cpp unit/sensor_elements_test.cpp LIBRARIES simserver LABELS sim)
rtmsim_test(follower_test unit/follower_test.cpp unit/path_test.cpp LIBRARIES simserver LABELS sim)
rtmsim_test(camera_device_test unit/camera_device_test.cpp LIBRARIES simserver LABELS sim render)
rtmsim_test(mesh_collision_test unit/mesh_collision_test.cpp LIBRARIES simserver png LABELS sim)
