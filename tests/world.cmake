# Height maps are written by libtiff.
find_package(TIFF REQUIRED)
rtmsim_test(world_test
  world/world_loader_test.cpp world/world_inertia_test.cpp world/world_sensors_test.cpp world/world_bad_test.cpp world/world_wild_test.cpp world/world_border_test.cpp world/world_limits_test.cpp
  world/world_spawn_test.cpp world/joint_elements_test.cpp world/joint_gains_test.cpp world/gripper_test.cpp world/urdf_test.cpp world/floor_plan_test.cpp world/elevations_test.cpp
  world/asset_reader_test.cpp
  LIBRARIES simworld simrender TIFF::TIFF LABELS world)
