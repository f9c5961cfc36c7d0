# sim-server and simctl as processes; each case has a server of its own.
foreach(case requests motion bad_requests same_state killed living_server_is_refused ends check paused_is_idle looked_at_while_paused
             rate no_room scribbled_over)
  add_test(NAME server.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/server.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(server.${case} PROPERTIES LABELS sim TIMEOUT 300 SKIP_RETURN_CODE 77)
endforeach()
rtmsim_test(wild_run_test unit/wild_run_test.cpp LIBRARIES simserver LABELS sim world)
