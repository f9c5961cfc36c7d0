rtmsim_test(joint_gains_test world/joint_elements_test.cpp world/joint_gains_test.cpp world/gripper_test.cpp LIBRARIES simworld LABELS world)
rtmsim_test(urdf_test world/urdf_test.cpp LIBRARIES simworld LABELS world)
rtmsim_test(floor_plan_test world/floor_plan_test.cpp LIBRARIES simworld LABELS world)
# Writes its files by libtiff.
find_package(TIFF REQUIRED)
rtmsim_test(elevations_test world/elevations_test.cpp LIBRARIES simworld TIFF::TIFF LABELS world)
rtmsim_test(world_test world/world_loader_test.cpp world/world_inertia_test.cpp world/world_sensors_test.cpp world/world_bad_test.cpp world/world_wild_test.cpp world/world_border_test.cpp world/world_limits_test.cpp world/world_spawn_test.cpp LIBRARIES simworld LABELS world)
rtmsim_test(asset_reader_test world/asset_reader_test.cpp LIBRARIES simworld simrender LABELS world)
