rtmsim_test(physics_test unit/physics_test.cpp LIBRARIES simphysics LABELS sim)
