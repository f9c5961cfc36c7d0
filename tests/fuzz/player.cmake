add_executable(player_fuzz player_fuzz.cpp)
target_link_libraries(player_fuzz PRIVATE player_protocol rtmsim_settings)
add_test(NAME player_fuzz COMMAND ${judged} $<TARGET_FILE:player_fuzz> --runs 50000)
set_tests_properties(player_fuzz PROPERTIES TIMEOUT 300 LABELS "fuzz;campaign")
