rtmsim_test(world_test unit/world_loader_test.cpp unit/world_sensors_test.cpp unit/world_bad_test.cpp unit/world_wild_test.cpp LIBRARIES simworld LABELS world)
