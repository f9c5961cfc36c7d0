rtmsim_test(physics_test unit/physics_test.cpp LIBRARIES simphysics LABELS sim)
rtmsim_test(joints_test unit/joints_test.cpp LIBRARIES simphysics LABELS sim)
rtmsim_test(mesh_energy_test unit/mesh_energy_test.cpp LIBRARIES simphysics LABELS sim)
rtmsim_test(crowd_test unit/crowd_test.cpp LIBRARIES simphysics LABELS sim)
