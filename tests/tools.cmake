rtmsim_test(system_editor_test
  system/address_test.cpp system/configuration_test.cpp system/connections_test.cpp system/parameter_check_test.cpp system/rts_profile_test.cpp system/saved_system_test.cpp system/system_template_test.cpp
  system/transitions_test.cpp system/value_codec_test.cpp run/call_order_test.cpp run/expectations_test.cpp run/junit_test.cpp run/pose_record_test.cpp run/recorded_run_test.cpp run/run_options_test.cpp run/stepping_test.cpp rtse/console_test.cpp rtse/output_test.cpp rtse/skeleton_test.cpp
  LIBRARIES rtse_commands command_line)
