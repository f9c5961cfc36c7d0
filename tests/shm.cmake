rtmsim_test(shm_test shm/iface_test.cpp shm/frame_ring_test.cpp shm/request_test.cpp shm/lockstep_test.cpp LIBRARIES simshm)
