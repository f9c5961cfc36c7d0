# The protocol of Player, player-gateway before a peer of another make, and the follower.
rtmsim_test(player_protocol_test player/player_protocol_test.cpp LIBRARIES player_protocol)
rtmsim_test(player_gateway_test player/player_gateway_test.cpp player/player_cfg_test.cpp player/disparity_test.cpp LIBRARIES player_gateway)
rtmsim_test(player_devices_test player/player_devices_test.cpp player/seen_devices_test.cpp player/new_player_interface_test.cpp LIBRARIES player_gateway)
rtmsim_test(door_test player/door_test.cpp LIBRARIES player_gateway)
rtmsim_test(alarm_test player/alarm_test.cpp LIBRARIES player_gateway)
foreach(script_and_cases
    "player listing drive properties flow rate two_clients simulation rangers sensors config"
    "player_faults gateway_ends restart hung late_and_changing bad_input stuck")
  separate_arguments(cases UNIX_COMMAND "${script_and_cases}")
  list(POP_FRONT cases script)
  foreach(case ${cases})
    add_test(NAME player.${case}
      COMMAND ${judged} python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/${script}.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
    set_tests_properties(player.${case} PROPERTIES LABELS integration TIMEOUT 300)
  endforeach()
endforeach()
foreach(case position heading cars flight)
  add_test(NAME player.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/player_drives.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(player.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()

foreach(case seen identity configure power estimates settings meters_and_depths storm actarray limb gripper ptz joints_by_name map_tiles)
  add_test(NAME player.${case}
    COMMAND ${judged} python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/player_devices.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(player.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()

foreach(case lines_of_the_map maps_delay_nobody planner stereo stereo_of_no_pair opaque dio graphics)
  add_test(NAME player.${case}
    COMMAND ${judged} python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/player_world.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(player.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()

foreach(case accounts key silent exhausted few_descriptors)
  add_test(NAME player.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/player_doors.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(player.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()

rtmsim_test(leader_follower_test player/leader_follower_test.cpp LIBRARIES leader_follower)
foreach(case leader losses late_gateway wrong_servers)
  add_test(NAME follow.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/follow.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(follow.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()
# What a client of Player may send that it should not: part of the campaigns.
set_tests_properties(player.bad_input player.storm PROPERTIES LABELS "integration;campaign")
