# Whole systems of real processes: omniNames, sim-server, rtcd, rtse. Each run has a naming service and a simulator of its own.
set(rtse $<TARGET_FILE:rtse>)
set(avoidance ${PROJECT_SOURCE_DIR}/worlds/systems/obstacle_avoidance.xml)
set(course ${PROJECT_SOURCE_DIR}/worlds/obstacle_course.sdf)

add_test(NAME integration.obstacle_avoidance_explores_without_touching
  COMMAND ${rtse} run ${avoidance} --world ${course} --duration 120 --seeds 1..10 -j 2
          --expect ${CMAKE_CURRENT_SOURCE_DIR}/scenario/obstacle_avoidance.yaml)
add_test(NAME integration.fifty_robots_bring_boxes_to_doors_and_do_not_touch
  COMMAND ${rtse} run ${PROJECT_SOURCE_DIR}/worlds/systems/warehouse.xml --world ${PROJECT_SOURCE_DIR}/worlds/warehouse.sdf --for robot=porter_0..porter_49 --hosts 3
          --duration 50 --expect ${PROJECT_SOURCE_DIR}/worlds/systems/warehouse.expect.yaml)
add_test(NAME integration.the_same_run_in_one_process_and_in_three
  COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/same_state.py ${rtse} ${avoidance} ${course})
add_test(NAME integration.an_arm_stacks_boxes_alike_in_20_runs
  COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/stacking.py ${rtse} ${PROJECT_SOURCE_DIR})
set_tests_properties(integration.an_arm_stacks_boxes_alike_in_20_runs PROPERTIES LABELS integration TIMEOUT 900)
foreach(system_and_seconds "pond 60" "quadcopter 45")
  separate_arguments(system_and_seconds)
  list(GET system_and_seconds 0 system)
  add_test(NAME integration.the_${system}_is_alike_in_5_runs
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/vehicles.py ${rtse} ${PROJECT_SOURCE_DIR} ${system_and_seconds})
  set_tests_properties(integration.the_${system}_is_alike_in_5_runs PROPERTIES LABELS integration TIMEOUT 900)
endforeach()
add_test(NAME integration.a_mecanum_base_goes_round_alike_in_three_runs
  COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/mecanum.py ${rtse} ${PROJECT_SOURCE_DIR})
set_tests_properties(integration.a_mecanum_base_goes_round_alike_in_three_runs PROPERTIES LABELS integration TIMEOUT 600)
add_test(NAME integration.free_run_in_real_time
  COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/free_run.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
add_test(NAME integration.the_farm_is_seen_from_the_helicopter
  COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/farm.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
add_test(NAME integration.unmet_expectations_fail_the_run
  COMMAND ${rtse} run ${avoidance} --world ${course} --duration 5 --expect ${CMAKE_CURRENT_SOURCE_DIR}/scenario/impossible.yaml)
set_tests_properties(integration.unmet_expectations_fail_the_run PROPERTIES PASS_REGULAR_EXPRESSION "expected at least 1000.*path_length")
set_tests_properties(integration.obstacle_avoidance_explores_without_touching integration.fifty_robots_bring_boxes_to_doors_and_do_not_touch integration.the_same_run_in_one_process_and_in_three
                     integration.free_run_in_real_time integration.the_farm_is_seen_from_the_helicopter integration.unmet_expectations_fail_the_run PROPERTIES LABELS integration TIMEOUT 300)

foreach(case kill_simulator kill_host kill_avoider kill_sensor kill_naming one_process four_processes late_naming late_simulator two_robots save_and_load waiting_is_no_fault server_of_the_environment hidden_sets)
  add_test(NAME integration.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/systems.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(integration.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()

foreach(case kinds joints_and_grips unknown_names not_a_number crash sudden_ends hang missing_module incomplete interrupted foreign_simulator odds_and_ends progress hung_naming slow_start)
  add_test(NAME run.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/runs.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(run.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()

foreach(case wrong_usage optional_components misunderstood_values wrong_places suggestions closed_pipe hung_is_not_gone disconnect_from_one_that_hangs connections_come_back a_silent_port_is_named managers_of_one_machine bad_values_in_files name_servers delete_names disconnect_own_ports stopped_context why_not simulation_that_is_gone converted_types names_of_others fleets)
  add_test(NAME editor.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/editor.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(editor.${case} PROPERTIES LABELS integration TIMEOUT 300 SKIP_RETURN_CODE 77)
endforeach()

add_test(NAME editor.wrong_usage_is_exit_code_2 COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/usage.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
set_tests_properties(editor.wrong_usage_is_exit_code_2 PROPERTIES LABELS integration TIMEOUT 300)
add_test(NAME editor.every_verb_names_a_missing_file COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/missing_files.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
set_tests_properties(editor.every_verb_names_a_missing_file PROPERTIES LABELS integration TIMEOUT 300)

# Calls of the tools of others, by an ORB and IDL of its own.
add_test(NAME classic_tools
  COMMAND python3 -B -W ignore ${CMAKE_CURRENT_SOURCE_DIR}/scenario/classic_tools.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
set_tests_properties(classic_tools PROPERTIES LABELS integration TIMEOUT 300)

add_test(NAME package.demo COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/demo ${PROJECT_BINARY_DIR})
set_tests_properties(package.demo PROPERTIES LABELS package TIMEOUT 300)

add_test(NAME package.debian COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/debian ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/test_packages)
set_tests_properties(package.debian PROPERTIES LABELS package TIMEOUT 1200 SKIP_RETURN_CODE 77 FIXTURES_SETUP packages)
add_test(NAME package.installed COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/autopkgtest ${PROJECT_BINARY_DIR}/test_packages ${PROJECT_SOURCE_DIR})
set_tests_properties(package.installed PROPERTIES LABELS package TIMEOUT 900 SKIP_RETURN_CODE 77 FIXTURES_REQUIRED packages)
if(RTMSIM_SANITIZE)
  set_tests_properties(package.debian package.installed PROPERTIES DISABLED TRUE)  # sanitized libraries are for no package
endif()
add_test(NAME package.repository COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/repository ${PROJECT_SOURCE_DIR})
set_tests_properties(package.repository PROPERTIES LABELS package TIMEOUT 300 SKIP_RETURN_CODE 77)
# scripts/setup installs what tests and scripts call. By hand: tests/package/bare, and called_programs.py executed.
add_test(NAME package.called_programs_test COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/package/called_programs_test.py)
add_test(NAME package.setup_installs_every_called_program
  COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/package/called_programs.py called ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
set_tests_properties(package.called_programs_test package.setup_installs_every_called_program PROPERTIES LABELS package TIMEOUT 300 SKIP_RETURN_CODE 77)
foreach(mode "" --try)
  add_test(NAME package.symbols${mode} COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/symbols ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR} ${mode})
  set_tests_properties(package.symbols${mode} PROPERTIES LABELS package)
endforeach()

add_test(NAME package.new_component_builds COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/new_component ${PROJECT_BINARY_DIR})
set_tests_properties(package.new_component_builds PROPERTIES LABELS package TIMEOUT 300)

foreach(shell bash zsh)
  find_program(shell_${shell} ${shell})
  if(shell_${shell})
    add_test(NAME package.completion_${shell} COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/completion ${shell} ${PROJECT_BINARY_DIR})
    set_tests_properties(package.completion_${shell} PROPERTIES LABELS package TIMEOUT 300 SKIP_RETURN_CODE 77)
  endif()
endforeach()
