add_executable(manager_fuzz manager_fuzz.cpp)
target_link_libraries(manager_fuzz PRIVATE rt_corba rtmsim_settings)
add_test(NAME manager_fuzz COMMAND ${judged} $<TARGET_FILE:manager_fuzz> 4000)
set_tests_properties(manager_fuzz PROPERTIES TIMEOUT 300 LABELS "fuzz;campaign")
