# Recordings: the file format.
rtmsim_test(mcap_test recorder/mcap_test.cpp LIBRARIES mcap)
rtmsim_test(ros_messages_test recorder/ros_messages_test.cpp LIBRARIES recorder)
rtmsim_test(expression_test recorder/expression_test.cpp LIBRARIES recorder)
foreach(case views whole_run same_run killed compared played kept of_a_run replayed replayed_without_inputs gone_to like bad_input)
  add_test(NAME recordings.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/recordings.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(recordings.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()

# The format as others read and write it: libraries from npm.
rtmsim_test(mcap_foreign_test recorder/mcap_foreign_test.cpp LIBRARIES mcap LABELS foreign)
