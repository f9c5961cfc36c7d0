rtmsim_test(avoidance_test unit/avoidance_test.cpp LIBRARIES avoidance)
