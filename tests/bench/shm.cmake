add_executable(shm_bench shm_bench.cpp)
target_include_directories(shm_bench PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(shm_bench PRIVATE simshm rtmsim_settings)
