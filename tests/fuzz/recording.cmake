# MCAP files: the octets of a recording, mutated. A user's bound: 10^6 runs under the asan preset.
add_executable(mcap_fuzz mcap_fuzz.cpp)
target_include_directories(mcap_fuzz PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(mcap_fuzz PRIVATE mcap rtmsim_settings)
if(RTMSIM_LIBFUZZER)
  target_compile_definitions(mcap_fuzz PRIVATE RTMSIM_LIBFUZZER)
  target_link_options(mcap_fuzz PRIVATE -fsanitize=fuzzer)
else()
  add_test(NAME fuzz.mcap COMMAND mcap_fuzz --runs 20000)
  set_tests_properties(fuzz.mcap PROPERTIES LABELS fuzz TIMEOUT 300)
endif()

# Definitions and samples of ROS 2, and conditions.
add_executable(ros_fuzz ros_fuzz.cpp)
target_include_directories(ros_fuzz PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(ros_fuzz PRIVATE recorder rtmsim_settings)
add_test(NAME fuzz.ros COMMAND ros_fuzz --runs 20000)
set_tests_properties(fuzz.ros PROPERTIES LABELS fuzz TIMEOUT 300)
