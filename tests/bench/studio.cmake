# What viewers of rtm-studio cost; run by hand: cmake --build --preset release --target studio_bench
add_custom_target(studio_bench
  COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/studio_bench.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR}
  USES_TERMINAL)
add_dependencies(studio_bench rtm-studio sim-server simctl)
