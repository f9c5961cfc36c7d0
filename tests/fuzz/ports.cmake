add_executable(ports_fuzz ports_fuzz.cpp)
target_link_libraries(ports_fuzz PRIVATE openrtm rtmsim_settings)
add_test(NAME ports_fuzz COMMAND ${judged} $<TARGET_FILE:ports_fuzz> --runs 20000)
set_tests_properties(ports_fuzz PROPERTIES TIMEOUT 300 LABELS "corba;fuzz;campaign")
