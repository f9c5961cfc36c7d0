# rtm-studio: its parts, and the program before browsers, other viewers and people with bad intentions.
rtmsim_test(studio_test studio/studio_test.cpp studio/door_test.cpp studio/shown_picture_test.cpp LIBRARIES studio)
rtmsim_test(page_test page/failure_marks_test.cpp LIBRARIES run_page)
foreach(case doors two_ways garbage crowd world system read_only comes_back slow_viewer same_hash foreign controls joints pictures recording hints opens started)
  add_test(NAME studio.${case}
    COMMAND ${judged} python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/scenario/studio.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(studio.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()
# What a viewer may send that it should not: part of the campaigns.
set_tests_properties(studio.garbage PROPERTIES LABELS "integration;campaign")
