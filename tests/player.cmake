# The protocol of Player, player-gateway before a peer of another make, and the follower.
rtmsim_test(player_test
  player/player_protocol_test.cpp player/player_gateway_test.cpp player/player_cfg_test.cpp player/disparity_test.cpp player/player_devices_test.cpp player/seen_devices_test.cpp
  player/new_player_interface_test.cpp player/door_test.cpp player/alarm_test.cpp
  LIBRARIES player_gateway)
scenario_cases(player. player listing drive properties flow rate two_clients simulation rangers sensors config JUDGED)
scenario_cases(player. player_faults gateway_ends restart hung late_and_changing bad_input stuck JUDGED)
scenario_cases(player. player_drives position heading cars flight)

scenario_cases(player. player_devices seen identity configure power estimates settings meters_and_depths storm map_tiles JUDGED)
scenario_cases(player. player_arms actarray limb gripper ptz joints_by_name JUDGED)

scenario_cases(player. player_world lines_of_the_map maps_delay_nobody planner stereo stereo_of_no_pair opaque dio graphics JUDGED)

scenario_cases(player. player_doors accounts key silent exhausted few_descriptors)

rtmsim_test(leader_follower_test player/leader_follower_test.cpp LIBRARIES leader_follower)
scenario_cases(follow. follow leader losses late_gateway wrong_servers)
# What a client of Player may send that it should not: part of the campaigns.
set_tests_properties(player.bad_input player.storm PROPERTIES LABELS "integration;campaign")
