# sim-server and simctl as processes; each case has a server of its own.
foreach(script_and_cases
    "server requests output_that_takes_no_more motion tags suggestions same_state looked_at_while_paused looked_at_each_device shows_every_type exports check names fleet waits rate paused_is_idle"
    "server_faults faults bad_requests no_room scribbled_over killed living_server_is_refused ends ends_while_it_loads cut_short shared"
    "maps box_is_400_cells map_server_reads_it thin_and_turned map_is_a_floor_plan bad_input"
    "server_time drives_for_simulated_seconds a_stopped_client_drives_no_further pushes_for_simulated_seconds the_schedule_stays echoes_every_sample"
    "server_meshes damaged_in_a_world damaged_and_spawned time_goes_on_while_a_model_is_read lock_step_waits_for_a_model reader_is_killed reader_ends_with_its_server primitives_need_no_reader special_files changed_file_is_read_again first_picture_is_read_beside_the_simulation lock_step_waits_for_the_first_picture simulator_ends_while_its_first_picture_is_read mesh_behind_a_link_to_another_name worlds_are_data names_control_no_terminal")
  separate_arguments(cases UNIX_COMMAND "${script_and_cases}")
  list(POP_FRONT cases script)
  foreach(case ${cases})
    add_test(NAME server.${case}
      COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/${script}.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
    set_tests_properties(server.${case} PROPERTIES LABELS sim TIMEOUT 300 SKIP_RETURN_CODE 77)
  endforeach()
endforeach()
add_test(NAME server.by_the_page COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/by_the_page.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
set_tests_properties(server.by_the_page PROPERTIES LABELS sim TIMEOUT 300)
add_test(NAME worlds.are_what_their_scripts_write COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/generated_worlds.py ${PROJECT_SOURCE_DIR})
set_tests_properties(worlds.are_what_their_scripts_write PROPERTIES LABELS world TIMEOUT 300)
rtmsim_test(server_test server/pace_test.cpp server/world_hashes_test.cpp server/wild_run_test.cpp server/deleted_models_test.cpp server/pose_watch_test.cpp LIBRARIES simserver LABELS sim)
