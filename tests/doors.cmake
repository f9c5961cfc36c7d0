# Who and what comes in over the wire.
rtmsim_test(giop_gate_test doors/giop_gate_test.cpp LIBRARIES rt_corba)
rtmsim_test(remote_rights_test doors/remote_rights_test.cpp LIBRARIES openrtm LABELS process)
add_dependencies(remote_rights_test rtcd SinkAll)

# Bounded attacks; more of them by hand (tests/campaign).
add_test(NAME doors COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/campaign/doors.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
add_test(NAME fragments COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/campaign/fragments.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} --messages 20000)
add_test(NAME tls COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/campaign/tls.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
add_test(NAME kills COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/campaign/kills.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${CMAKE_LIBRARY_OUTPUT_DIRECTORY} ${PROJECT_SOURCE_DIR} --rounds 3)
set_tests_properties(doors fragments tls kills PROPERTIES LABELS process TIMEOUT 300)
