# What recordings cost; run by hand: cmake --build --preset release --target recording_bench
add_custom_target(recording_bench
  COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/recording_bench.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR}
  USES_TERMINAL)
add_custom_target(page_bench
  COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/page_bench.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR}
  USES_TERMINAL)
add_executable(mcap_bench mcap_bench.cpp)
target_include_directories(mcap_bench PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(mcap_bench PRIVATE mcap rtmsim_settings)
add_dependencies(page_bench rtse rtse-page rtse-recorder rtcd sim-server)
add_dependencies(recording_bench rtse rtse-recorder rtcd sim-server simctl mcap_bench)
