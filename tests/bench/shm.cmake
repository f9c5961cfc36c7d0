add_executable(shm_bench shm_bench.cpp)
target_link_libraries(shm_bench PRIVATE simshm rtmsim_settings)
