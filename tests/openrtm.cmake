rtmsim_headers_alone(openrtm_headers_alone ROOT ${PROJECT_SOURCE_DIR}/rtm-core/openrtm/include FOLDER rtm SOURCES ${PROJECT_SOURCE_DIR}/rtm-core/openrtm/rtm LIBRARIES openrtm)
set_target_properties(openrtm_headers_alone PROPERTIES CXX_STANDARD 17)  # authors may stay with that
foreach(room component manager openrtm)
  rtmsim_headers_alone(${room}_room_headers_alone ROOT ${PROJECT_SOURCE_DIR}/rtm-core FOLDER ${room} SOURCES ${PROJECT_SOURCE_DIR}/rtm-core/${room} LIBRARIES openrtm)
endforeach()

# Users copy the examples: they keep to what OpenRTM-aist has as well. Compiled, never linked.
set(examples ${PROJECT_SOURCE_DIR}/clients/examples)
add_library(samples_like_openrtm OBJECT ${examples}/config_demo.cpp ${examples}/echo_consumer.cpp ${examples}/echo_provider.cpp
  ${examples}/fail_on_request.cpp ${examples}/sink_all.cpp ${examples}/source_all.cpp)
target_include_directories(samples_like_openrtm BEFORE PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/classic-api/like_openrtm)
target_link_libraries(samples_like_openrtm PRIVATE rtm_idl ${PROJECT_NAME}_idl_Echo rtmsim_settings)

# What authors use, name by name.
rtmsim_test(classic_api_test classic-api/surface_test.cpp classic-api/macho_test.cpp classic-api/tools_test.cpp classic-api/context_test.cpp LIBRARIES openrtm)

# Component sources in the style of every version of the API; that they compile is the test. LINKED: also as module and program.
add_subdirectory(classic-api)

rtmsim_test(include_rules_test rules/include_rules_test.cpp rules/length_rules_test.cpp rules/lock_rules_test.cpp rules/name_rules_test.cpp rules/test_lists_test.cpp rules/include_closure_test.cpp)
add_test(NAME build.incremental COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/rules/incremental.py ${PROJECT_BINARY_DIR})
set_tests_properties(build.incremental PROPERTIES SKIP_RETURN_CODE 77)

# A program and a module of another project, against the build tree and against an installation.
foreach(mode build install)
  add_test(NAME package.${mode} COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/run ${mode} ${PROJECT_BINARY_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/package/outside)
  set_tests_properties(package.${mode} PROPERTIES LABELS package TIMEOUT 600 ENVIRONMENT "SANITIZE=${RTMSIM_SANITIZE}")
endforeach()
add_test(NAME package.tutorial COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/tutorial ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR}/docs/tutorial-component.md "^long: [0-9]*[02468]$")
set_tests_properties(package.tutorial PROPERTIES LABELS package TIMEOUT 300 ENVIRONMENT "SANITIZE=${RTMSIM_SANITIZE}")
add_test(NAME package.tutorial_arm COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/tutorial ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR}/docs/tutorial-arm.md " brake ")
set_tests_properties(package.tutorial_arm PROPERTIES LABELS package TIMEOUT 300 ENVIRONMENT "SANITIZE=${RTMSIM_SANITIZE};WORLDS=${PROJECT_SOURCE_DIR}/worlds")
add_test(NAME package.examples COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/examples ${PROJECT_BINARY_DIR})
set_tests_properties(package.examples PROPERTIES LABELS package TIMEOUT 300)
add_test(NAME package.builds COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/builds ${PROJECT_BINARY_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/classic-api/peers)
set_tests_properties(package.builds PROPERTIES LABELS package TIMEOUT 600 ENVIRONMENT "SANITIZE=${RTMSIM_SANITIZE}")
add_test(NAME package.throw_specifications COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/throw_specifications ${PROJECT_SOURCE_DIR}/cmake)
set_tests_properties(package.throw_specifications PROPERTIES LABELS package TIMEOUT 120)
add_test(NAME package.peers COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/peers build ${PROJECT_BINARY_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/classic-api/peers)
set_tests_properties(package.peers PROPERTIES LABELS package TIMEOUT 900 ENVIRONMENT "SANITIZE=${RTMSIM_SANITIZE}")
add_test(NAME package.headers COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/package/headers ${PROJECT_BINARY_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/classic-api ${CMAKE_CXX_COMPILER})
set_tests_properties(package.headers PROPERTIES LABELS package TIMEOUT 900)
