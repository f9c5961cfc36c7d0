rtmsim_test(system_editor_test
  system-editor/address_test.cpp system-editor/call_order_test.cpp system-editor/expectations_test.cpp system-editor/output_test.cpp system-editor/parameter_check_test.cpp system-editor/rts_profile_test.cpp system-editor/skeleton_test.cpp system-editor/value_codec_test.cpp
  LIBRARIES system_editor)
