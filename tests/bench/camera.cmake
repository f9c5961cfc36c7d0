add_executable(camera_probe camera_probe.cpp)
target_include_directories(camera_probe PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(camera_probe PRIVATE VideoPlayer_objects simshm openrtm rtmsim_settings)
# Frames from the simulator to the video player; run by hand: cmake --build --preset release --target camera_bench
add_custom_target(camera_bench COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/camera_bench.py ${CMAKE_BINARY_DIR} USES_TERMINAL)
add_dependencies(camera_bench camera_probe rtse rtcd sim-server simctl RTCCamera)
