# rtm-studio in a real browser. Needs chromium and the libraries of tests/studio (scripts/setup); without a browser they are skipped.
foreach(flows page world diagram act joint tip late system lockstep picture recording run_page firefox end)
  add_test(NAME studio.${flows}_flows
    COMMAND ${NODE_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/studio/${flows}_flows.mjs ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
  set_tests_properties(studio.${flows}_flows PROPERTIES LABELS browser TIMEOUT 900 SKIP_RETURN_CODE 77)
endforeach()
add_test(NAME studio.page_has_its_types
  COMMAND ${NODE_PROGRAM} ${CMAKE_BINARY_DIR}/tools/studio/web/page/node_modules/typescript/bin/tsc --noEmit -p ${CMAKE_BINARY_DIR}/tools/studio/web/page)
add_test(NAME studio.lock_files_name_no_registry COMMAND ${NODE_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/studio/locks.mjs ${PROJECT_SOURCE_DIR})
set_tests_properties(studio.page_has_its_types studio.lock_files_name_no_registry PROPERTIES LABELS browser)
