add_executable(asset_fuzz asset_fuzz.cpp asset_mutations.cpp fork_server.cpp memory_budget.cpp)
target_include_directories(asset_fuzz PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(asset_fuzz PRIVATE asset_jobs simphysics simrays simrender rtmsim_settings)
add_test(NAME asset_fuzz COMMAND asset_fuzz --runs 20 ${CMAKE_CURRENT_SOURCE_DIR}/assets ${PROJECT_SOURCE_DIR}/tests/worlds/damaged_meshes
                                 WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
set_tests_properties(asset_fuzz PROPERTIES TIMEOUT 300 LABELS "world;fuzz")
add_test(NAME asset_fuzz.forked COMMAND asset_fuzz --fork --runs 100 --limit 300 ${CMAKE_CURRENT_SOURCE_DIR}/assets WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/forked)
file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/forked)
set_tests_properties(asset_fuzz.forked PROPERTIES TIMEOUT 300 LABELS "world;fuzz")
# Made for campaigns by hand with the address sanitizer (docs/security.md).
add_executable(asset_campaign asset_campaign.cpp asset_mutations.cpp memory_budget.cpp worker.cpp)
target_include_directories(asset_campaign PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(asset_campaign PRIVATE asset_jobs simmeshes rtmsim_settings)
file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/campaign)
add_test(NAME asset_campaign COMMAND asset_campaign --runs 50 ${CMAKE_CURRENT_SOURCE_DIR}/assets/limb.dae ${CMAKE_CURRENT_SOURCE_DIR}/assets/cube.obj
         ${CMAKE_CURRENT_SOURCE_DIR}/assets/text.ply ${CMAKE_CURRENT_SOURCE_DIR}/assets/cube.glb ${CMAKE_CURRENT_SOURCE_DIR}/assets/walk.bvh
         WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/campaign)
set_tests_properties(asset_campaign PROPERTIES TIMEOUT 300 LABELS "world;fuzz")
rtmsim_test(fuzz_worker_test worker_test.cpp worker.cpp memory_budget.cpp LIBRARIES base LABELS fuzz)
