rtmsim_test(physics_test unit/physics_test.cpp LIBRARIES simphysics LABELS sim)
rtmsim_test(joints_test unit/joints_test.cpp LIBRARIES simphysics LABELS sim)
