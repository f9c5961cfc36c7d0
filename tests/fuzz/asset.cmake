add_executable(asset_fuzz asset_fuzz.cpp fork_server.cpp memory_budget.cpp)
target_include_directories(asset_fuzz PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(asset_fuzz PRIVATE asset_jobs simphysics simrays simrender rtmsim_settings)
add_test(NAME asset_fuzz COMMAND asset_fuzz --runs 20 ${CMAKE_CURRENT_SOURCE_DIR}/assets ${PROJECT_SOURCE_DIR}/tests/worlds/damaged_meshes
                                 WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
set_tests_properties(asset_fuzz PROPERTIES TIMEOUT 300 LABELS "world;fuzz")
add_test(NAME asset_fuzz.forked COMMAND asset_fuzz --fork --runs 100 --limit 300 ${CMAKE_CURRENT_SOURCE_DIR}/assets WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/forked)
file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/forked)
set_tests_properties(asset_fuzz.forked PROPERTIES TIMEOUT 300 LABELS "world;fuzz")
