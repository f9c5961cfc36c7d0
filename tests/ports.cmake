add_executable(ports_peer ports/peer.cpp)
target_link_libraries(ports_peer PRIVATE openrtm rtmsim_settings)
target_include_directories(ports_peer PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(ports_peer PRIVATE test_paths)
rtmsim_test(ports_core_test ports/connector_settings_test.cpp ports/delivery_test.cpp ports/mailbox_test.cpp ports/publisher_test.cpp LIBRARIES rt_core LABELS core)
rtmsim_test(ports_wire_test ports/connect_test.cpp ports/transport_test.cpp ports/fault_test.cpp ports/hang_test.cpp ports/service_port_test.cpp
  ports/listener_test.cpp ports/nv_util_test.cpp ports/serializer_test.cpp ports/author_transport_test.cpp ports/hostile_test.cpp ports/stranger_test.cpp ports/golden_test.cpp LIBRARIES openrtm nlohmann_json::nlohmann_json LABELS corba)
add_dependencies(ports_wire_test ports_peer)

add_test(NAME ports_foreign_test COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/ports/foreign_test.py $<TARGET_FILE:ports_peer>)
set_tests_properties(ports_foreign_test PROPERTIES TIMEOUT 300 LABELS corba)
