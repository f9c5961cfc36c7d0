# The pages on how to add something are followed in a copy of the sources.
foreach(page new-device new-component new-data-type new-rtse-command)
  add_test(NAME docs.${page}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/follow_page.py list ${page} ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
  set_tests_properties(docs.${page} PROPERTIES LABELS docs TIMEOUT 600)
endforeach()
foreach(mode pages promises)
  add_test(NAME docs.${mode} COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/docs.py ${mode} ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
  set_tests_properties(docs.${mode} PROPERTIES LABELS docs)
endforeach()
add_test(NAME docs.commands COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/scenario/docs_commands.py ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
set_tests_properties(docs.commands PROPERTIES LABELS docs)
set(pages README.md docs/campaigns.md docs/hash-logs.md docs/pictures.md docs/player.md docs/recordings.md docs/security.md docs/simulator.md
  docs/testing-a-robot-system.md docs/tutorial-first-system.md docs/worlds.md)
if(RTMSIM_STUDIO_PAGE)
  list(APPEND pages docs/studio.md)
endif()
foreach(page IN LISTS pages)
  cmake_path(GET page STEM name)
  add_test(NAME docs.commands.${name} COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/scenario/docs_commands.py ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR} ${page})
  set_tests_properties(docs.commands.${name} PROPERTIES LABELS docs TIMEOUT 300)
endforeach()
# The whole simulator of the copy, with the new device in it: minutes of building.
option(RTMSIM_SLOW_TESTS "tests that build much" OFF)
if(RTMSIM_SLOW_TESTS)
  add_test(NAME docs.new-device_runs
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/follow_page.py build new-device ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
  set_tests_properties(docs.new-device_runs PROPERTIES LABELS docs TIMEOUT 7200)
endif()
