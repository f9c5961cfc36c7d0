# The system editor on a system of twenty components, and of a thousand more; run by hand: cmake --build --preset release --target rtse_bench
add_custom_target(rtse_bench
  COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/rtse_bench.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR}
  USES_TERMINAL)
add_dependencies(rtse_bench rtse rtcd SourceAll SinkAll ConfigDemo)
