add_executable(world_fuzz world_fuzz.cpp)
target_link_libraries(world_fuzz PRIVATE simphysics rtmsim_settings)
add_test(NAME world_fuzz COMMAND world_fuzz --runs 1500 ${PROJECT_SOURCE_DIR}/tests/worlds ${PROJECT_SOURCE_DIR}/worlds/models ${PROJECT_SOURCE_DIR}/worlds/obstacle_course.sdf
                                 WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
set_tests_properties(world_fuzz PROPERTIES TIMEOUT 300 LABELS "world;fuzz")
