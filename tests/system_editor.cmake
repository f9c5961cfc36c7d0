rtmsim_test(system_editor_test
  unit/address_test.cpp unit/expectations_test.cpp unit/parameter_check_test.cpp unit/rts_profile_test.cpp unit/skeleton_test.cpp unit/value_codec_test.cpp
  LIBRARIES system_editor)
