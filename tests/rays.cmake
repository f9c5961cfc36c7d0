rtmsim_test(rays_test rays/rays_test.cpp rays/body_grid_test.cpp LIBRARIES simrays LABELS sim)
