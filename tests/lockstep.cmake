# Systems of many processes in lock step, each case with a naming service and a simulator of its own.
include(${PROJECT_SOURCE_DIR}/cmake/component.cmake)
rtmsim_component(Relay scenario/relay.cpp)
foreach(case chain_forward chain_backward chain_mixed_at_a_rate_that_is_no_multiple_of_the_step killed stopped dropped hanging_component server_restarted two_servers
             registers_1000_times time_stamps reset waiting_samples active_over_restarts steps_end refused_in_a_hang loaded)
  add_test(NAME lockstep.${case}
    COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/scenario/lockstep.py ${case} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR})
  set_tests_properties(lockstep.${case} PROPERTIES LABELS integration TIMEOUT 300)
endforeach()
