rtmsim_test(shm_test shm/iface_test.cpp LIBRARIES simshm)
