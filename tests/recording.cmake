# Recordings: the file format.
rtmsim_test(mcap_test recording/mcap_test.cpp LIBRARIES mcap)
rtmsim_test(recorder_test recording/ros_messages_test.cpp recording/expression_test.cpp recording/recorder_line_test.cpp LIBRARIES recorder)
scenario_cases(recordings. recordings views excluded whole_run same_run killed full_disk compared played kept of_a_run repeated lives hashed simulator_ends bad_input)
scenario_cases(recordings. recorded_again replayed replayed_without_inputs replayed_from_real_time gone_to gone_to_with_others like)
scenario_cases(recorded_rings. recorded_rings of_a_run killed again reset taken full_disk of_a_killed_recorder)
if(RTMSIM_STUDIO_PAGE)
  foreach(case same given_up killed)
    add_test(NAME followed_page.${case}
      COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/followed_page.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
    set_tests_properties(followed_page.${case} PROPERTIES LABELS integration TIMEOUT 600)
  endforeach()
  foreach(case damaged limit writer_killed page_fails ended messages)
    add_test(NAME run_page.${case}
      COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/run_page.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
    set_tests_properties(run_page.${case} PROPERTIES LABELS integration TIMEOUT 600)
  endforeach()
endif()
add_test(NAME recordings.of_others COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/recordings_of_others.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
set_tests_properties(recordings.of_others PROPERTIES LABELS integration TIMEOUT 300)
scenario_cases(hostile_recordings. hostile_recordings astray bombs broken_ring flipped large letters many_broken pictures names targets terminal)
# By hand: RECORDING_REPEATS=100 python3 tests/scenario/recordings.py repeated build/release/bin build/release/lib .

# The format as others read and write it: libraries from npm.
rtmsim_test(mcap_foreign_test recording/mcap_foreign_test.cpp LIBRARIES mcap LABELS foreign)

# A component with one constant changed, under the name of the good one in a folder of its own: a replay tells them apart.
set(changed_sources)
foreach(source avoidance.cpp laser_obstacle_avoid.cpp)
  file(READ ${PROJECT_SOURCE_DIR}/clients/obstacle-avoidance/${source} text)
  string(REPLACE "std::numbers::pi / 180" "std::numbers::pi / 181" text "${text}")
  file(CONFIGURE OUTPUT changed/${source} CONTENT "${text}" @ONLY)
  set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS clients/obstacle-avoidance/${source})
  list(APPEND changed_sources ${CMAKE_CURRENT_BINARY_DIR}/changed/${source})
endforeach()
add_library(LaserObstacleAvoidChanged MODULE ${changed_sources})
set_target_properties(LaserObstacleAvoidChanged PROPERTIES PREFIX "" OUTPUT_NAME LaserObstacleAvoid
  LIBRARY_OUTPUT_DIRECTORY ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/changed)
target_include_directories(LaserObstacleAvoidChanged PRIVATE ${PROJECT_SOURCE_DIR}/clients/obstacle-avoidance)
target_link_libraries(LaserObstacleAvoidChanged PRIVATE openrtm base rtmsim_settings)
