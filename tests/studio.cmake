# rtm-studio: its parts, and the program before browsers, other viewers and people with bad intentions.
rtmsim_test(studio_test studio/studio_test.cpp studio/door_test.cpp studio/shown_picture_test.cpp LIBRARIES studio)
rtmsim_test(page_test page/failure_marks_test.cpp LIBRARIES run_page)
scenario_cases(studio. studio doors two_ways garbage crowd read_only comes_back slow_viewer JUDGED)
scenario_cases(studio. studio_shows world system same_hash foreign controls joints pictures recording hints opens started JUDGED)
# What a viewer may send that it should not: part of the campaigns.
set_tests_properties(studio.garbage PROPERTIES LABELS "integration;campaign")
