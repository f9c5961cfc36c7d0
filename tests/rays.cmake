rtmsim_test(rays_test unit/rays_test.cpp LIBRARIES simrays LABELS sim)
