include(${PROJECT_SOURCE_DIR}/cmake/headers_alone.cmake)

rtmsim_headers_alone(openrtm_headers_alone ROOT ${PROJECT_SOURCE_DIR}/rtm-core/openrtm FOLDER rtm LIBRARIES openrtm)

# Component sources in the style of every version of the API; that they compile is the test. LINKED: also as module and program.
add_subdirectory(classic-api)

rtmsim_test(include_rules_test unit/include_rules_test.cpp)
