add_executable(latency_probe latency_probe.cpp)
target_link_libraries(latency_probe PRIVATE openrtm simshm rtmsim_settings)
target_include_directories(latency_probe PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(latency_probe PRIVATE test_paths)
# From scan to velocity command through three processes; run by hand: cmake --build --preset release --target latency_bench
add_custom_target(latency_bench COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/latency_bench.py ${CMAKE_BINARY_DIR} USES_TERMINAL)
add_dependencies(latency_bench latency_probe rtse rtcd RTCLaser LaserObstacleAvoid RTCPosition2d)
