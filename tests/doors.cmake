# Who and what comes in over the wire.
rtmsim_test(giop_gate_test doors/giop_gate_test.cpp LIBRARIES rt_corba)
rtmsim_test(remote_rights_test doors/remote_rights_test.cpp LIBRARIES openrtm LABELS process)
add_dependencies(remote_rights_test rtcd SinkAll)

# Bounded attacks; more of them by hand (tests/campaign).
add_test(NAME doors COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/campaign/doors.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
add_test(NAME fragments COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/campaign/fragments.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} --messages 20000)
add_test(NAME tls COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/campaign/tls.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})

# The campaigns that stay: tests/campaign/run runs each for longer. Here a few seconds of each.
add_executable(campaign_steps campaign/steps.cpp)
target_include_directories(campaign_steps PRIVATE ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(campaign_steps PRIVATE simshm rtmsim_settings)
add_library(clock_jumps MODULE campaign/clock_jumps.c)
target_link_libraries(clock_jumps PRIVATE rtmsim_settings)
set_target_properties(clock_jumps PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
add_test(NAME campaign.stores COMMAND campaign_steps 4)
function(campaign name script)
  add_test(NAME campaign.${name}
    COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/campaign/${script} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR} ${ARGN})
endfunction()
campaign(kills kills.py --only kill --rounds 2)
campaign(stops kills.py --only stop --rounds 2)
campaign(clocks clocks.py)
campaign(files resources.py files)
campaign(memory resources.py memory)
campaign(disk resources.py disk)
campaign(soak leaks.py --rounds 2)
campaign(hostile hostile.py)
set(smokes stores kills stops clocks files memory disk soak hostile)
list(TRANSFORM smokes PREPEND campaign.)
set_tests_properties(doors fragments tls ${smokes} PROPERTIES LABELS process TIMEOUT 300 SKIP_RETURN_CODE 77)
