rtmsim_test(rays_test rays/rays_test.cpp LIBRARIES simrays LABELS sim)
